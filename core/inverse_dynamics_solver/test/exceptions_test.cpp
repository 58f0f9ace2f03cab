// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/exceptions.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <type_traits>

namespace inverse_dynamics_solver::exceptions_test {

TEST(ErrorText, JoinsItsPartsAndLeavesOutEmptyOnes) {
  EXPECT_EQ(errorText("a.yaml:3", "wrong value", "3", "2", "add one"),
            "a.yaml:3: wrong value: expected 3, got 2; add one");
  EXPECT_EQ(errorText("a.yaml:3", "wrong value", "3", "2"),
            "a.yaml:3: wrong value: expected 3, got 2");
  EXPECT_EQ(errorText("tip", "missing", "a link"), "tip: missing: expected a link");
  EXPECT_EQ(errorText("tip", "missing", "", "nothing"), "tip: missing: got nothing");
  EXPECT_EQ(errorText("", "missing", "", "", "set it"), "missing; set it");
}

TEST(Exceptions, AreOneFamily) {
  EXPECT_TRUE((std::is_base_of_v<std::runtime_error, Exception>));
  EXPECT_TRUE((std::is_base_of_v<Exception, UninitializedException>));
  EXPECT_TRUE((std::is_base_of_v<Exception, ParameterUninitializedException>));
  EXPECT_TRUE((std::is_base_of_v<Exception, InvalidParameterValueException>));
  EXPECT_TRUE(
      (std::is_base_of_v<InvalidParameterValueException, InvalidRobotDescriptionException>));
  EXPECT_TRUE((std::is_base_of_v<Exception, SizeMismatchException>));
  EXPECT_TRUE((std::is_base_of_v<Exception, PluginNotFoundException>));
}

TEST(Exceptions, UninitializedNamesTheMethodAndTheRemedy) {
  EXPECT_STREQ(
      UninitializedException("getTorques").what(),
      "getTorques: the solver is not initialized; call initialize() first, and see that it "
      "doesn't throw");
  EXPECT_STREQ(UninitializedException().what(),
               "solver: the solver is not initialized; call initialize() first, and see that it "
               "doesn't throw");
}

}  // namespace inverse_dynamics_solver::exceptions_test

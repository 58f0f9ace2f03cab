// SPDX-License-Identifier: Apache-2.0
/// @file
/// Conformance, part seven: an error of a plugin that nothing else keeps open. Include
/// conformance_tests.hpp, not this.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <string>

#include "inverse_dynamics_solver/conformance/initialization_tests.hpp"

namespace inverse_dynamics_solver::conformance {

/// Ends the process: status 0 if initialize() throws an error with a text, whole.
///
/// The solver and its loader are gone before the error is handled.
[[noreturn]] inline void exitWithFirstError(const char* plugin, const Parameters& parameters,
                                            const std::string& description) {
  std::string text;
  try {
    SolverLoader().load(plugin)->initialize(parameters, "", description);
  } catch (const Exception& error) {
    text = error.what();
  }
  std::cerr << text << "\n";
  std::exit(text.empty() ? 1 : 0);
}

TEST_P(SolverAlone, FirstErrorOfAProcessIsReported) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";  // each in a process of its own
  for (const auto& [changed, description] : mistakes(GetParam())) {
    ParameterMap parameters = GetParam().parameters();
    for (const auto& [name, value] : changed) parameters[name] = value;
    EXPECT_EXIT(exitWithFirstError(GetParam().plugin, parameters, description),
                ::testing::ExitedWithCode(0), ".");
  }
}

}  // namespace inverse_dynamics_solver::conformance

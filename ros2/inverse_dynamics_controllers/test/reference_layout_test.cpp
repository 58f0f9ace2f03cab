// SPDX-License-Identifier: Apache-2.0
#include "reference_layout.hpp"

#include <gtest/gtest.h>

#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>

namespace inverse_dynamics_controllers {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
using Strings = std::vector<std::string>;

TEST(ReferenceLayout, NumbersStandJointByJoint) {
  const ReferenceLayout layout({"velocity", "position", "effort"}, {"a", "b"});
  EXPECT_EQ(layout.names(), (Strings{"a/velocity", "a/position", "a/effort", "b/velocity",
                                     "b/position", "b/effort"}));
  const std::vector<double> values = {1, 2, 3, 4, 5, 6};
  inverse_dynamics_control::Reference reference(2);
  reference.qdd.setConstant(7.0);
  Eigen::VectorXd effort(2);
  layout.readMotion(values, reference);
  layout.readEffort(values, effort);
  EXPECT_EQ(reference.qd, Eigen::Vector2d(1, 4));
  EXPECT_EQ(reference.q, Eigen::Vector2d(2, 5));
  EXPECT_EQ(reference.qdd, Eigen::Vector2d(0, 0));
  EXPECT_EQ(effort, Eigen::Vector2d(3, 6));
}

TEST(ReferenceLayout, UntouchedIsWhatIsNanAltogether) {
  const ReferenceLayout layout({"position", "velocity", "effort"}, {"a", "b"});
  std::vector<double> values(6, kNan);
  EXPECT_TRUE(layout.motionIsUntouched(values));
  EXPECT_TRUE(layout.effortIsUntouched(values));
  layout.set(ReferenceLayout::kEffort, 1, 0.0, values);
  EXPECT_TRUE(layout.motionIsUntouched(values));
  EXPECT_FALSE(layout.effortIsUntouched(values));
  layout.set(ReferenceLayout::kVelocity, 0, 0.0, values);
  EXPECT_FALSE(layout.motionIsUntouched(values));
}

TEST(ReferenceLayout, PartsOfAMotionAreRefused) {
  const auto textOf = [](const Strings& interfaces) -> std::string {
    try {
      ReferenceLayout(interfaces, {"a"});
    } catch (const inverse_dynamics_solver::InvalidParameterValueException& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(textOf({"position", "acceleration"}),
            "parameter 'reference_interfaces': not a motion: expected position and velocity, "
            "acceleration only beside them, got position, acceleration; add what is missing");
  for (const Strings& each : {Strings{}, Strings{"velocity"}, Strings{"acceleration", "effort"}}) {
    EXPECT_NE(textOf(each), "");
  }
  EXPECT_EQ(textOf({"effort"}), "");
}

}  // namespace
}  // namespace inverse_dynamics_controllers

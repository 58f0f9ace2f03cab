// SPDX-License-Identifier: Apache-2.0
//
// A controller manager finds each controller by its name.
#include <gtest/gtest.h>

#include <controller_manager/controller_manager.hpp>
#include <memory>
#include <rclcpp/executors/single_threaded_executor.hpp>
#include <ros2_control_test_assets/descriptions.hpp>
#include <string>

namespace inverse_dynamics_controllers {
namespace {

class Load : public testing::TestWithParam<const char*> {
 protected:
  static void SetUpTestSuite() { rclcpp::init(0, nullptr); }
  static void TearDownTestSuite() { rclcpp::shutdown(); }
};

TEST_P(Load, AControllerManagerFindsIt) {
  const auto executor = std::make_shared<rclcpp::executors::SingleThreadedExecutor>();
  controller_manager::ControllerManager manager(
      executor, ros2_control_test_assets::minimal_robot_urdf, true, "manager");
  EXPECT_NE(manager.load_controller("under_test",
                                    std::string("inverse_dynamics_controllers/") + GetParam()),
            nullptr);
}

INSTANTIATE_TEST_SUITE_P(Controllers, Load,
                         testing::Values("ExternalWrenchBroadcaster", "FeedForwardController",
                                         "GravityCompensationController",
                                         "InverseDynamicsController",
                                         "PdGravityCompensationController"));

}  // namespace
}  // namespace inverse_dynamics_controllers

// SPDX-License-Identifier: Apache-2.0

/// @file
/// Program: the node of live_node.hpp by itself.
///
///     ros2 run inverse_dynamics_ros live --ros-args -p plugin_name:=package/Class

#include "inverse_dynamics_ros/live_node.hpp"
#include "run_node.hpp"

int main(int argc, char** argv) {
  return inverse_dynamics_ros::runNode<inverse_dynamics_ros::LiveNode>(argc, argv, "live");
}

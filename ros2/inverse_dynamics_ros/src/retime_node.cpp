// SPDX-License-Identifier: Apache-2.0

#include "retime_node.hpp"

#include <rclcpp_components/register_node_macro.hpp>

RCLCPP_COMPONENTS_REGISTER_NODE(inverse_dynamics_ros::RetimeNode)

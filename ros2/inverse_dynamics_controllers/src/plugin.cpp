// SPDX-License-Identifier: Apache-2.0
#include <rclcpp/version.h>

#include <pluginlib/class_list_macros.hpp>

#include "inverse_dynamics_controllers/external_wrench_broadcaster.hpp"
#include "inverse_dynamics_controllers/feed_forward_controller.hpp"
#include "inverse_dynamics_controllers/gravity_compensation_controller.hpp"
#include "inverse_dynamics_controllers/inverse_dynamics_controller.hpp"
#include "inverse_dynamics_controllers/pd_gravity_compensation_controller.hpp"

PLUGINLIB_EXPORT_CLASS(inverse_dynamics_controllers::InverseDynamicsController,
                       controller_interface::ChainableControllerInterface)
PLUGINLIB_EXPORT_CLASS(inverse_dynamics_controllers::GravityCompensationController,
                       controller_interface::ControllerInterface)
PLUGINLIB_EXPORT_CLASS(inverse_dynamics_controllers::FeedForwardController,
                       controller_interface::ChainableControllerInterface)
PLUGINLIB_EXPORT_CLASS(inverse_dynamics_controllers::PdGravityCompensationController,
                       controller_interface::ChainableControllerInterface)
#if RCLCPP_VERSION_GTE(17, 0, 0)
PLUGINLIB_EXPORT_CLASS(inverse_dynamics_controllers::ExternalWrenchBroadcaster,
                       controller_interface::ChainableControllerInterface)
#else
PLUGINLIB_EXPORT_CLASS(inverse_dynamics_controllers::ExternalWrenchBroadcaster,
                       controller_interface::ControllerInterface)
#endif

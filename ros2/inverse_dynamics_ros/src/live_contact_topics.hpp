// SPDX-License-Identifier: Apache-2.0

/// @file
/// External torques, wrench and contacts of the live node: parameters, topics, diagnostics.

#pragma once

#include <cstdint>
#include <diagnostic_updater/diagnostic_updater.hpp>
#include <geometry_msgs/msg/wrench_stamped.hpp>
#include <inverse_dynamics_msgs/msg/contact.hpp>
#include <inverse_dynamics_ros/live_node_parameters.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <std_msgs/msg/header.hpp>
#include <string>
#include <vector>

#include "live_contact.hpp"
#include "live_robot.hpp"
#include "live_torques.hpp"

namespace inverse_dynamics_ros {

/// ~/external_torques, ~/wrench, ~/contact.
class LiveContactTopics {
 public:
  /// @param given  parameters that the user has set; they take precedence over the file of contacts.
  LiveContactTopics(rclcpp::Node& node, const live_node::Params::ExternalTorques& parameters,
                    inverse_dynamics_solver::Parameters given);

  /// An estimator for a robot.
  ///
  /// @throws UserError: a file that can't be used, a link without a name.
  /// @throws inverse_dynamics_solver::Exception: parameters out of range.
  std::unique_ptr<LiveContact> make(const LiveRobot& robot) const;

  /// Uses this estimator from now on.
  void use(std::unique_ptr<LiveContact> contact, const LiveRobot& robot);

  /// Takes a joint state and publishes the estimates.
  void take(const std_msgs::msg::Header& header, std::int64_t stamp, const LiveTorques& live);

  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  LiveContactOptions options(const LiveRobot& robot) const;
  const std::string& frame(const LiveRobot& robot) const;
  void publish();
  const std::string& contactJoint() const;
  void reportWrench(diagnostic_updater::DiagnosticStatusWrapper& status) const;
  void reportContact(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  rclcpp::Logger logger_;
  live_node::Params::ExternalTorques parameters_;
  inverse_dynamics_solver::Parameters given_;
  std::unique_ptr<LiveContact> contact_;  // null until there is a robot
  std::string estimator_;                 // in words
  std::vector<std::string> joints_;       // names in messages
  std::int64_t reported_ = 0;             // estimates at the last report
  rclcpp::Clock steady_{RCL_STEADY_TIME};
  // Reused, so that nothing is allocated per message.
  sensor_msgs::msg::JointState torques_;
  geometry_msgs::msg::WrenchStamped wrench_;
  inverse_dynamics_msgs::msg::Contact found_contact_;
  rclcpp::Publisher<sensor_msgs::msg::JointState>::SharedPtr torques_publisher_;
  rclcpp::Publisher<geometry_msgs::msg::WrenchStamped>::SharedPtr wrench_publisher_;
  rclcpp::Publisher<inverse_dynamics_msgs::msg::Contact>::SharedPtr contact_publisher_;
};

}  // namespace inverse_dynamics_ros

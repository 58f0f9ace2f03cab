// SPDX-License-Identifier: Apache-2.0
#include "reference_topic.hpp"

#include <algorithm>
#include <builtin_interfaces/msg/time.hpp>
#include <chain_dynamics/text.hpp>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <trajectory_msgs/msg/joint_trajectory.hpp>
#include <trajectory_msgs/msg/joint_trajectory_point.hpp>
#include <vector>

#include "latest_value.hpp"

namespace inverse_dynamics_controllers {

using chain_dynamics::joined;
using trajectory_msgs::msg::JointTrajectory;
using trajectory_msgs::msg::JointTrajectoryPoint;

namespace {

// Where each joint stands in the message, or what is wrong with its names.
std::string find(const std::vector<std::string>& joints, const std::vector<std::string>& names,
                 std::vector<std::size_t>& places) {
  for (const std::string& joint : joints) {
    const auto place = std::find(names.begin(), names.end(), joint);
    if (place == names.end()) {
      return "joint_names: '" + joint + "' is missing: expected " + joined(joints) + ", got " +
             (names.empty() ? "none" : joined(names));
    }
    places.push_back(static_cast<std::size_t>(place - names.begin()));
  }
  if (names.size() == joints.size()) return "";
  return "joint_names: expected " + std::to_string(joints.size()) + " (" + joined(joints) +
         "), got " + std::to_string(names.size()) + " (" + joined(names) + ")";
}

std::string checkSize(const char* field, std::size_t size, std::size_t joints) {
  if (size == joints) return "";
  return std::string("points[0].") + field + ": expected " + std::to_string(joints) +
         " numbers, one for each of joint_names, got " + std::to_string(size);
}

std::string check(const JointTrajectoryPoint& point, const ReferenceLayout& layout,
                  std::size_t joints) {
  std::string error;
  if (layout.hasMotion()) {
    error = checkSize("positions", point.positions.size(), joints);
    if (error.empty()) error = checkSize("velocities", point.velocities.size(), joints);
    if (error.empty() && !point.accelerations.empty()) {
      error = checkSize("accelerations", point.accelerations.size(), joints);
    }
  }
  if (error.empty() && layout.hasEffort() && !(layout.hasMotion() && point.effort.empty())) {
    error = checkSize("effort", point.effort.size(), joints);
  }
  return error;
}

}  // namespace

std::string referencesOf(const JointTrajectory& message, const ReferenceLayout& layout,
                         const std::vector<std::string>& joints, std::vector<double>& values) {
  std::vector<std::size_t> places;
  std::string error = find(joints, message.joint_names, places);
  if (!error.empty()) return error;
  if (message.points.size() != 1) {
    return "points: expected 1, the reference from now on, got " +
           std::to_string(message.points.size()) +
           "; for whole trajectories put a joint_trajectory_controller before this one";
  }
  const JointTrajectoryPoint& point = message.points.front();
  error = check(point, layout, joints.size());
  if (!error.empty()) return error;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const std::size_t k = places[j];
    if (layout.hasMotion()) {
      layout.set(ReferenceLayout::kPosition, j, point.positions[k], values);
      layout.set(ReferenceLayout::kVelocity, j, point.velocities[k], values);
      layout.set(ReferenceLayout::kAcceleration, j,
                 point.accelerations.empty() ? 0.0 : point.accelerations[k], values);
    }
    layout.set(ReferenceLayout::kEffort, j, point.effort.empty() ? 0.0 : point.effort[k], values);
  }
  return "";
}

/// Where messages arrive, in another thread than the control loop's.
struct ReferenceTopic::Inbox {
  ReferenceLayout layout;
  std::vector<std::string> joints;
  double oldest;  // s
  LatestValue<std::vector<double>> newest;
  rclcpp::Logger logger;
  rclcpp::Clock::SharedPtr clock;

  void receive(const JointTrajectory& message) {
    std::string error = stampError(message.header.stamp);
    if (error.empty()) error = referencesOf(message, layout, joints, newest.back());
    if (error.empty()) return newest.publish();
    RCLCPP_ERROR_THROTTLE(logger, *clock, 1000, "~/reference: ignored: %s", error.c_str());
  }

  std::string stampError(const builtin_interfaces::msg::Time& stamp) const {
    const rclcpp::Time sent(stamp, clock->get_clock_type());
    if (sent.nanoseconds() == 0) return "";
    const double age = (clock->now() - sent).seconds();
    if (std::abs(age) <= oldest) return "";
    return "header.stamp: expected now, or zero, got " +
           chain_dynamics::numberText(std::abs(age), 3) + " s " + (age > 0 ? "ago" : "ahead") +
           "; reference_timeout is " + chain_dynamics::numberText(oldest) + " s";
  }
};

ReferenceTopic::ReferenceTopic(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                               const ReferenceLayout& layout,
                               const std::vector<std::string>& joints, double oldest)
    : inbox_(new Inbox{layout, joints, oldest,
                       LatestValue<std::vector<double>>(std::vector<double>(layout.size())),
                       node->get_logger(), node->get_clock()}),
      subscription_(node->create_subscription<JointTrajectory>(
          "~/reference", rclcpp::SystemDefaultsQoS(),
          [inbox = inbox_](const JointTrajectory& message) { inbox->receive(message); })) {}

bool ReferenceTopic::read(std::vector<double>& values) noexcept {
  const std::vector<double>* const newest = inbox_->newest.take();
  if (newest == nullptr || values.size() != newest->size()) return false;
  std::copy(newest->begin(), newest->end(), values.begin());
  return true;
}

}  // namespace inverse_dynamics_controllers

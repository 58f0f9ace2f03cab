// SPDX-License-Identifier: Apache-2.0

#include "live_load.hpp"

#include <Eigen/Core>
#include <chain_dynamics/joint_frame.hpp>
#include <chrono>
#include <cstdint>
#include <diagnostic_msgs/msg/diagnostic_status.hpp>
#include <exception>
#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/variable_gravity.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <string>
#include <utility>

#include "overridable.hpp"

namespace inverse_dynamics_ros {
namespace {

using geometry_msgs::msg::Vector3Stamped;
using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::VariableGravity;
using sensor_msgs::msg::Imu;

constexpr std::chrono::milliseconds kStep(10);
[[noreturn]] void throwUnchangeable(const std::string& plugin) {
  throw InvalidParameterValueException("gravity", "the solver's gravity can't change",
                                       "a solver with the capability VariableGravity", plugin,
                                       "use another solver, or set ids.gravity");
}

}  // namespace

LiveLoad::LiveLoad(rclcpp::Node& node, const live_node::Params& params)
    : node_(node),
      params_(params.gravity_from_imu),
      carried_(node, rclcpp::QoS(1), overridable<rclcpp::SubscriptionOptions>(),
               [logger = node.get_logger()](const std::string& line) {
                 RCLCPP_ERROR(logger, "%s", line.c_str());
               }) {
  using Options = rclcpp::SubscriptionOptions;
  gravities_ = node.create_subscription<Vector3Stamped>(
      "~/gravity", rclcpp::QoS(1), [this](const Vector3Stamped& message) { takeGravity(message); },
      overridable<Options>());
  if (params_.use == "nothing") return;
  imus_ = node.create_subscription<Imu>(
      "imu", rclcpp::SensorDataQoS(), [this](const Imu& message) { takeImu(message); },
      overridable<Options>());
  timer_ = node.create_wall_timer(kStep, [this] { step(); });
}

std::shared_ptr<LiveLoad::PayloadRamp> LiveLoad::make(const LiveRobot& robot) const {
  if ((imus_ != nullptr || gravity_) &&
      dynamic_cast<VariableGravity*>(robot.solver.get()) == nullptr) {
    throwUnchangeable(robot.plugin);
  }
  return carried_.rampOf(robot.solver);
}

void LiveLoad::use(std::shared_ptr<PayloadRamp> ramp, const LiveRobot& robot) {
  carried_.use(std::move(ramp), robot.tip);
  robot_ = robot;
  variable_ = dynamic_cast<VariableGravity*>(robot_.solver.get());
  if (variable_ != nullptr && gravity_) variable_->setGravity(*gravity_);
  if (imus_ != nullptr) openImu();
}

// Begins with the solver's gravity.
void LiveLoad::openImu() {
  imu_.emplace(params_.use == "orientation" ? GravityFromImu::Source::kOrientation
                                            : GravityFromImu::Source::kAcceleration,
               chain_dynamics::rotationFromRollPitchYaw(Eigen::Vector3d(params_.rpy.data())),
               params_.time_constant, variable_->gravity());
}

void LiveLoad::takeGravity(const Vector3Stamped& message) {
  try {
    inverse_dynamics_control::requireFrame(message.header.frame_id, robot_.root, "root");
    if (imus_ != nullptr) {
      throw InvalidParameterValueException(
          "gravity", "of another source", "nothing", "a message",
          "gravity comes from the IMU: set gravity_from_imu.use to nothing");
    }
    if (variable_ == nullptr) throwUnchangeable(robot_.plugin);
    const Eigen::Vector3d gravity(message.vector.x, message.vector.y, message.vector.z);
    variable_->setGravity(gravity);
    gravity_ = gravity;
  } catch (const std::exception& error) {
    RCLCPP_ERROR(node_.get_logger(), "%s: ignored: %s", gravities_->get_topic_name(), error.what());
  }
}

void LiveLoad::takeImu(const Imu& message) {
  if (!imu_) return;
  std::int64_t stamp = rclcpp::Time(message.header.stamp).nanoseconds();
  if (stamp == 0) stamp = node_.now().nanoseconds();
  const GravityFromImu::Outcome outcome = imu_->update(message, stamp);
  if (outcome == GravityFromImu::Outcome::kTaken) {
    gravity_ = imu_->gravity();
    return;
  }
  RCLCPP_ERROR_THROTTLE(node_.get_logger(), steady_, kReminder,
                        "%s: ignored: expected a finite %s, got %s", imus_->get_topic_name(),
                        params_.use.c_str(),
                        outcome == GravityFromImu::Outcome::kAbsent
                            ? "a covariance that begins with -1: it isn't measured"
                            : "something else");
}

void LiveLoad::step() {
  if (imu_ && gravity_ && *gravity_ != variable_->gravity()) variable_->setGravity(*gravity_);
}

void LiveLoad::report(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  status.summary(diagnostic_msgs::msg::DiagnosticStatus::OK, "body at the tip, and gravity");
  status.add("mass at the tip [kg]", body().mass);
  if (variable_ != nullptr) {
    const Eigen::Vector3d gravity = variable_->gravity();
    status.addf("gravity [m/s^2]", "%.3f %.3f %.3f", gravity.x(), gravity.y(), gravity.z());
  }
}

}  // namespace inverse_dynamics_ros

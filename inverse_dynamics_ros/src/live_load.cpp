// SPDX-License-Identifier: Apache-2.0

#include "live_load.hpp"

#include <Eigen/Geometry>
#include <chrono>
#include <diagnostic_msgs/msg/diagnostic_status.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <string>
#include <utility>
#include <vector>

#include "overridable.hpp"

namespace inverse_dynamics_ros {
namespace {

using geometry_msgs::msg::InertiaStamped;
using geometry_msgs::msg::Vector3Stamped;
using inverse_dynamics_control::RigidBody;
using inverse_dynamics_solver::errorText;
using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::VariableGravity;
using sensor_msgs::msg::Imu;

constexpr std::chrono::milliseconds kStep(10);
constexpr int kReminder = 10'000;  // ms between two log lines that say the same

[[noreturn]] void throwUnchangeable(const std::string& plugin) {
  throw InvalidParameterValueException(errorText("gravity", "the solver's gravity can't change",
                                                 "a solver with the capability VariableGravity",
                                                 plugin, "use another solver, or set ids.gravity"));
}

// Turns about the fixed axes x, y, z, in this order.
Eigen::Matrix3d rotation(const std::vector<double>& rpy) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(rpy[2], Vector3d::UnitZ()) * AngleAxisd(rpy[1], Vector3d::UnitY()) *
          AngleAxisd(rpy[0], Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace

LiveLoad::LiveLoad(rclcpp::Node& node, std::shared_ptr<live_node::ParamListener> listener)
    : node_(node), listener_(std::move(listener)), params_(listener_->get_params()) {
  body_ = bodyOfParameters();
  checking_ = node.add_on_set_parameters_callback(
      [this](const std::vector<rclcpp::Parameter>& wanted) { return check(wanted); });
  using Options = rclcpp::SubscriptionOptions;
  payloads_ = node.create_subscription<InertiaStamped>(
      "~/payload", rclcpp::QoS(1), [this](const InertiaStamped& message) { takePayload(message); },
      overridable<Options>());
  gravities_ = node.create_subscription<Vector3Stamped>(
      "~/gravity", rclcpp::QoS(1), [this](const Vector3Stamped& message) { takeGravity(message); },
      overridable<Options>());
  if (params_.gravity_from_imu.use != "nothing") {
    imus_ = node.create_subscription<Imu>(
        "imu", rclcpp::SensorDataQoS(), [this](const Imu& message) { takeImu(message); },
        overridable<Options>());
  }
  timer_ = node.create_wall_timer(kStep, [this] { step(); });
}

std::unique_ptr<LiveLoad::PayloadRamp> LiveLoad::make(const LiveRobot& robot) const {
  if ((imus_ != nullptr || gravity_) &&
      dynamic_cast<VariableGravity*>(robot.solver.get()) == nullptr) {
    throwUnchangeable(robot.plugin);
  }
  return std::make_unique<PayloadRamp>(robot.solver, body_, params_.payload.ramp_time);
}

void LiveLoad::use(std::unique_ptr<PayloadRamp> ramp, const LiveRobot& robot) {
  ramp_ = std::move(ramp);
  robot_ = robot;
  variable_ = dynamic_cast<VariableGravity*>(robot_.solver.get());
  if (variable_ != nullptr && gravity_) variable_->setGravity(*gravity_);
  if (imus_ != nullptr) openImu();
}

// Begins with the solver's gravity.
void LiveLoad::openImu() {
  const auto& parameters = params_.gravity_from_imu;
  imu_.emplace(parameters.use == "orientation" ? GravityFromImu::Source::kOrientation
                                               : GravityFromImu::Source::kAcceleration,
               rotation(parameters.rpy), parameters.time_constant, variable_->gravity());
}

// The parameters, some of them with other values.
RigidBody LiveLoad::bodyOfParameters(const std::vector<rclcpp::Parameter>& wanted) const {
  const auto value = [&](const std::string& name) {
    for (const rclcpp::Parameter& parameter : wanted) {
      if (parameter.get_name() == name) return parameter;
    }
    return node_.get_parameter(name);
  };
  return inverse_dynamics_control::bodyOf(
      value("payload.mass").as_double(), value("payload.center_of_mass").as_double_array(),
      value("payload.inertia").as_double_array(), "parameter payload.");
}

rcl_interfaces::msg::SetParametersResult LiveLoad::check(
    const std::vector<rclcpp::Parameter>& wanted) const {
  rcl_interfaces::msg::SetParametersResult result;
  result.successful = true;
  try {
    const RigidBody body = bodyOfParameters(wanted);
    if (ramp_ != nullptr) ramp_->requireCarrier(body);
  } catch (const std::exception& error) {
    result.successful = false;
    result.reason = error.what();
  }
  return result;
}

void LiveLoad::takePayload(const InertiaStamped& message) {
  try {
    aimAt(inverse_dynamics_control::bodyOf(message, robot_.tip));
  } catch (const std::exception& error) {
    RCLCPP_ERROR(node_.get_logger(), "%s: ignored: %s", payloads_->get_topic_name(), error.what());
  }
}

void LiveLoad::takeGravity(const Vector3Stamped& message) {
  try {
    inverse_dynamics_control::requireFrame(message.header.frame_id, robot_.root, "root");
    if (imus_ != nullptr) {
      throw InvalidParameterValueException(
          errorText("gravity", "of another source", "nothing", "a message",
                    "gravity comes from the IMU: set gravity_from_imu.use to nothing"));
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
                        params_.gravity_from_imu.use.c_str(),
                        outcome == GravityFromImu::Outcome::kAbsent
                            ? "a covariance that begins with -1: it isn't measured"
                            : "something else");
}

void LiveLoad::aimAt(const RigidBody& body) {
  if (ramp_ != nullptr) ramp_->aimAt(body);
  body_ = body;
}

// Parameters are looked at here: a change that passes check() may be refused by others.
void LiveLoad::step() {
  if (listener_->is_old(params_)) {
    params_ = listener_->get_params();
    try {
      aimAt(bodyOfParameters());
    } catch (const std::exception& error) {
      RCLCPP_ERROR(node_.get_logger(), "payload: ignored: %s", error.what());
    }
  }
  if (ramp_ != nullptr) ramp_->advance(std::chrono::duration<double>(kStep).count());
  if (imu_ && gravity_ && *gravity_ != variable_->gravity()) variable_->setGravity(*gravity_);
}

void LiveLoad::report(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  status.summary(diagnostic_msgs::msg::DiagnosticStatus::OK, "body at the tip, and gravity");
  status.add("mass at the tip [kg]", body_.mass);
  if (variable_ != nullptr) {
    const Eigen::Vector3d gravity = variable_->gravity();
    status.addf("gravity [m/s^2]", "%.3f %.3f %.3f", gravity.x(), gravity.y(), gravity.z());
  }
}

}  // namespace inverse_dynamics_ros

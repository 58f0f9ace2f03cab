// SPDX-License-Identifier: Apache-2.0

#include "live_payload_action.hpp"

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <geometry_msgs/msg/inertia.hpp>
#include <geometry_msgs/msg/inertia_stamped.hpp>
#include <inverse_dynamics_control/joint_parameters.hpp>
#include <string>
#include <utility>
#include <vector>

#include "overridable.hpp"
#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using geometry_msgs::msg::InertiaStamped;
using inverse_dynamics_identification::PayloadEstimate;
using inverse_dynamics_identification::PayloadStatus;
using Result = LivePayloadAction::EstimatePayload::Result;

constexpr std::chrono::milliseconds kFeedback(500);

std::string inWords(const PayloadEstimate& found) {
  const Eigen::Vector3d c = 1e3 * found.center_of_mass, w = 1e3 * found.center_of_mass_half_width;
  char text[300];
  std::snprintf(
      text, sizeof text,
      "%.3g +- %.2g kg, center of mass %.0f +- %.0f, %.0f +- %.0f, %.0f +- %.0f mm (95 %%), "
      "%s; %.1f s",
      found.mass, found.mass_half_width, c.x(), w.x(), c.y(), w.y(), c.z(), w.z(),
      found.inertia_is_known ? "inertia known" : "inertia not known: a point mass", found.duration);
  return text;
}

template <class Vector>
void assign(const Eigen::Vector3d& from, Vector& to) {
  to.x = from.x();
  to.y = from.y();
  to.z = from.z();
}

void assign(const inverse_dynamics_solver::RigidBody& body, geometry_msgs::msg::Inertia& message) {
  message.m = body.mass;
  assign(body.center_of_mass, message.com);
  message.ixx = body.inertia(0, 0);
  message.ixy = body.inertia(0, 1);
  message.ixz = body.inertia(0, 2);
  message.iyy = body.inertia(1, 1);
  message.iyz = body.inertia(1, 2);
  message.izz = body.inertia(2, 2);
}

// Of mass and center of mass, from that of mass and first moment.
Eigen::Matrix4d covariance(const PayloadEstimate& found) {
  Eigen::Matrix4d J = Eigen::Matrix4d::Identity();
  J.bottomRightCorner<3, 3>() /= found.mass;
  J.bottomLeftCorner<3, 1>() = -found.center_of_mass / found.mass;
  return J * found.covariance.topLeftCorner<4, 4>() * J.transpose();
}

std::shared_ptr<Result> failed(std::int32_t code, const std::string& text) {
  auto result = std::make_shared<Result>();
  result->error_code = code;
  result->message = text;
  return result;
}

}  // namespace

LivePayloadAction::LivePayloadAction(rclcpp::Node& node, const live_node::Params& params,
                                     std::function<RigidBody()> carried)
    : node_(node), params_(params), carried_(std::move(carried)) {
  publisher_ =
      node.create_publisher<InertiaStamped>("~/estimated_payload", rclcpp::QoS(1).transient_local(),
                                            overridable<rclcpp::PublisherOptions>());
  timer_ = node.create_wall_timer(kFeedback, [this] { step(); });
  server_ = rclcpp_action::create_server<EstimatePayload>(
      &node, "~/estimate_payload",
      [](const rclcpp_action::GoalUUID&, const std::shared_ptr<const EstimatePayload::Goal>&) {
        return rclcpp_action::GoalResponse::ACCEPT_AND_EXECUTE;  // a refusal couldn't say why
      },
      [](const std::shared_ptr<Goal>&) { return rclcpp_action::CancelResponse::ACCEPT; },
      [this](const std::shared_ptr<Goal>& goal) { accept(goal); });
}

void LivePayloadAction::use(const LiveRobot& robot) {
  robot_ = robot;
  if (goal_ != nullptr) end(failed(Result::NOT_READY, "another robot description has come"));
}

void LivePayloadAction::accept(const std::shared_ptr<Goal>& goal) {
  const double duration = goal->get_goal()->duration;
  try {
    if (goal_ != nullptr) {
      throw UserError("estimate_payload", "one goal at a time", "a second one", "cancel the first");
    }
    if (!(duration >= 0)) {
      throw UserError("duration", "seconds, or 0", std::to_string(duration), "correct it");
    }
    if (robot_.solver == nullptr) {
      throw UserError("estimate_payload", "a solver", "none yet", "wait for the robot description");
    }
    payload_ = std::make_unique<LivePayload>(robot_.solver, options());
    goal_ = goal;
    first_ = last_ = 0;
  } catch (const std::exception& error) {
    goal->abort(failed(Result::NOT_READY, error.what()));
  }
}

void LivePayloadAction::take(std::int64_t stamp, const LiveTorques& live) {
  if (goal_ == nullptr) return;
  payload_->update(stamp, live.position(), live.velocity(), live.measured());
  if (first_ == 0 || stamp < last_) first_ = stamp;  // a clock that goes back begins again
  last_ = stamp;
  const double duration = goal_->get_goal()->duration;
  if (duration > 0 && 1e-9 * static_cast<double>(last_ - first_) >= duration) end(found());
}

LivePayloadOptions LivePayloadAction::options() const {
  const std::vector<double>& noise = params_.estimate_payload.noise;
  if (noise.empty()) {
    throw UserError("parameter 'estimate_payload.noise'",
                    "how far measured torques are from those of the model without a load [N m]",
                    "nothing", "set it: `ids evaluate` of a recording tells");
  }
  LivePayloadOptions options;
  options.cutoff = params_.cutoff;
  options.longest_gap = params_.longest_gap;
  options.noise = inverse_dynamics_control::jointNumbers("estimate_payload.noise", noise,
                                                         robot_.solver->jointNames());
  options.carried = carried_();
  options.without_gravity = robot_.efforts_without_gravity;
  if (options.without_gravity && options.carried.mass > 0) {
    throw UserError("estimate_payload", "no payload where efforts lack gravity",
                    std::to_string(options.carried.mass) + " kg",
                    "set payload.mass to 0, and remove it from the robot's own settings");
  }
  return options;
}

// Ends a canceled goal, or tells how far it is.
void LivePayloadAction::step() {
  if (goal_ == nullptr) return;
  if (goal_->is_canceling()) {
    end(found());
    return;
  }
  const auto feedback = std::make_shared<EstimatePayload::Feedback>();
  feedback->duration = 1e-9 * static_cast<double>(last_ - first_);
  PayloadEstimate estimate(robot_.solver->jointCount());
  if (payload_->estimate(estimate) == PayloadStatus::kOk) {
    feedback->mass = estimate.mass;
    feedback->mass_half_width = estimate.mass_half_width;
    assign(estimate.center_of_mass, feedback->center_of_mass);
  }
  goal_->publish_feedback(feedback);
}

void LivePayloadAction::end(std::shared_ptr<Result> result) {
  const auto goal = std::exchange(goal_, nullptr);
  payload_.reset();
  const bool found = result->error_code == Result::SUCCESSFUL;
  if (found) {
    RCLCPP_INFO(node_.get_logger(), "estimated payload: %s", result->message.c_str());
    publisher_->publish(result->payload);
  }
  if (goal->is_canceling()) {
    goal->canceled(std::move(result));
  } else if (found) {
    goal->succeed(std::move(result));
  } else {
    goal->abort(std::move(result));
  }
}

std::shared_ptr<Result> LivePayloadAction::found() {
  PayloadEstimate estimate(robot_.solver->jointCount());
  const PayloadStatus status = payload_->estimate(estimate);
  if (status != PayloadStatus::kOk) {
    return failed(Result::TOO_SHORT, std::string("no estimate: ") + text(status));
  }
  if (!(estimate.mass_half_width < estimate.mass)) {
    return failed(Result::NO_LOAD, "no load is found: " + inWords(estimate));
  }
  auto result = std::make_shared<Result>();
  result->message = inWords(estimate);
  result->payload.header.stamp = node_.now();
  result->payload.header.frame_id = robot_.tip;
  assign(estimate.body(), result->payload.inertia);
  result->mass_half_width = estimate.mass_half_width;
  assign(estimate.center_of_mass_half_width, result->center_of_mass_half_width);
  Eigen::Matrix4d::Map(result->covariance.data()) = covariance(estimate);  // symmetric
  result->duration = estimate.duration;
  return result;
}

}  // namespace inverse_dynamics_ros

// SPDX-License-Identifier: Apache-2.0

#include "live_payload_services.hpp"

#include <cstdio>
#include <exception>
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

}  // namespace

LivePayloadServices::LivePayloadServices(rclcpp::Node& node, const live_node::Params& params,
                                         std::function<RigidBody()> carried)
    : node_(node), params_(params), carried_(std::move(carried)) {
  publisher_ =
      node.create_publisher<InertiaStamped>("~/estimated_payload", rclcpp::QoS(1).transient_local(),
                                            overridable<rclcpp::PublisherOptions>());
  const auto service = [&node](const char* name, auto method) {
    return node.create_service<Trigger>(
        // NOLINTNEXTLINE(performance-unnecessary-value-param): the type that rclcpp asks for
        name, [method](const Trigger::Request::SharedPtr, const Trigger::Response::SharedPtr r) {
          try {
            method(*r);
          } catch (const std::exception& error) {
            r->success = false;
            r->message = error.what();
          }
        });
  };
  start_ = service("~/estimate_payload/start", [this](Trigger::Response& r) { start(r); });
  stop_ = service("~/estimate_payload/stop", [this](Trigger::Response& r) { stop(r); });
}

void LivePayloadServices::use(const LiveRobot& robot) {
  robot_ = robot;
  payload_.reset();
}

void LivePayloadServices::take(std::int64_t stamp, const LiveTorques& live) {
  if (payload_ != nullptr) {
    payload_->update(stamp, live.position(), live.velocity(), live.measured());
  }
}

LivePayloadOptions LivePayloadServices::options() const {
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

void LivePayloadServices::start(Trigger::Response& response) {
  if (robot_.solver == nullptr) {
    throw UserError("estimate_payload", "a solver", "none yet", "wait for the robot description");
  }
  payload_ = std::make_unique<LivePayload>(robot_.solver, options());
  response.success = true;
  response.message = "move all joints for a few seconds, the wrist above all";
}

void LivePayloadServices::stop(Trigger::Response& response) {
  if (payload_ == nullptr) {
    throw UserError("estimate_payload", "an estimate that is under way", "none",
                    "call start before stop");
  }
  PayloadEstimate found(robot_.solver->jointCount());
  const PayloadStatus status = payload_->estimate(found);
  payload_.reset();
  if (status != PayloadStatus::kOk) throw UserError(std::string("no estimate: ") + text(status));
  response.message = inWords(found);
  response.success = found.mass_half_width < found.mass;
  if (!response.success) {
    response.message = "no load is found: " + response.message;
    return;
  }
  publish(found.body());
  RCLCPP_INFO(node_.get_logger(), "estimated payload: %s", response.message.c_str());
}

void LivePayloadServices::publish(const RigidBody& body) {
  InertiaStamped message;
  message.header.stamp = node_.now();
  message.header.frame_id = robot_.tip;
  message.inertia.m = body.mass;
  message.inertia.com.x = body.center_of_mass.x();
  message.inertia.com.y = body.center_of_mass.y();
  message.inertia.com.z = body.center_of_mass.z();
  message.inertia.ixx = body.inertia(0, 0);
  message.inertia.ixy = body.inertia(0, 1);
  message.inertia.ixz = body.inertia(0, 2);
  message.inertia.iyy = body.inertia(1, 1);
  message.inertia.iyz = body.inertia(1, 2);
  message.inertia.izz = body.inertia(2, 2);
  publisher_->publish(message);
}

}  // namespace inverse_dynamics_ros

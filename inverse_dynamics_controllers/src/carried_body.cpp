// SPDX-License-Identifier: Apache-2.0
#include "carried_body.hpp"

#include <algorithm>
#include <chrono>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace inverse_dynamics_controllers {

using geometry_msgs::msg::InertiaStamped;
using inverse_dynamics_solver::errorText;
using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::Payload;
using inverse_dynamics_solver::RigidBody;

namespace {

const char* const kName = "carried";  // among the solver's bodies
constexpr std::chrono::milliseconds kStep(10);

Eigen::Matrix3d symmetric(double xx, double xy, double xz, double yy, double yz, double zz) {
  Eigen::Matrix3d tensor;
  tensor << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return tensor;
}

// Throws what is wrong with a body; `where` it comes from.
void requirePossible(const RigidBody& body, const std::string& where) {
  const auto defect = inverse_dynamics_solver::defectOf(body);
  if (!defect) return;
  throw InvalidParameterValueException(errorText(where + defect->field, "no possible body",
                                                 defect->expected, defect->got, defect->remedy));
}

void requireCarrier(const Payload* carrier, const std::string& plugin_name) {
  if (carrier != nullptr) return;
  throw InvalidParameterValueException(
      errorText("payload", "the solver can't carry any", "a solver with the capability Payload",
                plugin_name, "use another solver, or leave the mass at 0"));
}

std::vector<std::string> parameterNames() {
  return {"payload.mass", "payload.center_of_mass", "payload.inertia"};
}

RigidBody bodyOf(const ParameterValues& values) {
  const auto& c = values.at("payload.center_of_mass").get<std::vector<double>>();
  const auto& i = values.at("payload.inertia").get<std::vector<double>>();
  if (c.size() != 3 || i.size() != 6) {
    throw InvalidParameterValueException(
        errorText("parameters 'payload'", "wrong size", "3 numbers of center_of_mass, 6 of inertia",
                  std::to_string(c.size()) + " and " + std::to_string(i.size()), "correct them"));
  }
  RigidBody body;
  body.mass = values.at("payload.mass").get<double>();
  body.center_of_mass << c[0], c[1], c[2];
  body.inertia = symmetric(i[0], i[1], i[2], i[3], i[4], i[5]);
  requirePossible(body, "parameter payload.");
  return body;
}

RigidBody bodyOf(const InertiaStamped& message, const std::string& tip) {
  const auto& frame = message.header.frame_id;
  if (!frame.empty() && frame != tip) {
    throw InvalidParameterValueException(
        errorText("header.frame_id", "another frame", "the tip" + (tip.empty() ? "" : " " + tip),
                  frame, "give the body in the tip frame, or leave frame_id empty"));
  }
  const auto& inertia = message.inertia;
  RigidBody body;
  body.mass = inertia.m;
  body.center_of_mass << inertia.com.x, inertia.com.y, inertia.com.z;
  body.inertia =
      symmetric(inertia.ixx, inertia.ixy, inertia.ixz, inertia.iyy, inertia.iyz, inertia.izz);
  requirePossible(body, "inertia.");
  return body;
}

std::string tipOf(const Setup& setup) {
  rclcpp::Parameter tip;
  return setup.node->get_parameter("ids.tip", tip) ? tip.value_to_string() : "";
}

}  // namespace

RigidBody between(const RigidBody& from, const RigidBody& to, double part) {
  const double m0 = (1.0 - part) * from.mass, m1 = part * to.mass;
  RigidBody body;
  body.mass = m0 + m1;
  if (!(body.mass > 0)) return body;
  body.center_of_mass = (m0 * from.center_of_mass + m1 * to.center_of_mass) / body.mass;
  const auto about = [&body](const RigidBody& other, double weight, double mass) {
    const Eigen::Vector3d d = other.center_of_mass - body.center_of_mass;
    return Eigen::Matrix3d(weight * other.inertia +
                           mass *
                               (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose()));
  };
  body.inertia = about(from, 1.0 - part, m0) + about(to, part, m1);
  return body;
}

/// From one body to another, in the threads of the node's executor.
struct CarriedBody::Ramp {
  std::shared_ptr<inverse_dynamics_solver::InverseDynamicsSolver> solver;
  Payload* carrier;  // the solver; null: it has none
  double time;       // s
  std::mutex mutex;
  RigidBody from, to;
  double part = 1.0;

  void aimAt(const RigidBody& body) {
    const std::lock_guard<std::mutex> lock(mutex);
    from = between(from, to, part);
    to = body;
    part = 0.0;
  }

  void advance(double seconds) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (part >= 1.0) return;
    part = time > 0 ? std::min(1.0, part + seconds / time) : 1.0;
    set(between(from, to, part));
  }

  void set(const RigidBody& body) {
    if (body.mass > 0) {
      carrier->setPayload(kName, body);
    } else {
      carrier->removePayload(kName);
    }
  }
};

CarriedBody::CarriedBody(const Setup& setup) {
  const auto& solver = setup.arm.solver;
  const RigidBody first =
      bodyOf(valuesOf(*setup.node->get_node_parameters_interface(), parameterNames()));
  const std::string plugin_name = setup.parameters.plugin_name;
  ramp_.reset(new Ramp{solver,
                       dynamic_cast<Payload*>(solver.get()),
                       setup.parameters.payload.ramp_time,
                       {},
                       first,
                       first});
  if (first.mass > 0) {
    requireCarrier(ramp_->carrier, plugin_name);
    ramp_->set(first);
  }

  const auto check = [plugin_name, carrier = ramp_->carrier](const ParameterValues& values) {
    if (bodyOf(values).mass > 0) requireCarrier(carrier, plugin_name);
  };
  const auto apply = [ramp = ramp_](const ParameterValues& values) {
    if (ramp->carrier != nullptr) ramp->aimAt(bodyOf(values));
  };
  watch_ = std::make_unique<ParameterWatch>(setup.node, parameterNames(), check, apply);

  const auto receive = [ramp = ramp_, plugin_name, tip = tipOf(setup),
                        logger = setup.node->get_logger()](const InertiaStamped& message) {
    try {
      const RigidBody body = bodyOf(message, tip);
      requireCarrier(ramp->carrier, plugin_name);
      ramp->aimAt(body);
    } catch (const std::exception& error) {
      RCLCPP_ERROR(logger, "~/payload: ignored: %s", error.what());
    }
  };
  subscription_ = setup.node->create_subscription<InertiaStamped>(
      "~/payload", rclcpp::SystemDefaultsQoS(), receive);
  timer_ = setup.node->create_wall_timer(
      kStep, [ramp = ramp_] { ramp->advance(std::chrono::duration<double>(kStep).count()); });
}

}  // namespace inverse_dynamics_controllers

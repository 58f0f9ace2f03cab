// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/payload_ramp.hpp"

#include <algorithm>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::Payload;

const char* const kCarried = "carried";  // among the solver's bodies

Eigen::Matrix3d symmetric(const std::vector<double>& i) {
  Eigen::Matrix3d tensor;
  tensor << i[0], i[1], i[2], i[1], i[3], i[4], i[2], i[4], i[5];
  return tensor;
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

RigidBody bodyOf(double mass, const std::vector<double>& center_of_mass,
                 const std::vector<double>& inertia, const std::string& where) {
  const auto& c = center_of_mass;
  if (c.size() != 3 || inertia.size() != 6) {
    throw InvalidParameterValueException(
        where + "*", "wrong size", "3 numbers of center_of_mass, 6 of inertia",
        std::to_string(c.size()) + " and " + std::to_string(inertia.size()), "correct them");
  }
  RigidBody body;
  body.mass = mass;
  body.center_of_mass << c[0], c[1], c[2];
  body.inertia = symmetric(inertia);
  if (const auto defect = inverse_dynamics_solver::defectOf(body)) {
    throw InvalidParameterValueException(where + defect->field, "no possible body",
                                         defect->expected, defect->got, defect->remedy);
  }
  return body;
}

void requireFrame(const std::string& frame, const std::string& link, const std::string& role) {
  if (frame.empty() || frame == link) return;
  throw InvalidParameterValueException(
      "header.frame_id", "another frame", "the " + role + (link.empty() ? "" : " " + link), frame,
      "give it in the " + role + " frame, or leave frame_id empty");
}

PayloadRamp::PayloadRamp(std::shared_ptr<InverseDynamicsSolver> solver, const RigidBody& first,
                         double time)
    : solver_(std::move(solver)),
      carrier_(dynamic_cast<Payload*>(solver_.get())),
      time_(time),
      from_(first),
      to_(first) {
  requireCarrier(first);
  if (first.mass > 0) set(first);
}

void PayloadRamp::requireCarrier(const RigidBody& body) const {
  if (carrier_ != nullptr || !(body.mass > 0)) return;
  throw InvalidParameterValueException("payload", "the solver can't carry any",
                                       "a solver with the capability Payload", "none of it",
                                       "use another solver, or leave the mass at 0");
}

void PayloadRamp::aimAt(const RigidBody& body) {
  requireCarrier(body);
  const std::lock_guard<std::mutex> lock(mutex_);
  from_ = between(from_, to_, part_);
  to_ = body;
  part_ = 0.0;
}

void PayloadRamp::advance(double seconds) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (part_ >= 1.0) return;
  part_ = time_ > 0 ? std::min(1.0, part_ + seconds / time_) : 1.0;
  if (carrier_ != nullptr) set(between(from_, to_, part_));
}

RigidBody PayloadRamp::target() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return to_;
}

void PayloadRamp::set(const RigidBody& body) {
  if (body.mass > 0) {
    carrier_->setPayload(kCarried, body);
  } else {
    carrier_->removePayload(kCarried);
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_control

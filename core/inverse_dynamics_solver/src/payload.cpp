// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/payload.hpp"

#include <optional>
#include <string>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/spatial.hpp"
#include "chain_dynamics/text.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

using chain_dynamics::LinkParameters;
using chain_dynamics::Transform;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kTolerance = 1e-9;  // of a rotation, of symmetry: what ten printed digits leave
constexpr double kGreatest = 1e15;   // three multiplied are far below what a chain may have

std::string text(double value) { return chain_dynamics::numberText(value, 10); }

std::string text(const Vector3d& value) {
  return "[" + text(value.x()) + ", " + text(value.y()) + ", " + text(value.z()) + "]";
}

/// Finite, and products of them too. (A NaN is in no range.)
template <class Matrix>
bool isUsable(const Matrix& numbers) {
  return (numbers.array().abs() <= kGreatest).all();
}

std::optional<BodyDefect> rotationDefect(const Matrix3d& R) {
  const double error = (R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (error <= kTolerance && R.determinant() > 0) return {};
  return BodyDefect{
      "frame", "a rotation matrix",
      "columns off orthonormal by " + text(error) + ", determinant " + text(R.determinant()),
      "make it from angles or a unit quaternion"};
}

std::optional<BodyDefect> inertiaDefect(const RigidBody& body) {
  const double asymmetry = (body.inertia - body.inertia.transpose()).cwiseAbs().maxCoeff();
  if (asymmetry > kTolerance * body.inertia.cwiseAbs().maxCoeff()) {
    return BodyDefect{"inertia", "a symmetric matrix", "entries that differ by " + text(asymmetry),
                      ""};
  }
  const std::string defect =
      chain_dynamics::inertiaDefect(LinkParameters{body.mass, Vector3d::Zero(), body.inertia});
  if (defect.empty()) return {};
  return BodyDefect{"inertia", "that of a rigid body about its center of mass", defect,
                    "a URDF states it so too; leave it out for a point mass"};
}

}  // namespace

bool operator==(const RigidBody& a, const RigidBody& b) {
  return a.mass == b.mass && a.center_of_mass == b.center_of_mass && a.inertia == b.inertia &&
         a.frame.R == b.frame.R && a.frame.p == b.frame.p && a.tip == b.tip;
}

LinkParameters inTipFrame(const RigidBody& body) {
  return body.frame *
         LinkParameters::fromCenterOfMass(body.mass, body.center_of_mass, body.inertia);
}

std::optional<BodyDefect> defectOf(const RigidBody& body) {
  if (!(body.mass >= 0 && body.mass <= kGreatest)) {
    return BodyDefect{"mass", "a finite number >= 0 [kg]", text(body.mass), ""};
  }
  if (!isUsable(body.center_of_mass)) {
    return BodyDefect{"center_of_mass", "3 finite numbers [m]", text(body.center_of_mass), ""};
  }
  if (!isUsable(body.inertia)) {
    return BodyDefect{"inertia", "finite numbers [kg m^2]", "a NaN, or one that is too large", ""};
  }
  if (!isUsable(body.frame.R) || !isUsable(body.frame.p)) {
    return BodyDefect{"frame", "finite numbers", "a NaN, or one that is too large", ""};
  }
  if (auto defect = rotationDefect(body.frame.R)) return defect;
  return inertiaDefect(body);
}

Payload::~Payload() = default;

void Payload::setPayload(const std::string& name, const RigidBody& body) {
  jointsFor("setPayload");
  if (name.empty() || !chain_dynamics::isPrintable(name)) {
    throw InvalidParameterValueException("setPayload: argument name", "wrong value",
                                         "UTF-8 text, not empty", "'" + name + "'",
                                         "it names the body for removePayload()");
  }
  if (const auto defect = defectOf(body)) {
    throw InvalidParameterValueException("setPayload: body '" + name + "'", defect->field,
                                         defect->expected, defect->got, defect->remedy);
  }
  changePayloads([&](Payloads& bodies) { bodies[name] = body; });
}

bool Payload::removePayload(const std::string& name) {
  jointsFor("removePayload");
  bool found = false;
  changePayloads([&](Payloads& bodies) { found = bodies.erase(name) > 0; });
  return found;
}

void Payload::clearPayloads() {
  jointsFor("clearPayloads");
  changePayloads([](Payloads& bodies) { bodies.clear(); });
}

Payloads Payload::payloads() const {
  jointsFor("payloads");
  return currentPayloads();
}

}  // namespace v2
}  // namespace inverse_dynamics_solver

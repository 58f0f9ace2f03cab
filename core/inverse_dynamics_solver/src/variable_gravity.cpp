// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/variable_gravity.hpp"

#include <sstream>
#include <string>

#include "chain_dynamics/gravity.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

void requireModerate(const char* method, const char* argument, const Eigen::Vector3d& values) {
  // The comparison is false for a NaN.
  if ((values.array().abs() <= chain_dynamics::kGreatestGravity).all()) return;
  std::ostringstream got;
  got << values.x() << ", " << values.y() << ", " << values.z();
  throw InvalidParameterValueException(
      std::string(method) + ": argument " + argument, "wrong value",
      "3 finite numbers up to 1e6 [m/s^2] in the axes of the root link", got.str(),
      "keep the last value where a sensor fails");
}

}  // namespace

VariableGravity::~VariableGravity() = default;

auto VariableGravity::required(const char* method) const -> BaseMotion {
  jointsFor(method);
  return currentBaseMotion();
}

void VariableGravity::setGravity(const Eigen::Vector3d& gravity) {
  required("setGravity");
  requireModerate("setGravity", "gravity", gravity);
  changeBaseMotion([&](BaseMotion& base) { base.gravity = gravity; });
}

void VariableGravity::setBaseAcceleration(const Eigen::Vector3d& acceleration) {
  required("setBaseAcceleration");
  requireModerate("setBaseAcceleration", "acceleration", acceleration);
  changeBaseMotion([&](BaseMotion& base) { base.acceleration = acceleration; });
}

Eigen::Vector3d VariableGravity::gravity() const { return required("gravity").gravity; }

Eigen::Vector3d VariableGravity::baseAcceleration() const {
  return required("baseAcceleration").acceleration;
}

}  // namespace v2
}  // namespace inverse_dynamics_solver

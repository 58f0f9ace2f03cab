// SPDX-License-Identifier: Apache-2.0
#include "method_call.hpp"

#include <functional>
#include <string>

#include "chain_dynamics/text.hpp"
#include "inverse_dynamics_solver/changeable_robot.hpp"
#include "inverse_dynamics_solver/load_friction.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

std::string shape(Eigen::Index rows, Eigen::Index cols) {
  return std::to_string(rows) + " x " + std::to_string(cols);
}

}  // namespace

void MethodCall::throwUninitialized() const { throw UninitializedException(method_); }

void MethodCall::throwMismatch(const char* argument, Eigen::Index size) const {
  throwMismatch(argument, std::to_string(joints()) + " numbers", std::to_string(size));
}

void MethodCall::throwMismatch(const char* argument, Eigen::Index rows, Eigen::Index cols,
                               Eigen::Index got_rows, Eigen::Index got_cols) const {
  throwMismatch(argument, shape(rows, cols), shape(got_rows, got_cols));
}

void MethodCall::throwMismatch(const char* argument, const std::string& expected,
                               const std::string& got) const {
  throw SizeMismatchException(std::string(method_) + ": argument " + argument, "wrong size",
                              expected, got,
                              "the joints are " + chain_dynamics::joined(jointNames()));
}

void MethodCall::whileUnchanged(const std::function<void()>& compute) const {
  const auto* const changing = dynamic_cast<const ChangingConditions*>(&solver_);
  if (changing == nullptr) return compute();
  changing->whileUnchanged(compute);
}

void MethodCall::requirePositions() const {
  if (!frictionDependsOnPosition(solver_)) return;
  throw SizeMismatchException(
      std::string(method_) + ": argument q", "missing",
      std::to_string(joints()) + " numbers, as friction depends on the position", "0",
      "call getFrictionVector(q, qd), in Python friction_vector(qd, q=q); the joints are " +
          chain_dynamics::joined(jointNames()));
}

void MethodCall::throwUnphysical() const {
  throw Exception(method_, "the inertia matrix isn't that of rigid bodies",
                  "a solver whose inertiaIsPhysical() is true", "one where it is false",
                  "use a solver of a robot description");
}

}  // namespace v2
}  // namespace inverse_dynamics_solver

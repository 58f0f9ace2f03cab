// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/capability.hpp"

#include "method_call.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

Capability::~Capability() = default;

Eigen::Index Capability::jointsFor(const char* method) const {
  return MethodCall(method, torqueSolver()).joints();
}

}  // namespace v2
}  // namespace inverse_dynamics_solver

// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/capability.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "chain_dynamics/text.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"
#include "method_call.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

Capability::~Capability() = default;

Eigen::Index Capability::jointsFor(const char* method) const {
  return MethodCall(method, torqueSolver()).joints();
}

std::size_t Capability::tipIndex(const char* method, const std::string& tip) const {
  MethodCall(method, torqueSolver()).joints();
  const std::vector<std::string>& tips = torqueSolver().tipNames();
  const auto found = std::find(tips.begin(), tips.end(), tip);
  if (found != tips.end()) return static_cast<std::size_t>(found - tips.begin());
  throw InvalidParameterValueException(std::string(method) + ": argument tip", "wrong value",
                                       tips.front().empty()
                                           ? "none, as the one tip has no name"
                                           : "one of " + chain_dynamics::joined(tips),
                                       "'" + tip + "'", "the parameter 'tip' names the tips");
}

}  // namespace v2
}  // namespace inverse_dynamics_solver

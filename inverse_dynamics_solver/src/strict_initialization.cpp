// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/strict_initialization.hpp"

#include <set>

#include "inverse_dynamics_solver/exceptions.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

void initializeStrictly(InverseDynamicsSolver& solver, const Parameters& parameters,
                        const std::string& param_namespace, const std::string& robot_description,
                        const std::vector<std::string>& names) {
  const std::string prefix = param_namespace + ".";
  const auto is_of_namespace = [&](const std::string& name) { return name.rfind(prefix, 0) == 0; };
  const auto asked = std::make_shared<std::set<std::string>>();  // the solver may ask later, too
  solver.initialize(parameters.watched([asked](const std::string& name) { asked->insert(name); }),
                    param_namespace, robot_description);

  for (const std::string& name : names) {
    if (!is_of_namespace(name) || asked->count(name) > 0) continue;
    std::string known;
    for (const std::string& other : *asked) {
      if (is_of_namespace(other)) known += (known.empty() ? "" : ", ") + other;
    }
    throw InvalidParameterValueException(errorText("parameter '" + name + "'",
                                                   "the solver doesn't know it", "one of " + known,
                                                   "another name", "correct or remove it"));
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_solver

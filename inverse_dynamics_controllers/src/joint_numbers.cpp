// SPDX-License-Identifier: Apache-2.0
#include "joint_numbers.hpp"

#include <chain_dynamics/text.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>

namespace inverse_dynamics_controllers {

using chain_dynamics::joined;

Eigen::VectorXd jointNumbers(const std::string& name, const std::vector<double>& values,
                             const std::vector<std::string>& joints) {
  const auto n = static_cast<Eigen::Index>(joints.size());
  if (values.size() == 1) return Eigen::VectorXd::Constant(n, values.front());
  if (values.size() == joints.size()) return Eigen::Map<const Eigen::VectorXd>(values.data(), n);
  throw inverse_dynamics_solver::InvalidParameterValueException(inverse_dynamics_solver::errorText(
      "parameter '" + name + "'", "wrong size", std::to_string(n) + " numbers, or one for all",
      std::to_string(values.size()), "give one for each of the joints " + joined(joints)));
}

Eigen::VectorXd jointNumbers(const std::string& name, const std::vector<double>& values,
                             const std::vector<std::string>& joints,
                             const Eigen::VectorXd& otherwise) {
  return values.empty() ? otherwise : jointNumbers(name, values, joints);
}

}  // namespace inverse_dynamics_controllers

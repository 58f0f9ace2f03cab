// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/joint_parameters.hpp"

#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/error.hpp>
#include <chain_dynamics/robot_description.hpp>
#include <chain_dynamics/text.hpp>
#include <cstddef>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

using chain_dynamics::RobotDescription;

RobotDescription described(const std::string& urdf) {
  try {
    return chain_dynamics::robotFromUrdf(urdf);
  } catch (const chain_dynamics::ModelError& error) {
    throw inverse_dynamics_solver::InvalidRobotDescriptionException(
        std::string("robot description: ") + error.what());
  }
}

}  // namespace

OwnedVector jointNumbers(const std::string& name, const std::vector<double>& values,
                         const std::vector<std::string>& joints) {
  const auto n = static_cast<Eigen::Index>(joints.size());
  if (values.size() == 1) return Eigen::VectorXd::Constant(n, values.front());
  if (values.size() == joints.size()) return Eigen::Map<const Eigen::VectorXd>(values.data(), n);
  throw inverse_dynamics_solver::InvalidParameterValueException(
      "parameter '" + name + "'", "wrong size", std::to_string(n) + " numbers, or one for all",
      std::to_string(values.size()),
      "give one for each of the joints " + chain_dynamics::joined(joints));
}

OwnedVector jointNumbers(const std::string& name, const std::vector<double>& values,
                         const std::vector<std::string>& joints, const OwnedVector& otherwise) {
  return values.empty() ? otherwise : jointNumbers(name, values, joints);
}

DescribedLimits describedLimits(const std::string& robot_description,
                                const std::vector<std::string>& joints) {
  const auto n = static_cast<Eigen::Index>(joints.size());
  const ReferenceLimits none = ReferenceLimits::none(n);
  DescribedLimits found{none, none.velocity, none.velocity};
  if (robot_description.empty()) return found;
  const RobotDescription robot = described(robot_description);
  for (Eigen::Index j = 0; j < n; ++j) {
    const std::size_t joint = robot.jointIndex(joints[static_cast<std::size_t>(j)]);
    if (joint == RobotDescription::kNone) {
      found.unknown.push_back(joints[static_cast<std::size_t>(j)]);
      continue;
    }
    const chain_dynamics::JointLimits& limits = robot.joints[joint].limits;
    found.effort[j] = limits.effort;
    found.jerk[j] = limits.jerk;
    found.reference.acceleration[j] = limits.acceleration;
    found.reference.deceleration[j] = limits.deceleration;
    found.reference.velocity[j] = limits.velocity;
    found.reference.lower[j] = limits.lower;
    found.reference.upper[j] = limits.upper;
  }
  return found;
}

}  // namespace v2
}  // namespace inverse_dynamics_control

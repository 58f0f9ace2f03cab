// SPDX-License-Identifier: Apache-2.0
#include "urdf_limits.hpp"

#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>

#if __has_include(<urdf/model.hpp>)  // newer than jazzy
#include <urdf/model.hpp>
#else
#include <urdf/model.h>
#endif

namespace inverse_dynamics_controllers {

using inverse_dynamics_control::ReferenceLimits;

UrdfLimits urdfLimits(const std::string& robot_description,
                      const std::vector<std::string>& joints) {
  const auto n = static_cast<Eigen::Index>(joints.size());
  UrdfLimits limits{ReferenceLimits::none(n),
                    Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity())};
  if (robot_description.empty()) return limits;

  urdf::Model model;
  if (!model.initString(robot_description)) {
    throw inverse_dynamics_solver::InvalidRobotDescriptionException(
        inverse_dynamics_solver::errorText("robot description", "not a URDF", "XML with <robot>",
                                           "something else", "see what urdf says above"));
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto joint = model.getJoint(joints[static_cast<std::size_t>(j)]);
    if (joint == nullptr || joint->limits == nullptr) continue;
    limits.effort[j] = joint->limits->effort;
    limits.reference.velocity[j] = joint->limits->velocity;
    if (joint->type == urdf::Joint::CONTINUOUS) continue;
    limits.reference.lower[j] = joint->limits->lower;
    limits.reference.upper[j] = joint->limits->upper;
  }
  return limits;
}

}  // namespace inverse_dynamics_controllers

// SPDX-License-Identifier: Apache-2.0
#include "reference_layout.hpp"

#include <algorithm>
#include <array>
#include <chain_dynamics/text.hpp>
#include <cmath>
#include <cstddef>
#include <inverse_dynamics_control/signals.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {

using chain_dynamics::joined;

ReferenceLayout::ReferenceLayout(const std::vector<std::string>& interfaces,
                                 const std::vector<std::string>& joints)
    : joints_(joints.size()), stride_(interfaces.size()) {
  const std::array<const char*, 4> known = {"position", "velocity", "acceleration", "effort"};
  for (std::size_t k = 0; k < known.size(); ++k) {
    const auto found = std::find(interfaces.begin(), interfaces.end(), known[k]);
    if (found != interfaces.end()) places_[k] = static_cast<int>(found - interfaces.begin());
  }
  const bool motion = has(kPosition) && has(kVelocity);
  const bool part = has(kPosition) || has(kVelocity) || has(kAcceleration);
  if (motion != part || (!motion && !hasEffort())) {
    throw inverse_dynamics_solver::InvalidParameterValueException(
        "parameter 'reference_interfaces'", "not a motion",
        "position and velocity, acceleration only beside them",
        interfaces.empty() ? "nothing" : joined(interfaces), "add what is missing");
  }
  for (const std::string& joint : joints) {
    for (const std::string& interface : interfaces) names_.push_back(joint + "/" + interface);
  }
}

bool ReferenceLayout::isUntouched(const std::vector<double>& values,
                                  Interface interface) const noexcept {
  for (std::size_t j = 0; has(interface) && j < joints_; ++j) {
    if (!std::isnan(values[place(interface, j)])) return false;
  }
  return true;
}

bool ReferenceLayout::motionIsUntouched(const std::vector<double>& values) const noexcept {
  return isUntouched(values, kPosition) && isUntouched(values, kVelocity) &&
         isUntouched(values, kAcceleration);
}

bool ReferenceLayout::effortIsUntouched(const std::vector<double>& values) const noexcept {
  return isUntouched(values, kEffort);
}

bool ReferenceLayout::readMotion(const std::vector<double>& values,
                                 inverse_dynamics_control::Reference& reference) const noexcept {
  bool changed = false;
  for (std::size_t j = 0; j < joints_; ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    const auto read = [&](double& number, double value) {
      changed = changed || number != value;
      number = value;
    };
    read(reference.q[row], values[place(kPosition, j)]);
    read(reference.qd[row], values[place(kVelocity, j)]);
    read(reference.qdd[row], has(kAcceleration) ? values[place(kAcceleration, j)] : 0.0);
  }
  return changed;
}

void ReferenceLayout::readEffort(const std::vector<double>& values,
                                 Eigen::VectorXd& effort) const noexcept {
  for (std::size_t j = 0; j < joints_; ++j) {
    effort[static_cast<Eigen::Index>(j)] = values[place(kEffort, j)];
  }
}

}  // namespace inverse_dynamics_controllers

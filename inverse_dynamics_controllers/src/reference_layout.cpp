// SPDX-License-Identifier: Apache-2.0
#include "reference_layout.hpp"

#include <algorithm>
#include <chain_dynamics/text.hpp>
#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>

namespace inverse_dynamics_controllers {

using chain_dynamics::joined;

ReferenceLayout::ReferenceLayout(const std::vector<std::string>& interfaces,
                                 const std::vector<std::string>& joints)
    : joints_(joints.size()), stride_(interfaces.size()) {
  const auto offset = [&interfaces](const char* name) {
    const auto found = std::find(interfaces.begin(), interfaces.end(), name);
    return found == interfaces.end() ? -1 : static_cast<int>(found - interfaces.begin());
  };
  position_ = offset("position");
  velocity_ = offset("velocity");
  acceleration_ = offset("acceleration");
  effort_ = offset("effort");
  const bool motion = position_ >= 0 && velocity_ >= 0;
  const bool part = position_ >= 0 || velocity_ >= 0 || acceleration_ >= 0;
  if (motion != part || (!motion && effort_ < 0)) {
    throw inverse_dynamics_solver::InvalidParameterValueException(
        inverse_dynamics_solver::errorText("parameter 'reference_interfaces'", "not a motion",
                                           "position and velocity, acceleration only beside them",
                                           interfaces.empty() ? "nothing" : joined(interfaces),
                                           "add what is missing"));
  }
  for (const std::string& joint : joints) {
    for (const std::string& interface : interfaces) names_.push_back(joint + "/" + interface);
  }
}

double ReferenceLayout::at(const std::vector<double>& values, Eigen::Index j,
                           int offset) const noexcept {
  return values[static_cast<std::size_t>(j) * stride_ + static_cast<std::size_t>(offset)];
}

void ReferenceLayout::set(std::size_t j, int offset, double value,
                          std::vector<double>& values) const noexcept {
  if (offset >= 0) values[j * stride_ + static_cast<std::size_t>(offset)] = value;
}

bool ReferenceLayout::isUntouched(const std::vector<double>& values, int offset) const noexcept {
  if (offset < 0) return true;
  for (std::size_t j = 0; j < joints_; ++j) {
    if (!std::isnan(values[j * stride_ + static_cast<std::size_t>(offset)])) return false;
  }
  return true;
}

bool ReferenceLayout::motionIsUntouched(const std::vector<double>& values) const noexcept {
  return isUntouched(values, position_) && isUntouched(values, velocity_) &&
         isUntouched(values, acceleration_);
}

bool ReferenceLayout::effortIsUntouched(const std::vector<double>& values) const noexcept {
  return isUntouched(values, effort_);
}

void ReferenceLayout::readMotion(const std::vector<double>& values,
                                 inverse_dynamics_control::Reference& reference) const noexcept {
  for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(joints_); ++j) {
    reference.q[j] = at(values, j, position_);
    reference.qd[j] = at(values, j, velocity_);
    reference.qdd[j] = hasAcceleration() ? at(values, j, acceleration_) : 0.0;
  }
}

void ReferenceLayout::readEffort(const std::vector<double>& values,
                                 Eigen::VectorXd& effort) const noexcept {
  for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(joints_); ++j) {
    effort[j] = at(values, j, effort_);
  }
}

void ReferenceLayout::setPosition(std::size_t j, double q,
                                  std::vector<double>& values) const noexcept {
  set(j, position_, q, values);
}

void ReferenceLayout::setVelocity(std::size_t j, double qd,
                                  std::vector<double>& values) const noexcept {
  set(j, velocity_, qd, values);
}

void ReferenceLayout::setAcceleration(std::size_t j, double qdd,
                                      std::vector<double>& values) const noexcept {
  set(j, acceleration_, qdd, values);
}

void ReferenceLayout::setEffort(std::size_t j, double effort,
                                std::vector<double>& values) const noexcept {
  set(j, effort_, effort, values);
}

}  // namespace inverse_dynamics_controllers

// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/contact_detector.hpp"

#include <algorithm>
#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>
#include <string>
#include <vector>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

double ContactDetector::stillHeld(double held, double part) const noexcept {
  const double sign = std::copysign(1.0, held);
  const double left = std::min(std::abs(held), sign * part + release_.share);
  return left > release_.share ? sign * left : 0.0;
}

ContactDetector::ContactDetector(const Eigen::Ref<const Eigen::VectorXd>& thresholds,
                                 const ReleaseOptions& release,
                                 const std::vector<std::string>& joint_names)
    : thresholds_(thresholds), release_(release) {
  for (OwnedVector* vector : {&held_, &greatest_}) vector->setZero(thresholds_.size());
  const std::string name = "contact detector";
  requireJointNumbers(name + ": thresholds", thresholds_, Range::kPositiveOrAbsent, "N m",
                      joint_names);
  requireNumber(name + ": release: share", release.share, Range::kPositive, "");
  if (release.share > 1.0) {
    throw inverse_dynamics_solver::InvalidParameterValueException(
        name + ": release: share", "wrong value", "a share of the thresholds, at most 1",
        std::to_string(release.share), "0.5 is usual");
  }
  requireNumber(name + ": release: time", release.time, Range::kNotNegative, "s");
}

bool ContactDetector::update(const Eigen::Ref<const Eigen::VectorXd>& torques,
                             double period) noexcept {
  const bool fits = torques.size() == thresholds_.size();
  if (!contact_) greatest_.setZero();
  excess_ = fits ? 0.0 : kInfinity;
  double most = 0.0;  // change of a torque that is beyond its threshold
  bool lasts = !fits;
  for (Eigen::Index j = 0; fits && j < torques.size(); ++j) {
    if (!std::isfinite(torques[j])) {  // contact, of a torque that nothing is compared with later
      if (!contact_ && most < kInfinity) joint_ = j;
      excess_ = most = kInfinity;
      lasts = true;
      continue;
    }
    const double part = torques[j] / thresholds_[j];
    if (!contact_) held_[j] = stillHeld(held_[j], part);
    const double change =
        std::abs(part - std::clamp(part, std::min(0.0, held_[j]), std::max(0.0, held_[j])));
    excess_ = std::max(excess_, std::abs(part));
    if (change > 1.0) {
      if (!contact_ && change > most) joint_ = j;
      most = std::max(most, change);
      greatest_[j] = std::max(greatest_[j], change);
    }
    lasts = lasts || (greatest_[j] > 0.0 && change >= release_.share * greatest_[j]);
  }
  if (!fits && !contact_) joint_ = -1;
  if (lasts) {
    contact_ = true;
    below_ = 0.0;
  } else if (contact_) {
    if (period > 0) below_ += period;
    contact_ = below_ < release_.time;
    if (!contact_) held_ = torques.cwiseQuotient(thresholds_);
  }
  return contact_;
}

void ContactDetector::reset() noexcept {
  contact_ = false;
  joint_ = -1;
  excess_ = below_ = 0.0;
  held_.setZero();
}

}  // namespace v2
}  // namespace inverse_dynamics_control

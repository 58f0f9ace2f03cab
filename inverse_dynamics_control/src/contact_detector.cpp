// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/contact_detector.hpp"

#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

ContactDetector::ContactDetector(const Eigen::Ref<const Eigen::VectorXd>& thresholds,
                                 const ReleaseOptions& release,
                                 const std::vector<std::string>& joint_names)
    : thresholds_(thresholds), release_(release) {
  const std::string name = "contact detector";
  requireJointNumbers(name + ": thresholds", thresholds_, Range::kPositiveOrAbsent, "N m",
                      joint_names);
  requireNumber(name + ": release: share", release.share, Range::kPositive, "");
  if (release.share > 1.0) {
    throw inverse_dynamics_solver::InvalidParameterValueException(
        inverse_dynamics_solver::errorText(name + ": release: share", "wrong value",
                                           "a share of the thresholds, at most 1",
                                           std::to_string(release.share), "0.5 is usual"));
  }
  requireNumber(name + ": release: time", release.time, Range::kNotNegative, "s");
}

bool ContactDetector::update(const Eigen::Ref<const Eigen::VectorXd>& torques,
                             double period) noexcept {
  Eigen::Index greatest = -1;
  excess_ = kInfinity;
  if (torques.size() == thresholds_.size()) {
    excess_ = 0.0;
    for (Eigen::Index j = 0; j < torques.size(); ++j) {
      const double part =
          std::isfinite(torques[j]) ? std::abs(torques[j]) / thresholds_[j] : kInfinity;
      if (part > excess_ || greatest < 0) {
        greatest = j;
        excess_ = part;
      }
    }
  }
  if (excess_ > 1.0) {
    if (!contact_) joint_ = greatest;
    contact_ = true;
    below_ = 0.0;
  } else if (excess_ >= release_.share) {
    below_ = 0.0;
  } else if (contact_) {
    if (period > 0) below_ += period;
    contact_ = below_ < release_.time;
  }
  return contact_;
}

void ContactDetector::reset() noexcept {
  contact_ = false;
  joint_ = -1;
  excess_ = below_ = 0.0;
}

}  // namespace v2
}  // namespace inverse_dynamics_control

// SPDX-License-Identifier: Apache-2.0

#include "live_contact.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <memory>

namespace inverse_dynamics_ros {

LiveContact::LiveContact(
    const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver,
    const LiveContactOptions& options)
    : sensing_(solver, options),
      in_root_(options.wrench_frame == inverse_dynamics_solver::WrenchFrame::kRoot ? solver
                                                                                   : nullptr),
      state_(solver->jointCount()) {}

bool LiveContact::update(std::int64_t stamp, const Eigen::VectorXd& q, const Eigen::VectorXd& qd,
                         const Eigen::VectorXd& effort) {
  if (started_ && stamp == stamp_) return false;
  const double period = started_ ? periodOf(stamp - stamp_) : 0.0;
  // Efforts are samples as positions are; the estimator takes their mean since the sample before.
  mean_effort_ = effort;
  if (effort.size() == effort_.size() && effort_.allFinite()) {
    mean_effort_ = 0.5 * (effort_ + effort);
  }
  effort_ = effort;
  started_ = true;
  stamp_ = stamp;
  state_.q = q;
  state_.qd = qd;
  status_ = sensing_.update(state_, mean_effort_, period);
  ++counts_[static_cast<std::size_t>(status_)];
  if (hasWrench()) updateWrench();
  return status_ == Status::kOk;
}

void LiveContact::updateWrench() {
  if (in_root_ == nullptr) {
    force_ = -sensing_.wrenchInTip().force;
    torque_ = -sensing_.wrenchInTip().torque;
    return;
  }
  const auto& kinematics = dynamic_cast<const inverse_dynamics_solver::Kinematics&>(*in_root_);
  force_ = -sensing_.wrench().force;
  torque_ = -sensing_.wrench().torque + kinematics.getTipPose(state_.q).p.cross(force_);
}

// Stamps jitter although samples are equidistant, so the period is the mean of the latest distances,
// without those of lost samples and pauses.
double LiveContact::periodOf(std::int64_t distance) {
  if (distance > 0) {
    distances_[distance_count_++ % distances_.size()] = distance;
    const std::size_t count = std::min(distance_count_, distances_.size());
    auto sorted = distances_;
    std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(count));
    const std::int64_t median = sorted[(count - 1) / 2];
    const auto usual = [median](std::int64_t d) { return 2 * std::abs(d - median) < median; };
    if (usual(distance)) {
      std::int64_t sum = 0, added = 0;
      for (std::size_t k = 0; k < count; ++k) {
        sum += usual(sorted[k]) ? sorted[k] : 0;
        added += usual(sorted[k]) ? 1 : 0;
      }
      return 1e-9 * (static_cast<double>(sum) / static_cast<double>(added));
    }
  }
  return 1e-9 * static_cast<double>(distance);
}

}  // namespace inverse_dynamics_ros

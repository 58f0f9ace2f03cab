// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/contact_sensing.hpp"

#include <chain_dynamics/spatial.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <memory>
#include <utility>

namespace inverse_dynamics_control {
inline namespace v2 {

ContactSensing::ContactSensing(std::shared_ptr<const InverseDynamicsSolver> solver,
                               const ContactOptions& options)
    : solver_(std::move(solver)),
      estimator_(estimatorFor(solver_, options.estimator, options.choice)),
      kinematics_(dynamic_cast<const inverse_dynamics_solver::Kinematics*>(solver_.get())) {
  if (options.thresholds.size() > 0) {
    detector_.emplace(options.thresholds, options.release, solver_->jointNames());
  }
  if (options.wrench.noise.size() > 0) tip_.emplace(solver_, options.wrench);
}

EstimateStatus ContactSensing::update(const JointState& state, const ConstVectorRef& effort,
                                      double period) noexcept {
  in_root_ = {};
  in_tip_ = {};
  EstimateStatus status = estimator_->update(state, effort, period);
  if (status == EstimateStatus::kOk && tip_) {
    status = updateWrench(state.q);
    if (status != EstimateStatus::kOk) estimator_->reset();
  }
  if (detector_ && period < 0) detector_->reset();
  if (detector_ && status == EstimateStatus::kOk) detector_->update(torques(), period);
  return status;
}

EstimateStatus ContactSensing::updateWrench(const OwnedVector& q) noexcept {
  chain_dynamics::Transform<double> pose;
  try {
    kinematics_->getTipPose(q, pose);
  } catch (...) {
    return EstimateStatus::kSolverFailed;
  }
  const WrenchStatus status = tip_->update(q, torques());
  if (status == WrenchStatus::kSolverFailed) return EstimateStatus::kSolverFailed;
  if (status != WrenchStatus::kOk) return EstimateStatus::kModelNotFinite;
  in_root_ = tip_->wrench();
  in_tip_ = {pose.R.transpose() * in_root_.force, pose.R.transpose() * in_root_.torque};
  return EstimateStatus::kOk;
}

void ContactSensing::reset() noexcept {
  estimator_->reset();
  if (detector_) detector_->reset();
  in_root_ = {};
  in_tip_ = {};
}

}  // namespace v2
}  // namespace inverse_dynamics_control

// SPDX-License-Identifier: Apache-2.0
#include "sensed_wrench.hpp"

#include <inverse_dynamics_control/acceleration_residual.hpp>
#include <inverse_dynamics_control/momentum_observer.hpp>

namespace inverse_dynamics_controllers {

using inverse_dynamics_control::AccelerationResidual;
using inverse_dynamics_control::EstimateStatus;
using inverse_dynamics_control::ExternalTorqueEstimator;
using inverse_dynamics_control::JointState;
using inverse_dynamics_control::MomentumObserver;
using inverse_dynamics_control::WrenchStatus;

namespace {

std::unique_ptr<ExternalTorqueEstimator> estimatorFor(
    const std::shared_ptr<const SensedWrench::Solver>& solver, const SensedWrenchOptions& options) {
  using Estimator = SensedWrenchOptions::Estimator;
  const bool momentum = options.estimator == Estimator::kMomentum ||
                        (options.estimator == Estimator::kAutomatic && solver->inertiaIsPhysical());
  if (momentum) return std::make_unique<MomentumObserver>(solver, options.torques);
  return std::make_unique<AccelerationResidual>(solver, options.torques);
}

}  // namespace

SensedWrench::SensedWrench(const std::shared_ptr<const Solver>& solver,
                           const SensedWrenchOptions& options)
    : solver_(solver),
      estimator_(estimatorFor(solver, options)),
      tip_(solver, options.wrench),
      kinematics_(dynamic_cast<const inverse_dynamics_solver::Kinematics*>(solver.get())) {
  if (options.thresholds.size() == 0) return;
  detector_.emplace(options.thresholds, options.release, solver->jointNames());
}

EstimateStatus SensedWrench::update(const JointState& state, const Eigen::VectorXd& effort,
                                    double period) noexcept {
  wrench_.fill(0.0);
  const EstimateStatus estimated = estimator_->update(state, effort, period);
  if (estimated != EstimateStatus::kOk) return estimated;
  const EstimateStatus status = senseTip(state.q);
  if (status != EstimateStatus::kOk) {
    estimator_->reset();
  } else if (detector_) {
    detector_->update(torques(), period);
  }
  return status;
}

EstimateStatus SensedWrench::senseTip(const Eigen::Ref<const Eigen::VectorXd>& q) noexcept {
  chain_dynamics::Transform<double> pose;
  try {
    kinematics_->getTipPose(q, pose);
  } catch (...) {
    return EstimateStatus::kSolverFailed;
  }
  switch (tip_.update(q, torques())) {
    case WrenchStatus::kOk:
      break;
    case WrenchStatus::kSolverFailed:
      return EstimateStatus::kSolverFailed;
    default:
      return EstimateStatus::kModelNotFinite;
  }
  const auto& [force, torque] = tip_.wrench();
  Eigen::Map<Eigen::Vector3d>(wrench_.data()) = -(pose.R.transpose() * force);
  Eigen::Map<Eigen::Vector3d>(wrench_.data() + 3) = -(pose.R.transpose() * torque);
  return EstimateStatus::kOk;
}

void SensedWrench::reset() noexcept {
  estimator_->reset();
  if (detector_) detector_->reset();
  wrench_.fill(0.0);
}

}  // namespace inverse_dynamics_controllers

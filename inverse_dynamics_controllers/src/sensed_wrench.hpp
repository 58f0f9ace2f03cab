// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a force-torque sensor at the tip would measure, from the efforts of the joints.
///
///     SensedWrench sensed(solver, options);
///     if (sensed.update(state, effort, period) == EstimateStatus::kOk) use(sensed.wrench());
#pragma once

#include <array>
#include <inverse_dynamics_control/contact_detector.hpp>
#include <inverse_dynamics_control/external_torque_estimator.hpp>
#include <inverse_dynamics_control/tip_wrench.hpp>
#include <memory>
#include <optional>

namespace inverse_dynamics_controllers {

/// Which external torques are estimated, and how.
struct SensedWrenchOptions {
  enum class Estimator { kAutomatic, kMomentum, kAccelerationResidual };

  Estimator estimator = Estimator::kAutomatic;  ///< momentum where inertiaIsPhysical()
  inverse_dynamics_control::EstimatorOptions torques;
  inverse_dynamics_control::WrenchOptions wrench;
  Eigen::VectorXd thresholds;  ///< n, N m; empty: contacts aren't looked for
  inverse_dynamics_control::ReleaseOptions release;
};

/// External torques, wrench and contacts of an arm. Not thread-safe.
///
/// Real time: all methods but the constructor: no allocation, lock, exception or system call, with a
/// solver that keeps the same promise.
class SensedWrench {
 public:
  using Solver = inverse_dynamics_solver::InverseDynamicsSolver;
  using EstimateStatus = inverse_dynamics_control::EstimateStatus;

  /// Throws inverse_dynamics_solver::Exception: a solver without the capability Kinematics, options
  /// of the wrong size or value, the estimator momentum with a solver whose H isn't physical.
  SensedWrench(const std::shared_ptr<const Solver>& solver, const SensedWrenchOptions& options);

  /// Takes the next sample; as ExternalTorqueEstimator::update().
  ///
  /// @return what isn't kOk leaves torques and wrench at zero.
  EstimateStatus update(const inverse_dynamics_control::JointState& state,
                        const Eigen::VectorXd& effort, double period) noexcept;

  /// External torques as everywhere in this library, what the robot exerts **on its surroundings**:
  /// n; N m (prismatic N).
  const inverse_dynamics_control::OwnedVector& torques() const noexcept {
    return estimator_->torques();
  }

  /// What the surroundings exert **on the tip**, as sensors of ros2_control have it: force [N], then
  /// torque [N m] about the origin of the tip, in the axes of the tip. The opposite of
  /// inverse_dynamics_solver::WrenchInTip.
  const std::array<double, 6>& wrench() const noexcept { return wrench_; }

  /// How many directions of a wrench the joints don't feel; see TipWrench.
  Eigen::Index unseen() const noexcept { return tip_.unseen(); }

  /// Whether something touches the robot; null: it isn't looked for.
  const inverse_dynamics_control::ContactDetector* contact() const noexcept {
    return detector_ ? &*detector_ : nullptr;
  }

  /// Forgets everything: the next sample is the first one.
  void reset() noexcept;

 private:
  EstimateStatus senseTip(const Eigen::Ref<const Eigen::VectorXd>& q) noexcept;

  std::shared_ptr<const Solver> solver_;
  std::unique_ptr<inverse_dynamics_control::ExternalTorqueEstimator> estimator_;
  inverse_dynamics_control::TipWrench tip_;
  const inverse_dynamics_solver::Kinematics* kinematics_;  // of the solver
  std::optional<inverse_dynamics_control::ContactDetector> detector_;
  std::array<double, 6> wrench_{};
};

}  // namespace inverse_dynamics_controllers

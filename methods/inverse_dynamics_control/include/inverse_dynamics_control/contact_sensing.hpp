// SPDX-License-Identifier: Apache-2.0
/// @file
/// External torques, the wrench at the tip and contacts of an arm, from one sample after the other.
///
///     ContactSensing sensing(solver, options);
///     if (sensing.update(state, effort, period) == EstimateStatus::kOk) use(sensing.torques());
///     if (sensing.detector()->contact()) stop.begin(reference.q, reference.qd);
#pragma once

#include <inverse_dynamics_solver/external_wrench.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <memory>
#include <optional>

#include "inverse_dynamics_control/contact_detector.hpp"
#include "inverse_dynamics_control/estimator_choice.hpp"
#include "inverse_dynamics_control/tip_wrench.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

using inverse_dynamics_solver::WrenchInTip;

/// Options of ContactSensing.
struct ContactOptions {
  EstimatorOptions estimator;
  Estimator choice = Estimator::kAutomatic;
  OwnedVector thresholds;  ///< n; N m (prismatic N); empty: contacts aren't detected
  ReleaseOptions release;
  WrenchOptions wrench;  ///< empty noise: no wrench
};

/// An estimator of external torques with a ContactDetector and a TipWrench. Not thread-safe.
///
/// All it gives is exerted by the robot **on its surroundings**. Without an estimate a contact
/// neither begins nor ends. Real time: all methods but the constructor: no allocation, lock,
/// exception or system call, with a solver that keeps the same promise.
class ContactSensing {
 public:
  /// Throws inverse_dynamics_solver::Exception: options that the estimator, the detector or
  /// TipWrench refuses.
  ContactSensing(std::shared_ptr<const InverseDynamicsSolver> solver,
                 const ContactOptions& options);

  /// Takes the next sample, as ExternalTorqueEstimator::update(). A negative period also ends a
  /// contact.
  ///
  /// @return unless it is kOk, torques and wrench are zero.
  EstimateStatus update(const JointState& state, const ConstVectorRef& effort,
                        double period) noexcept;

  /// Forgets everything: the next sample is the first one.
  void reset() noexcept;

  /// n; N m (prismatic N).
  const OwnedVector& torques() const noexcept { return estimator_->torques(); }

  /// At the tip's origin, in the axes of the root frame or of the tip; zero without an estimate.
  const WrenchInRoot& wrench() const noexcept { return in_root_; }
  const WrenchInTip& wrenchInTip() const noexcept { return in_tip_; }

  /// Null: no wrench.
  const TipWrench* tip() const noexcept { return tip_ ? &*tip_ : nullptr; }

  /// Null: contacts aren't detected.
  const ContactDetector* detector() const noexcept { return detector_ ? &*detector_ : nullptr; }

 private:
  EstimateStatus updateWrench(const OwnedVector& q) noexcept;

  std::shared_ptr<const InverseDynamicsSolver> solver_;
  std::unique_ptr<ExternalTorqueEstimator> estimator_;
  std::optional<ContactDetector> detector_;
  std::optional<TipWrench> tip_;
  const inverse_dynamics_solver::Kinematics* kinematics_;  // of the solver
  WrenchInRoot in_root_;
  WrenchInTip in_tip_;
};

}  // namespace v2
}  // namespace inverse_dynamics_control

// SPDX-License-Identifier: Apache-2.0
/// @file
/// External torques of the joints: the base of both estimators.
///
///     EstimatorOptions options;
///     options.gain = Eigen::VectorXd::Constant(7, 60.0);          // 1/s
///     MomentumObserver observer(solver, options);                 // or AccelerationResidual
///     if (observer.update(state, effort, period) == EstimateStatus::kOk) use(observer.torques());
///
/// External torques are those that the actuators spend on the surroundings,
///
///     tau = H(q) qdd + C(q, qd) qd + g(q) + f(qd) + tau_ext,      tau_ext = J(q)^T w,
///
/// with w the wrench that the tip exerts **on its surroundings** [external_wrench.hpp of
/// inverse_dynamics_solver]. A hand that pushes the robot gives the opposite sign.
///
/// A continuous joint may turn on and on, reported within one turn or unbounded: as long as it turns
/// by less than half a turn from sample to sample, the estimates are the same.
///
/// An estimate follows the external torque of its joint with the time constant 1 / gain, in which it
/// rises to 1 - 1/e of a step: exactly with measured velocities, as a first-order filter; within 2 %
/// with velocities from positions, for gains up to 0.3 tracking and periods up to 2 / tracking. An
/// estimate contains everything that the model lacks: errors of friction, unknown loads.
#pragma once

#include <memory>
#include <string>

#include "inverse_dynamics_control/compensated.hpp"
#include "inverse_dynamics_control/model_terms.hpp"
#include "inverse_dynamics_control/motion_tracker.hpp"
#include "inverse_dynamics_control/signals.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Result of an update. Unless it is kOk, the torques are zero.
enum class EstimateStatus {
  kOk,               ///< torques() are the estimate
  kStarting,         ///< no estimate yet: the velocity isn't known well enough
  kGap,              ///< no time, a negative one or too long a time has passed: begins again
  kStateNotFinite,   ///< a position or velocity is NaN or infinite: begins again
  kEffortNotFinite,  ///< an effort is NaN or infinite: begins again
  kModelNotFinite,   ///< the solver gave NaN or infinity: begins again
  kSolverFailed,     ///< the solver threw: begins again
  kWrongSize,        ///< an argument hasn't one number per joint: begins again
};

/// Text of a message, without a full stop. Real time: no allocation, lock, exception or
/// system call. Threads: safe.
const char* text(EstimateStatus status) noexcept;

/// Where velocities come from.
enum class VelocitySource {
  kPositions,  ///< from positions, by a MotionTracker; JointState::qd is ignored
  kMeasured,   ///< JointState::qd, where the robot has good ones, not delayed
};

/// Options of both estimators.
struct EstimatorOptions {
  /// 1 / time constant of each joint, n, from 0.001 to 1e6; 1/s. Required.
  OwnedVector gain;

  VelocitySource velocity = VelocitySource::kPositions;

  /// Of the MotionTracker; from 0.001 to 1e6; rad/s; at least gain / 0.3 for the time constant to be
  /// 1 / gain. Lower: less noise of encoders, and more overshoot.
  double tracking = 200.0;

  /// Terms that the measured efforts lack. A Panda's torque sensors are behind its gears:
  /// `friction = true`.
  Compensated compensated;

  /// Tolerance of the friction model, n, finite, >= 0; N m (prismatic N); empty: none.
  /// A torque within the band counts as zero, one beyond counts by what lies beyond. Where friction
  /// isn't known at all, the band is all of it. For contactThresholds(): empty.
  OwnedVector friction_band;

  /// Samples that are further apart than this are a gap; finite, > 0; s.
  double longest_period = 0.02;
};

/// External torques of each joint. Not thread-safe.
///
/// Keeps its solver, and all its memory from construction on. After anything that can't be used
/// (NaN, a gap in time, a solver that fails) the estimate is zero and begins again: it never jumps.
/// Real time: all methods but constructors: no allocation, lock, exception or system call, with a
/// solver that keeps the same promise.
class ExternalTorqueEstimator {
 public:
  virtual ~ExternalTorqueEstimator();
  ExternalTorqueEstimator(const ExternalTorqueEstimator&) = delete;
  ExternalTorqueEstimator& operator=(const ExternalTorqueEstimator&) = delete;

  /// Number n of joints.
  Eigen::Index jointCount() const noexcept { return torques_.size(); }

  /// Whether updates need JointState::qd.
  VelocitySource velocitySource() const noexcept { return velocity_; }

  /// Takes the next sample.
  ///
  /// @param effort  n; torques that the actuators applied since the last sample: as measured, or
  ///                the command that was held; N m (prismatic N).
  /// @param period  s since the last sample; ignored for the first one.
  EstimateStatus update(const JointState& state, const ConstVectorRef& effort,
                        double period) noexcept;

  /// The estimate, n; N m (prismatic N). Zero unless the last update was kOk.
  const OwnedVector& torques() const noexcept { return torques_; }

  /// Forgets everything: the next sample is the first one.
  void reset() noexcept;

 protected:
  /// @param name  for the text of errors.
  /// Throws inverse_dynamics_solver::Exception: no solver or one that isn't initialized, options of
  /// the wrong size or value.
  ExternalTorqueEstimator(std::shared_ptr<const InverseDynamicsSolver> solver,
                          const EstimatorOptions& options, const std::string& name);

  ModelTerms& model() noexcept { return model_; }

  /// @name What an estimator implements; may throw what its solver throws
  /// @{

  /// The first sample: n each.
  virtual void begin(const OwnedVector& q, const OwnedVector& qd) = 0;

  /// Mean torques, over the time from one sample to the next, that the motion needs by the model.
  ///
  /// @param q0,qd0,q1,qd1  n each: last and present sample.
  /// @param[out] bias      n: `C qd + g + f`.
  /// @param[out] inertial  n: `H` times the mean acceleration.
  virtual void meanTorques(const OwnedVector& q0, const OwnedVector& qd0, const OwnedVector& q1,
                           const OwnedVector& qd1, double period, VectorRef bias,
                           VectorRef inertial) = 0;
  /// @}

 private:
  EstimateStatus check(const JointState& state, const ConstVectorRef& effort) const noexcept;
  EstimateStatus beginAt(const JointState& state, EstimateStatus status);
  EstimateStatus advance(const JointState& state, const ConstVectorRef& effort, double period);
  EstimateStatus refuse(EstimateStatus why) noexcept;
  void track(const JointState& state, double period) noexcept;
  void filter(double period) noexcept;

  ModelTerms model_;
  OwnedVector gain_, band_;
  VelocitySource velocity_;
  double longest_period_, settling_time_ = 0.0;  // s
  int settling_updates_ = 0;
  MotionTracker tracker_;

  bool running_ = false;                // there was a first sample
  double time_ = 0.0;                   // since then [s]
  int updates_ = 0;                     // since then
  double period_ = 0.0;                 // share_ belongs to it
  OwnedVector share_;                   // of the new torque in the filtered one
  OwnedVector q0_, qd0_;                // last sample
  OwnedVector q_, qd_;                  // present sample
  OwnedVector bias_, inertial_, left_;  // torques of the model, and what they leave of the efforts
  OwnedVector filtered_, torques_;
};

}  // namespace v2
}  // namespace inverse_dynamics_control

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Base of all laws: options, the safe torque, limits of the output.
///
///     LawOptions options;
///     options.limits.effort = effort_limits;    // of the data sheet
///     options.damping_rate = 5.0;               // 1/s; for the safe torque
///     ComputedTorque law(solver, gains, options);
///
/// Whatever the input, the output is finite and within the limits. If the law's own torque isn't
/// available, the output is the safe torque
///
///     tau = g(q) - (damping + damping_rate H(q)) qd
///
/// which carries the arm and brakes it, but holds no position. A joint without a finite position is
/// taken where it was last, also by start(); one without a finite velocity isn't damped. Gravity of a
/// solver that fails is that of the last cycle; before any position it is zero. So a reference that is
/// lost for good ends in an arm that stands and can be pushed, and a position that is lost for good
/// needs brakes: see the status.
#pragma once

#include <memory>
#include <string>

#include "inverse_dynamics_control/compensated.hpp"
#include "inverse_dynamics_control/friction_compensation.hpp"
#include "inverse_dynamics_control/model_terms.hpp"
#include "inverse_dynamics_control/output_stage.hpp"
#include "inverse_dynamics_control/signals.hpp"
#include "inverse_dynamics_control/status.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Options of every law.
struct LawOptions {
  /// Terms that the robot adds by itself; the law omits them.
  Compensated compensated;

  /// Limits of the output.
  OutputLimits limits;

  /// Damping of the safe torque and of hand guiding, of each joint alone, n, finite, >= 0; N m s/rad
  /// (prismatic N s/m). Required, unless damping_rate is above zero.
  OwnedVector damping;

  /// The same of all joints together, `damping_rate H(q)`, finite, >= 0; 1/s: every motion decays at
  /// this rate, in every posture, and no joint that brakes shakes another. Above zero for solvers whose
  /// inertiaIsPhysical() is true; unstable from 2 / period on.
  double damping_rate = 0.0;

  /// How the solver's friction is compensated, if it has any.
  FrictionOptions friction;
};

/// Base class of the laws: not a type to hold a law by, but what they have in common.
///
/// A law keeps its solver, and all its memory from construction on. One thread at a time.
/// Real time: all methods but constructors: no allocation, lock, exception or system call, with a
/// solver that keeps the same promise.
class ControlLaw {
 public:
  /// Number n of joints.
  Eigen::Index jointCount() const noexcept { return model_.jointCount(); }

  /// To be called when the loop begins or goes on after a pause: the first output isn't limited in
  /// its rate, or starts from the effort (n, N m) that acts now.
  /// What friction remembers of the motion before is forgotten.
  void start() noexcept {
    model_.forgetFriction();
    output_.start();
  }
  /// @copydoc start()
  void start(const ConstVectorRef& effort) noexcept {
    model_.forgetFriction();
    output_.start(effort);
  }

  /// The same where a law takes over from another one.
  ///
  /// @param position  n; rad (prismatic m): lastPosition() of the other one, for the safe torque until
  ///                  one is measured. Another size, or NaN: as start(effort).
  void start(const ConstVectorRef& effort, const ConstVectorRef& position) noexcept;

  /// The last finite position of each joint, n; rad (prismatic m). NaN: none yet.
  const OwnedVector& lastPosition() const noexcept { return q_; }

  /// The safe torque instead of the law's: `tau = g(q) - D qd`, within the limits.
  ///
  /// @param period    s since the last call of hold() or update(), for the rate limit.
  /// @param[out] tau  n; N m (prismatic N).
  /// @return kOk, kSaturated, kRateLimited, kNoPeriod, kStateNotFinite, kSolverFailed (gravity is
  ///         that of the last cycle, damping that of each joint alone) or kWrongSize.
  Status hold(const JointState& state, double period, VectorRef tau) noexcept;

  /// Other damping from the next call of hold() or update() on; for the thread that calls them. The
  /// output steps by the change times the present velocity, within its rate limit.
  ///
  /// @param damping,rate  as LawOptions::damping, n, and LawOptions::damping_rate.
  /// @return false, and the damping is as it was, where the constructor would throw.
  bool setDamping(const ConstVectorRef& damping, double rate = 0.0) noexcept;

  /// `q_ref - q`, n, until the next call; the short way of continuous joints, whose positions may be
  /// within one turn or unbounded. All laws feed back this error.
  ///
  /// @param q_ref,q  n each; rad (prismatic m).
  const OwnedVector& positionError(const ConstVectorRef& q_ref, const ConstVectorRef& q) noexcept;

  /// Whether the last output of each joint was cut to its effort limit; after refusals too.
  const OutputStage::Joints& saturated() const noexcept { return output_.saturated(); }

  /// Whether the last output of each joint was held back by its rate limit; after refusals too.
  const OutputStage::Joints& rateLimited() const noexcept { return output_.rateLimited(); }

 protected:
  /// @param law  its name, for the text of errors.
  /// Throws inverse_dynamics_solver::Exception: no solver or one that isn't initialized, options of
  /// the wrong size or value.
  ControlLaw(std::shared_ptr<const InverseDynamicsSolver> solver, const LawOptions& options,
             const std::string& law);

  /// kWrongSize, kStateNotFinite or kOk.
  Status check(const JointState& state, const VectorRef& tau) const noexcept;

  /// kWrongSize, kReferenceNotFinite or kOk, of a vector of a reference.
  Status check(const ConstVectorRef& reference) const noexcept;

  /// Adds the blended friction of the motion that the options choose, under the load at q. A reference
  /// without finite positions leaves no memory.
  void addFriction(const ConstVectorRef& q, const JointState& state, const Reference& reference,
                   VectorRef tau);

  /// Adds `d (qd_reference - qd)` where friction of the reference's velocity is compensated: damping that
  /// the robot takes by compensating more of viscous friction than of the rest, and without which the
  /// rest would disturb more.
  void addLostDamping(const ConstVectorRef& qd, const ConstVectorRef& qd_reference,
                      VectorRef tau) const;

  /// Safe torque, and why.
  Status refuse(Status why, const JointState& state, double period, VectorRef tau) noexcept;

  /// Output of what `compute` writes into the vector it is given, or the safe torque if it throws
  /// or the result isn't finite.
  template <class Compute>
  Status output(const JointState& state, double period, VectorRef tau,
                const Compute& compute) noexcept {
    try {
      compute(desired_);
    } catch (...) {
      return refuse(Status::kSolverFailed, state, period, tau);
    }
    if (!desired_.allFinite()) return refuse(Status::kTorqueNotFinite, state, period, tau);
    remember(state.q);  // for cycles to come that don't know it
    return output_.apply(desired_, period, tau);
  }

  /// Subtracts `(damping + damping_rate H(q)) qd`. Throws what a faulty solver throws.
  void damp(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef tau);

  ModelTerms& model() noexcept { return model_; }

 private:
  // Where joints are, as far as it is known, and gravity there; whether the solver gave a finite one.
  bool remember(const ConstVectorRef& q) noexcept;

  ModelTerms model_;
  FrictionCompensation friction_;
  OutputStage output_;
  OwnedVector damping_;
  double damping_rate_;
  OwnedVector desired_, f_, error_;  // scratch
  OwnedVector q_, gravity_;          // last known
};

}  // namespace v2
}  // namespace inverse_dynamics_control

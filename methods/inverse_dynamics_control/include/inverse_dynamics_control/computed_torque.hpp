// SPDX-License-Identifier: Apache-2.0
/// @file
/// Computed torque control, also called inverse dynamics control.
///
///     ComputedTorque law(solver, Gains::uniform(6, 20.0, 1.0), options);   // 20 rad/s, critical
///     const Status status = law.update(state, reference, period, tau);
///
/// With e = q_ref - q (the short way of continuous joints) the law
///
///     tau = H(q) (qdd_ref + Kp e + Kd ed) + C(q, qd) qd + g(q) + f + d (qd_ref - qd)
///
/// with d, the damping that the robot's own compensation of friction takes [Compensated],
/// turns an arm that its model describes into n independent linear systems
///
///     edd + Kd ed + Kp e = 0
///
/// [Siciliano et al., Robotics: Modelling, Planning and Control, sec. 8.5.2]. So gains are chosen
/// for accelerations, once for all postures: natural frequency w and damping ratio z of each joint,
/// `Kp = w^2`, `Kd = 2 z w`.
#pragma once

#include <memory>

#include "inverse_dynamics_control/control_law.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Gains of computed torque, diagonal matrices as vectors.
struct Gains {
  OwnedVector Kp;  ///< n, finite, >= 0; 1/s^2
  OwnedVector Kd;  ///< n, finite, >= 0; 1/s

  /// `Kp = w^2`, `Kd = 2 z w`.
  ///
  /// @param natural_frequency  n; w in rad/s.
  /// @param damping_ratio      n; z: 1 is critical, without overshoot.
  static Gains of(const ConstVectorRef& natural_frequency, const ConstVectorRef& damping_ratio);

  /// The same for all joints.
  static Gains uniform(Eigen::Index joints, double natural_frequency, double damping_ratio);
};

/// `tau = H(q) (qdd_ref + Kp e + Kd ed) + C(q, qd) qd + g(q) + f + d (qd_ref - qd)`; see the head
/// of this file.
///
/// H feeds measured errors back, so it must be symmetric and positive definite: identified models
/// often aren't, and a negative diagonal entry would make that joint's feedback positive. Such a
/// solver is refused; FeedForward takes it.
class ComputedTorque : public ControlLaw {
 public:
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: a solver whose
  /// inertiaIsPhysical() is false; gains or options of the wrong size or value.
  /// UninitializedException: the solver isn't initialized.
  ComputedTorque(std::shared_ptr<const InverseDynamicsSolver> solver, Gains gains,
                 const LawOptions& options);

  /// Other gains from the next update on; for the thread that calls update(). The output steps by
  /// H times the change times the present error, within its rate limit.
  ///
  /// @return false, and the gains are as they were, where the constructor would throw.
  bool setGains(const Gains& gains) noexcept;

  /// Torque for the next period.
  ///
  /// @param period    s since the last call of hold() or update(), for the rate limit.
  /// @param[out] tau  n; N m (prismatic N); finite and within the limits whatever the status is.
  Status update(const JointState& state, const Reference& reference, double period,
                VectorRef tau) noexcept;

 private:
  Gains gains_;
  OwnedVector acceleration_;  // scratch
};

}  // namespace v2
}  // namespace inverse_dynamics_control

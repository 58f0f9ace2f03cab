// SPDX-License-Identifier: Apache-2.0
/// @file
/// PD control of the joints with gravity compensation.
///
///     PdGravityCompensation law(solver, {stiffness, damping}, options);
///     const Status status = law.update(state, reference, period, tau);
///
/// With e = q_ref - q (the short way of continuous joints) the law
///
///     tau = g(q) + Kp e + Kd ed + f
///
/// makes every standing reference a stable equilibrium, whatever the inertia of the arm is
/// [Siciliano et al., Robotics: Modelling, Planning and Control, sec. 8.5.1]. It needs nothing of
/// the model but gravity, and follows a moving reference with an error that grows with its speed.
#pragma once

#include <memory>

#include "inverse_dynamics_control/control_law.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Gains of a PD law, diagonal matrices as vectors.
struct PdGains {
  OwnedVector Kp;  ///< n, finite, >= 0; N m/rad (prismatic N/m)
  OwnedVector Kd;  ///< n, finite, >= 0; N m s/rad (prismatic N s/m)
};

/// `tau = g(q) + Kp e + Kd ed + f`; see the head of this file.
class PdGravityCompensation : public ControlLaw {
 public:
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: gains or options of the wrong
  /// size or value. UninitializedException: the solver isn't initialized.
  PdGravityCompensation(std::shared_ptr<const InverseDynamicsSolver> solver, PdGains gains,
                        const LawOptions& options);

  /// Other gains from the next update on; for the thread that calls update(). The output steps by
  /// the change times the present error, within its rate limit.
  ///
  /// @return false, and the gains are as they were, where the constructor would throw.
  bool setGains(const PdGains& gains) noexcept;

  /// Torque for the next period.
  ///
  /// @param reference  its qdd isn't used.
  /// @param period     s since the last call of hold() or update(), for the rate limit.
  /// @param[out] tau   n; N m (prismatic N); finite and within the limits whatever the status is.
  Status update(const JointState& state, const Reference& reference, double period,
                VectorRef tau) noexcept;

 private:
  PdGains gains_;
};

}  // namespace v2
}  // namespace inverse_dynamics_control

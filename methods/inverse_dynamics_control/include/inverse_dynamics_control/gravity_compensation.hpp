// SPDX-License-Identifier: Apache-2.0
/// @file
/// Gravity compensation: the arm stays where it is put and can be guided by hand.
///
///     options.friction.source = FrictionSource::kMeasuredVelocity;
///     options.friction.dead_band = 0.02;   // rad/s
///     options.friction.scale = 0.7;
///     GravityCompensation law(solver, options);
///     const Status status = law.update(state, period, tau);
///
///     tau = g(q) - D qd + f
#pragma once

#include <memory>

#include "inverse_dynamics_control/control_law.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// `tau = g(q) - D qd + f`, D the damping of LawOptions; needs no physical H without damping_rate.
class GravityCompensation : public ControlLaw {
 public:
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: options of the wrong size or
  /// value. UninitializedException: the solver isn't initialized.
  GravityCompensation(std::shared_ptr<const InverseDynamicsSolver> solver,
                      const LawOptions& options);

  /// Torque for the next period; with FrictionSource::kReferenceVelocity the reference is rest, so
  /// there is no friction.
  ///
  /// @param period    s since the last call of hold() or update(), for the rate limit.
  /// @param[out] tau  n; N m (prismatic N); finite and within the limits whatever the status is.
  Status update(const JointState& state, double period, VectorRef tau) noexcept;

  /// The same with a guiding velocity.
  ///
  /// @param qd_reference  n; rad/s (prismatic m/s); of the friction only.
  Status update(const JointState& state, const ConstVectorRef& qd_reference, double period,
                VectorRef tau) noexcept;

 private:
  OwnedVector rest_;  // zero
  Reference guide_;   // its velocity; no position
};

}  // namespace v2
}  // namespace inverse_dynamics_control

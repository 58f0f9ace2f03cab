// SPDX-License-Identifier: Apache-2.0
/// @file
/// Feed-forward: the model's torque of a desired motion, added to the effort of another controller.
///
///     FeedForward law(solver, ModelState::kReference, options);
///     const Status status = law.update(state, reference, pid_effort, period, tau);
///
///     tau = effort + H qdd_ref + C qd + g + f
#pragma once

#include <memory>

#include "inverse_dynamics_control/control_law.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Where H, C and g are taken.
enum class ModelState {
  /// At the reference: no feedback at all, so the other controller's stability stays what it was,
  /// whatever the model is. The choice for identified models.
  kReference,
  /// At the measured state: right torques where the arm follows badly, but measured positions and
  /// velocities (with their noise) are fed back through g and C qd.
  kMeasured,
};

/// `tau = effort + H qdd_ref + C qd + g + f`; needs no physical H, as no error goes through it.
class FeedForward : public ControlLaw {
 public:
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: options of the wrong size or
  /// value. UninitializedException: the solver isn't initialized.
  FeedForward(std::shared_ptr<const InverseDynamicsSolver> solver, ModelState at,
              const LawOptions& options);

  /// Torque for the next period.
  ///
  /// @param effort    n; N m (prismatic N); of the other controller.
  /// @param period    s since the last call of hold() or update(), for the rate limit.
  /// @param[out] tau  n; N m (prismatic N); finite and within the limits whatever the status is.
  Status update(const JointState& state, const Reference& reference, const ConstVectorRef& effort,
                double period, VectorRef tau) noexcept;

 private:
  ModelState at_;
};

}  // namespace v2
}  // namespace inverse_dynamics_control

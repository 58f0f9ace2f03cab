// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the robot compensates by itself, so that nothing is compensated twice.
///
///     Compensated panda;          // its effort interface adds gravity and friction on its own
///     panda.gravity = true;
///     panda.friction = true;
#pragma once

namespace inverse_dynamics_control {
inline namespace v2 {

/// Terms that every law of this package leaves out, as the robot's own controller adds them.
struct Compensated {
  bool gravity = false;   ///< g(q)
  bool coriolis = false;  ///< C(q, qd) qd
  bool friction = false;  ///< f(qd)
};

}  // namespace v2
}  // namespace inverse_dynamics_control

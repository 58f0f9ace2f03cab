// SPDX-License-Identifier: Apache-2.0
/// @file
/// All laws of this package; docs/control.md says which one is for what.
#pragma once

#include "inverse_dynamics_control/computed_torque.hpp"          // IWYU pragma: export
#include "inverse_dynamics_control/damping.hpp"                  // IWYU pragma: export
#include "inverse_dynamics_control/fault_latch.hpp"              // IWYU pragma: export
#include "inverse_dynamics_control/feed_forward.hpp"             // IWYU pragma: export
#include "inverse_dynamics_control/gravity_compensation.hpp"     // IWYU pragma: export
#include "inverse_dynamics_control/pd_gravity_compensation.hpp"  // IWYU pragma: export
#include "inverse_dynamics_control/reference_guard.hpp"          // IWYU pragma: export
#include "inverse_dynamics_control/safe_stop.hpp"                // IWYU pragma: export

// SPDX-License-Identifier: Apache-2.0
/// @file
/// All laws of this package [docs/control.md], and what finds contacts [docs/contact.md].
#pragma once

#include "inverse_dynamics_control/acceleration_residual.hpp"      // IWYU pragma: export
#include "inverse_dynamics_control/compensated.hpp"                // IWYU pragma: export
#include "inverse_dynamics_control/computed_torque.hpp"            // IWYU pragma: export
#include "inverse_dynamics_control/contact_detector.hpp"           // IWYU pragma: export
#include "inverse_dynamics_control/contact_sensing.hpp"            // IWYU pragma: export
#include "inverse_dynamics_control/contact_thresholds.hpp"         // IWYU pragma: export
#include "inverse_dynamics_control/control_law.hpp"                // IWYU pragma: export
#include "inverse_dynamics_control/estimator_choice.hpp"           // IWYU pragma: export
#include "inverse_dynamics_control/external_torque_estimator.hpp"  // IWYU pragma: export
#include "inverse_dynamics_control/fault_latch.hpp"                // IWYU pragma: export
#include "inverse_dynamics_control/feed_forward.hpp"               // IWYU pragma: export
#include "inverse_dynamics_control/friction_compensation.hpp"      // IWYU pragma: export
#include "inverse_dynamics_control/gravity_compensation.hpp"       // IWYU pragma: export
#include "inverse_dynamics_control/momentum_observer.hpp"          // IWYU pragma: export
#include "inverse_dynamics_control/output_stage.hpp"               // IWYU pragma: export
#include "inverse_dynamics_control/pd_gravity_compensation.hpp"    // IWYU pragma: export
#include "inverse_dynamics_control/reference_guard.hpp"            // IWYU pragma: export
#include "inverse_dynamics_control/safe_stop.hpp"                  // IWYU pragma: export
#include "inverse_dynamics_control/signals.hpp"                    // IWYU pragma: export
#include "inverse_dynamics_control/status.hpp"                     // IWYU pragma: export
#include "inverse_dynamics_control/tip_wrench.hpp"                 // IWYU pragma: export

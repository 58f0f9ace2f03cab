// SPDX-License-Identifier: Apache-2.0

/// @file
/// When an arm moves and when it rests, from positions and velocities.
///
///     Eigen::ArrayXd weight = activity(stretch, 125.0);   // 1: moves, 0: rests

#pragma once

#include <Eigen/Core>

#include "inverse_dynamics_evaluation/cutoff.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Weight of each sample, 0 at rest to 1 in motion; smooth, and 1 for half a second beyond a
/// motion.
///
/// Over blocks of a tenth of a second, motion power is the mean velocity times the mean rate r of
/// the position, and at most r^2, so that slow noise of qd isn't motion where q rests. A joint
/// moves where that power, averaged over half a second, exceeds what noise may add to it: a tenth
/// of the variance of the noise of qd (from second differences), and the square of the rate that a
/// step of q would have if it were sqrt(8) times the largest second difference in the block. So an
/// encoder that flips between two counts rests, even if a driver made qd from it. The arm moves
/// where a joint does. Each weight depends on the samples within one and a half seconds only, so a
/// recording of any length needs no second look.
///
/// @return N; of the samples of the stretch.
Eigen::ArrayXd activity(const Stretch& stretch, double sampling_frequency);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Which external torques are a contact: thresholds from a recording without any.
///
///     ContactThresholds thresholds = contactThresholds(quiet, 1e-3, 1.0, solver->jointNames());
///     ContactDetector detector(thresholds.torques, {}, solver->jointNames());
///
/// A recording of a minute is to tell how high a threshold must be for one false alarm an hour, so
/// something must be assumed beyond what was seen. For each joint:
///
/// 1. Samples that follow one another are alike. The correlation time t is the time after which the
///    autocorrelation has fallen below 1/e; N samples, T apart, count as `N T / (2 t)` independent
///    ones.
/// 2. Peaks over a level, which is such that there are about 100 of them, or a fifth of the number of
///    independent samples where that is less; 20 at least. What lies within 3 t is one peak.
/// 3. The heights of peaks above the level have a generalised Pareto distribution, whatever the
///    noise is [Coles, An Introduction to Statistical Modeling of Extreme Values, 2001, ch. 4]. Scale
///    and shape are those of its probability-weighted moments [Hosking and Wallis, Technometrics 29,
///    1987]; the shape is kept within 0 (exponential, as Gaussian noise) and 0.5 (heavy tails): a
///    tail that ends is never assumed. Peaks that are all equal have no spread: shape 0.
/// 4. The threshold is the height that peaks exceed as often as stated, divided among the joints.
/// 5. How certain it is: peaks are drawn from those found, with replacement, 400 times (bootstrap; the
///    same each time). With a confidence of 90 %, what is exceeded as often as stated lies between
///    `low`, where the tail may end (shape from -0.5), and `high`, where it doesn't.
///
/// The recording must show what will happen without contact: the same motions and loads. A motion
/// that it doesn't show may well be a false alarm.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "inverse_dynamics_control/signals.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Thresholds, and how they came about; n each.
struct ContactThresholds {
  OwnedVector torques;           ///< the thresholds, of absolute values; N m (prismatic N)
  OwnedVector noise;             ///< root mean square of the external torques; N m
  OwnedVector correlation_time;  ///< s
  OwnedVector independent;       ///< number of independent samples
  OwnedVector peaks;             ///< number of peaks above the level
  OwnedVector level;             ///< N m
  OwnedVector scale;             ///< of the generalised Pareto distribution; N m
  OwnedVector shape;             ///< of it
  OwnedVector low, high;         ///< range of the threshold with a confidence of 90 %; N m
  double false_alarms_per_hour = 0.0;
};

/// Thresholds of a stated number of false alarms; see the head of this file.
///
/// @param quiet   n x N; external torques without contact, period apart; N m (prismatic N).
/// @param period  s; finite, > 0.
/// @param false_alarms_per_hour  of all joints together; from 1e-6 (one in a century) to the number of
///                               peaks that a joint shows.
/// Throws inverse_dynamics_solver::InvalidParameterValueException: a number that isn't finite or out
/// of its range, a joint without noise, too few independent samples. Allocates.
ContactThresholds contactThresholds(const Eigen::Ref<const Eigen::MatrixXd>& quiet, double period,
                                    double false_alarms_per_hour,
                                    const std::vector<std::string>& joint_names);

}  // namespace v2
}  // namespace inverse_dynamics_control

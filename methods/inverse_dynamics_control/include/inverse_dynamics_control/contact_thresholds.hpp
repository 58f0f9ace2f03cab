// SPDX-License-Identifier: Apache-2.0
/// @file
/// Which external torques are a contact: thresholds from a recording without any.
///
///     ContactThresholds thresholds = contactThresholds(quiet, 1e-3, 1.0, solver->jointNames());
///     ContactDetector detector(thresholds.torques, {}, solver->jointNames());
///
/// Seconds or minutes of data must predict what happens once in an hour. For each joint:
///
/// 1. Neighbouring samples are alike. The correlation time t is the time after which the
///    autocorrelation has fallen below 1/e; N samples, T apart, count as `N T / (2 t)` independent
///    ones.
/// 2. Peaks over a level [Coles, An Introduction to Statistical Modeling of Extreme Values, 2001,
///    ch. 4]: 20 to 100, a fifth of the independent samples, or as many as there are.
///    Samples within t belong to one peak.
/// 3. Their heights above the level are taken to be exponential, unless they are heavier: Gaussian
///    noise and errors of a model have lighter tails, which is never assumed. With k heights of mean
///    m, the next one follows the predictive distribution, a generalised Pareto distribution of
///    scale m and shape 1/k: few peaks mean a high threshold, and the stated rate is that of the
///    average recording [Geisser, Predictive Inference, 1993, ch. 3]. Heavier: the shape is that of
///    mean and variance of the heights, less its standard error 1/sqrt(k), where that exceeds 1/k.
/// 4. The threshold is the height that peaks exceed as often as stated, divided among the joints.
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
  OwnedVector peaks;             ///< number of peaks above the level
  OwnedVector level;             ///< N m
  OwnedVector scale;             ///< of the generalised Pareto distribution; N m
  OwnedVector shape;             ///< of it
  double false_alarms_per_hour = 0.0;
};

/// Thresholds of a stated number of false alarms; see the head of this file.
///
/// @param quiet   n x N; external torques without contact, period apart; N m (prismatic N).
/// @param period  s; finite, > 0.
/// @param false_alarms_per_hour  of all joints together; from 1e-6 (one in a century) to the number of
///                               peaks that a joint shows.
/// Throws inverse_dynamics_solver::InvalidParameterValueException: a number that isn't finite or out
/// of its range, a joint without noise. Allocates.
ContactThresholds contactThresholds(const Eigen::Ref<const Eigen::MatrixXd>& quiet, double period,
                                    double false_alarms_per_hour,
                                    const std::vector<std::string>& joint_names);

}  // namespace v2
}  // namespace inverse_dynamics_control

// SPDX-License-Identifier: Apache-2.0

/// @file
/// Noise of measured minus computed torques, without a payload.
///
///     ResidualNoise noise = residualNoise(time, measured - computed);   // (N,) s, n x N N m
///
/// Neighbouring residuals are alike: friction that isn't quite that of the model, a filter of the
/// drive. They are described, joint by joint, as the sum of white noise and of noise that forgets
/// within the correlation time T (an Ornstein-Uhlenbeck process): at a lag dt its covariance is
///
///     correlated^2 exp(-dt / T),
///
/// so that any distance of samples, jitter and gaps need no other treatment. Samples that are closer
/// than T / 10 count as one, with their mean: errors of accelerations are alike for some milliseconds
/// and would be taken for noise that remembers.

#pragma once

#include <Eigen/Core>

#include "chain_dynamics/owned.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

/// Noise of the torques of n joints.
struct ResidualNoise {
  /// n, >= 0; standard deviation of means over T / 10, N m (prismatic N)
  chain_dynamics::OwnedVector white;
  chain_dynamics::OwnedVector correlated;  ///< n, >= 0; likewise; one of the two is > 0
  double correlation_time = 0.2;           ///< T, > 0; s

  /// Standard deviation of both together, of joint j.
  double total(Eigen::Index j) const;
};

/// The noise of residuals: their root mean square, shared out between its two parts by maximum
/// likelihood.
///
/// The root mean square is that of means over T / 10: take known offsets off before. A
/// residual that is zero throughout counts as white noise of 1e-6 N m.
///
/// @param time              N, s; ascending (a sample that isn't later than the one before is left
///                          out of the likelihood).
/// @param residuals         n x N, N m (prismatic N); finite.
/// @param correlation_time  > 0; s.
/// @throws inverse_dynamics_solver::InvalidParameterValueException  sizes that don't fit together,
///     fewer than two samples, numbers out of range.
ResidualNoise residualNoise(const Eigen::Ref<const Eigen::VectorXd>& time,
                            const Eigen::Ref<const Eigen::MatrixXd>& residuals,
                            double correlation_time = ResidualNoise().correlation_time);

}  // namespace v2
}  // namespace inverse_dynamics_identification

// SPDX-License-Identifier: Apache-2.0

/// @file
/// A cut-off for the low-pass before differentiation, chosen from positions and velocities alone.
///
///     CutoffChoice choice = chooseCutoff({{q, qd}}, 1000.0);
///     std::cout << choice.cutoff << " Hz\n";
///
/// What is sought. A measured velocity is motion plus noise, with spectra S(f) and N(f). A low-pass
/// of gain h(f) before differentiation makes, on average, the squared acceleration error
///
///     E(f_c) = sum over f of (2 pi f)^2 [ (1 - h)^2 S + h^2 N ],
///
/// motion lost plus noise let through. The best cut-off is where E is least (Wiener's criterion).
/// Noise is weighed by f^2, so a cut-off ten times too high costs thirty times the error.
///
/// How S and N are told apart. Two looks are taken at the data, and the lower cut-off wins:
///
/// 1. **Agreement.** The derivative of q is a second measurement of the same velocity. What both
///    have in common, the real part of their cross-spectrum, is motion: S. What the spectrum of qd
///    has beyond that is its noise: N. Nothing is assumed of the colour of the noise. Then E above
///    gives the cut-off. This look is blind where a driver made qd from q: they share their noise.
/// 2. **Residual.** [Winter, Biomechanics and Motor Control of Human Movement, 4th ed. 2009, ch. 3]
///    The root mean square r(f_c) of what the filter takes away falls along a straight line while
///    it is noise alone. That line, fitted between 0.3 and 0.4 f_s and extended to f_c = 0, is the
///    level of the noise; the cut-off is where r reaches it. This look is misled by noise that
///    isn't white, upwards.
///
/// One cut-off serves all joints: each joint's spectra are divided by its own level of qd above
/// f_s / 4 and added. docs/accuracy.md has the comparison with other methods.

#pragma once

#include <Eigen/Core>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// What was chosen, and what each look said; Hz.
struct CutoffChoice {
  double cutoff = 0;     ///< the lower of the two
  double agreement = 0;  ///< where E is least, noise being what q doesn't confirm
  double residual = 0;   ///< by residual analysis of qd
  double lowest = 0;     ///< least that could be chosen: two periods in the recording, or 0.25 Hz
  double highest = 0;    ///< greatest that could be chosen: 0.4 of the sampling frequency
};

/// A stretch of equidistant samples.
struct Stretch {
  Eigen::MatrixXd q;   ///< n x N; rad (prismatic m)
  Eigen::MatrixXd qd;  ///< n x N; rad/s (prismatic m/s)
};

/// Cut-off for the zero-phase low-pass of qd before differentiation. O(N log N), at most 20 s of
/// samples at a time.
///
/// @param stretches           one or more, of the same n; joints that never move don't matter.
/// @param sampling_frequency  Hz.
/// @param order               of the Butterworth filter, as of lowPass().
/// @throws EvaluationError: no stretch of 16 samples or more; sizes differ.
CutoffChoice chooseCutoff(const std::vector<Stretch>& stretches, double sampling_frequency,
                          int order = 2);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

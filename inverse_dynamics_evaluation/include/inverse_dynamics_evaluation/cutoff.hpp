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
///    has beyond that is its noise: N. Nothing is assumed of the colour of that noise. Where a
///    driver made qd from q, they share the noise of q: they are coherent at frequencies where the
///    derivative of q is mostly noise. That noise, often the counts of an encoder, is white in q.
///    Its level is seen at high frequencies, and its share of the derivative's power at f, which is
///    proportional to f^2, is taken to be N's share of the power of qd, up to the frequency from
///    which it is most of it. Then E above gives the cut-off.
/// 2. **Plateau.** With rising frequency motion fades fast and noise slowly. For each f_c above
///    most of the motion, N is taken to be as strong below f_c as right above it, from 1.25 to
///    2.5 f_c, where the spectrum of qd must not fall faster than behind a filter of first order; S
///    is the rest. The cut-off is the lowest one at which E has more of noise than of motion. This
///    look needs no q; noise that rises with frequency misleads it, downwards.
///
/// Rests are left out. In 20 minutes with one motion of half a second, noise of all 20 minutes
/// would outweigh what the filter takes from the motion. So each look sees the samples in motion
/// and half a second around them: those where q changes steadily, by more than steps of an encoder,
/// and qd agrees.
///
/// One cut-off serves all joints: each joint's spectra are divided by its own level of qd above
/// f_s / 4 and added. All of this is sums over segments of at most 20 s, gathered in one pass.
/// docs/accuracy.md has the comparison with other methods.

#pragma once

#include <Eigen/Core>
#include <vector>

#include "inverse_dynamics_evaluation/metrics.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// What was chosen, and what each look said; Hz.
struct CutoffChoice {
  double cutoff = 0;     ///< the lower of the two
  double agreement = 0;  ///< where E is least, noise being what q doesn't confirm or shares
  double plateau = 0;    ///< where noise as strong as right above it outweighs the motion
  double lowest = 0;     ///< least that could be chosen: two periods in the recording, or 0.25 Hz
  double highest = 0;    ///< greatest that could be chosen: 0.4 of the sampling frequency
  double moving = 0;  ///< share of the samples in motion, 0 to 1; the cut-off is chosen from them
};

/// A stretch of equidistant samples.
struct Stretch {
  OwnedMatrix q;   ///< n x N; rad (prismatic m)
  OwnedMatrix qd;  ///< n x N; rad/s (prismatic m/s)
};

/// Cut-off for the zero-phase low-pass of qd before differentiation. O(N).
///
/// @param stretches           one or more, of the same n; joints that never move don't matter.
/// @param sampling_frequency  Hz.
/// @param order               of the Butterworth filter, as of lowPass().
/// @throws EvaluationError: no stretch of 16 samples or more; sizes differ.
CutoffChoice chooseCutoff(const std::vector<Stretch>& stretches, double sampling_frequency,
                          int order = 2);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

// SPDX-License-Identifier: Apache-2.0

/// @file
/// A cut-off for the low-pass before differentiation, chosen from the data.
///
///     const AccelerationReport found = findAccelerations(table, AccelerationMethod::kLowPass);
///     std::cout << found.filter.choice.cutoff << " Hz\n";
///
/// Criterion. A measured velocity is motion plus noise, with spectra S(f) and N(f). A low-pass
/// of gain h(f) before differentiation makes, on average, the squared acceleration error
///
///     E(f_c) = sum over f of (2 pi f)^2 [ (1 - h)^2 S + h^2 N ],
///
/// motion lost plus noise let through. The best cut-off minimizes E (Wiener's criterion). Noise is
/// weighted by f^2, so a cut-off ten times too high costs thirty times the error.
///
/// Method. Cross-validation of one measurement by another: the derivative of q is a
/// second measurement of the same velocity. Three spectra are measured: T of qd, R of the derivative
/// of q, and the real part C of their cross-spectrum. With s for the true velocity,
///
///     E(f_c) = sum (2 pi f)^2 [ h^2 T - 2 h C_s ] + constant,
///
/// where C_s is the cross-spectrum of qd and s. C estimates C_s without bias, whatever the colour of
/// the noise of qd, as long as q has other noise. T, C and so E cover the whole recording: a stop, an
/// impact or a slipping joint has the weight that it has in the error.
///
/// Drivers often make qd from q; then both share the noise of q. That noise, often the counts of an
/// encoder, is white in q: its power in R is its level times f^2, and the level is what R has in the
/// upper half of the frequencies. Up to the last frequency f_q at which noise is less than a fifth
/// of R, q tells motion from noise. If qd is coherent with q in the octave above f_q, it has the noise of
/// q: its share in R is subtracted from C, and nothing above f_q is motion. Otherwise C is motion up
/// to an octave above f_q; beyond, it is mostly the product of two noises.
///
/// Where q jumps and qd doesn't (a seam of 2 pi, a driver that restarts), the jump is left out.
///
/// Rests are left out. In 20 minutes with one motion of half a second, noise of all 20 minutes
/// would outweigh what the filter takes from the motion. So the spectra are those of the samples in
/// motion and half a second around them: where q changes steadily, by more than steps of an encoder,
/// and qd agrees.
///
/// One cut-off serves all joints: E is added over them. All of this is sums over segments of at most
/// 60 s, gathered in one pass. docs/accuracy.md compares it with the best cut-off.
///
/// Efforts. An elastic arm vibrates, at 20 to 80 Hz and above; q and qd share that vibration, so it is
/// motion to them. The torques of rigid links don't have it, nor do the efforts. Where efforts were
/// recorded, another cut-off is taken if it lets the solver's torques explain them better. Each joint's
/// efforts are fitted by
///
///     a g(q) + b (C(q, qd) qd + friction) + c_k H_jk(q) qdd_k + d qd + e sign(qd) + f   (sum over k),
///
/// so that neither wrong masses, nor friction, nor an offset decides. Eight parts of the recording are
/// left out in turn; the least mean error of what was left out wins, if it is less by more than one per
/// cent and twice its standard error, and if E's cut-off leaves more than one per cent of the efforts
/// unexplained. No cut-off below twice the frequency of the motion is tried.
///
/// [Wiener 1949, Extrapolation, interpolation, and smoothing of stationary time series; Stone 1974,
/// doi 10.1111/j.2517-6161.1974.tb00994.x; Bendat and Piersol, Random data, on cross-spectra]

#pragma once

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// The chosen cut-off and its bounds; Hz.
struct CutoffChoice {
  double cutoff = 0;   ///< minimizes E, or is the efforts' choice
  double lowest = 0;   ///< lower bound: two periods in the recording, or 0.25 Hz
  double highest = 0;  ///< upper bound: 0.4 of the sampling frequency
  double moving = 0;   ///< share of the samples in motion, 0 to 1; the cut-off is chosen from them
  double motion = 0;   ///< 99 % of the power of the velocities lies below
  double by_motion = 0;  ///< minimizes E
  double gain =
      0;  ///< share of the torques' error that the efforts' choice saves; 0: there is none
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

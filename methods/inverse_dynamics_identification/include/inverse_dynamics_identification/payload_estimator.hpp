// SPDX-License-Identifier: Apache-2.0

/// @file
/// The body at the tip: mass, center of mass and inertia from a few seconds of motion.
///
///     PayloadEstimator estimator(solver, options);                  // options.noise is required
///     while (moving) estimator.update(time, q, qd, qdd, effort);    // each cycle
///     PayloadEstimate found(n);
///     if (estimator.estimate(found) == PayloadStatus::kOk) carrier->setPayload("load", found.body());
///
/// Measured minus computed torques of the arm are linear in the ten parameters of a body
/// in the tip frame [tip_regressor.hpp],
///
///     measured - computed = Y(q, qd, qdd) [m, mc, I] + offset + noise,
///
/// with an offset per joint and the noise of residual_noise.hpp, which a Kalman filter makes white.
/// Computed torques contain what friction remembers of the samples so far [friction_memory.hpp].
/// What the arm's model may be wrong by, as far as its identification could tell, may be estimated
/// with the body: K independent deviations z of one standard deviation each [arm_uncertainty.hpp] add
/// `D(q, qd, qdd)' z`. They are taken out of the normal equations as offsets are.
///
/// Of the filtered rows only sums are kept, of each joint and of blocks of time, so a recording of
/// any length takes constant memory. The estimate minimises
///
///     1/2 |filtered residual|^2 + 1/2 sum_j offset_j^2 / deviation_j^2 + tr(P0^-1 P) - log det P,
///
/// P the 4 x 4 pseudo-inertia of the body, which stays positive definite: mass, second moments and
/// triangle inequality are those of a real body [Wensing, Kim, Slotine 2018,
/// doi 10.1109/LRA.2017.2729659; Lee, Park 2018, doi 10.1109/LRA.2018.2799426]. P0 has mass and
/// center of mass of the estimate itself and the standard deviation `extent` of mass about it, so it
/// decides the inertia where the data don't tell, and nothing else.
///
/// Intervals rest on how much the estimate changes as each block of each joint is left out (the
/// cluster-robust CR3, or jackknife [Bell, McCaffrey 2002]): residuals are correlated, so the
/// textbook's intervals would be far too narrow. What the arm's model is wrong by throughout shows in
/// no block. It is taken for `model_error` times the variance that the noise gives,
///
///     V = V_jackknife + model_error V_noise,
///
/// since a model that was fitted to a motion like this one, about as long, is as wrong as that in the
/// directions that a load acts in. Where `arm` is given, V_noise is that of noise and deviations
/// together. Student's t has (blocks - 1) (V / V_jackknife)^2 degrees of freedom
/// [Welch 1947; Satterthwaite 1946]. Intervals are never narrower than those of V_noise, which have no
/// limit in an unobservable direction.
///
/// **Friction that grows with load** isn't linear in the body. Set the estimate as a payload of the
/// solver, name it in `options.carried`, and estimate again from the same samples: two or three times.

#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <memory>

#include "chain_dynamics/owned.hpp"
#include "inverse_dynamics_identification/arm_uncertainty.hpp"
#include "inverse_dynamics_identification/residual_noise.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

/// Assumptions of the estimate.
struct PayloadOptions {
  ResidualNoise noise;  ///< of the torques; required

  /// Offsets of measured torques that are expected, n, N m; empty: zero.
  chain_dynamics::OwnedVector offset;
  /// Their standard deviation, n, > 0, N m; empty: one share of the noise for all joints, estimated
  /// with the rest.
  chain_dynamics::OwnedVector offset_deviation;

  /// Uncertainty of the arm's model; empty: no deviations are estimated with the body.
  ArmUncertainty arm;

  /// The part of the solver's payloads that belongs to the estimate: its torques are among those
  /// that the solver computes.
  inverse_dynamics_solver::RigidBody carried;

  double extent = 0.04;  ///< standard deviation of mass about its center that is expected, > 0; m
  double block = 0.8;    ///< of time, several correlation times long, > 0; s
  /// Variance of what the arm's model is wrong by, in units of what the noise gives, >= 0; 0: exact.
  double model_error = 1.0;
};

/// Result of a call.
enum class PayloadStatus {
  kOk,            ///< the sample was added; the estimate is one
  kNotLater,      ///< the sample isn't later than the last one: left out
  kNotFinite,     ///< a NaN or infinity: the sample is left out; no estimate
  kTooShort,      ///< fewer than three blocks of time: no estimate yet
  kSolverFailed,  ///< the solver threw: the sample is left out
  kWrongSize,     ///< of an argument by joints, or of an estimate by deviations of the arm
};

/// What happened, as a sentence without a full stop. Real time: no allocation, lock, exception or
/// system call. Threads: safe.
const char* text(PayloadStatus status) noexcept;

/// A body in the tip frame with the half widths of its 95 % intervals.
struct PayloadEstimate {
  /// For so many joints and columns of the arm's uncertainty.
  explicit PayloadEstimate(Eigen::Index joints = 0, Eigen::Index arm_deviations = 0);

  double mass = 0.0;                                                    ///< > 0; kg
  double mass_half_width = 0.0;                                         ///< kg
  Eigen::Vector3d center_of_mass = Eigen::Vector3d::Zero();             ///< m
  Eigen::Vector3d center_of_mass_half_width = Eigen::Vector3d::Zero();  ///< m
  /// About the center of mass, axes of the tip frame; kg m^2.
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d inertia_half_width = Eigen::Matrix3d::Zero();  ///< kg m^2, of the data alone
  /// Whether the data tell the inertia: half widths of the three moments below half of their mean.
  bool inertia_is_known = false;

  chain_dynamics::OwnedVector offset;      ///< n; N m (prismatic N)
  chain_dynamics::OwnedVector arm;         ///< K, z: of the arm, in standard deviations
  chain_dynamics::OwnedMatrix covariance;  ///< V, 10 x 10, of [m, mc, I] about the tip's origin
  Eigen::Index blocks = 0;                 ///< of time that the intervals rest on
  double duration = 0.0;                   ///< from the first sample to the last; s

  /// For setPayload(): a point mass where the data don't tell the inertia.
  inverse_dynamics_solver::RigidBody body() const;
};

/// Recursive estimate of the body at the tip. Not thread-safe; movable.
class PayloadEstimator {
 public:
  /// @throws inverse_dynamics_solver::InvalidParameterValueException  a solver as TipRegressor
  ///     refuses it, options of the wrong size or value; UninitializedException.
  PayloadEstimator(std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solver,
                   const PayloadOptions& options);
  ~PayloadEstimator();
  PayloadEstimator(PayloadEstimator&&) noexcept;
  PayloadEstimator& operator=(PayloadEstimator&&) noexcept;

  Eigen::Index jointCount() const noexcept;

  /// Adds a sample.
  ///
  /// @param time               s; of any origin.
  /// @param q,qd,qdd,measured  n each; rad, rad/s, rad/s^2, N m (prismatic m, m/s, m/s^2, N).
  /// Real time: no allocation, lock, exception or system call, with a solver that keeps the same
  /// promise.
  PayloadStatus update(double time, const inverse_dynamics_solver::ConstVectorRef& q,
                       const inverse_dynamics_solver::ConstVectorRef& qd,
                       const inverse_dynamics_solver::ConstVectorRef& qdd,
                       const inverse_dynamics_solver::ConstVectorRef& measured) noexcept;

  /// The body that all samples so far tell of, in 0.1 to 1 ms; with 60 deviations of the arm, about 10 ms.
  ///
  /// @param[out] found  made for as many joints and deviations; unchanged unless the result is kOk.
  /// Real time: no allocation, lock, exception or system call, up to 128 joints and deviations of the arm together.
  PayloadStatus estimate(PayloadEstimate& found) noexcept;

  /// Forgets all samples, and what friction remembers. Real time: no allocation, lock, exception or system call.
  void restart() noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace v2
}  // namespace inverse_dynamics_identification

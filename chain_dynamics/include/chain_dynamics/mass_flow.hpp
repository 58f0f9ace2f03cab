// SPDX-License-Identifier: Apache-2.0

/// @file
/// How the mass of a body flows past a frame: what the derivatives of torques need.
///
///     MassFlow<double> flow = flowOf(I_B, V_B);   // of one link
///     Force<double> F_B = flow.coriolis(w_B);     // what a turn of its whole motion costs
///     flow = X_AB * flow;                         // the same mass, stated in frame A
///
/// A point of mass m at r that moves with velocity u needs the force 2 m w x u more when its
/// surroundings turn with w: Coriolis' force. Of a body, or of many bodies that move each in its
/// own way, that is
///
///     force  = sum of 2 m w x u          = 2 w x (sum of m u)
///     moment = sum of r x (2 m w x u)    = 2 (trace(Q) w - Q w),   Q = sum of m u r'
///
/// so twelve numbers say it all, and those of several bodies add up. (As a 6 x 6 matrix on (w, 0)
/// this is 2 B of the literature [Singh, Russell, Wensing 2022, arXiv 2105.05102].)
/// Real time: no allocation, lock, exception or system call. Threads: safe.

#pragma once

#include "chain_dynamics/spatial.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// `sum of m u` and `sum of m u r'` over points of mass m at r with velocity u.
template <typename Scalar>
struct MassFlow {
  Vector3<Scalar> momentum;  ///< sum of m u; kg m/s
  Matrix3<Scalar> moment;    ///< sum of m u r'; kg m^2/s

  static MassFlow zero() { return {Vector3<Scalar>::Zero(), Matrix3<Scalar>::Zero()}; }

  MassFlow& operator+=(const MassFlow& other) {
    momentum += other.momentum;
    moment += other.moment;
    return *this;
  }

  /// Force that the flow needs when it is carried along by a frame that turns with w.
  Force<Scalar> coriolis(const Vector3<Scalar>& w) const {
    const Scalar two(2);
    return {two * (moment.trace() * w - moment * w), two * w.cross(momentum)};
  }

  /// `C` of `dot(S, coriolis(w)) = C . w`, for every w.
  Vector3<Scalar> coriolisAlong(const Motion<Scalar>& S) const {
    return Scalar(2) *
           (moment.trace() * S.angular - moment.transpose() * S.angular + momentum.cross(S.linear));
  }

  /// The same flow, stated in frame A: velocities keep their reference, r starts elsewhere.
  friend MassFlow operator*(const Transform<Scalar>& X_AB, const MassFlow& B) {
    const Vector3<Scalar> momentum_A = X_AB.R * B.momentum;
    return {momentum_A, X_AB.R * B.moment * X_AB.R.transpose() + momentum_A * X_AB.p.transpose()};
  }
};

/// The flow of a body's mass when it moves with V: `u = v + w x r`.
template <typename Scalar>
MassFlow<Scalar> flowOf(const SpatialInertia<Scalar>& I, const Motion<Scalar>& V) {
  const Vector3<Scalar>& mc = I.first_moment;

  // second moment of mass: the integral of r r' dm
  Matrix3<Scalar> second_moment = -I.inertia;
  second_moment.diagonal().array() += Scalar(0.5) * I.inertia.trace();
  return {I.mass * V.linear + V.angular.cross(mc),
          V.linear * mc.transpose() + skew<Scalar>(V.angular) * second_moment};
}

}  // namespace v2
}  // namespace chain_dynamics

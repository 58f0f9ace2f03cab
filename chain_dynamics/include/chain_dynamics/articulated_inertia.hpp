// SPDX-License-Identifier: Apache-2.0

/// @file
/// Inertia of a body that drags others along on loose joints: what forward dynamics needs.
///
///     ArticulatedInertia<double> I_A = X_AB * I_B.released(U, inverse_D);  // beyond the joint
///     I_A += link;                                                         // and this side of it
///
/// A rigid body resists a push equally in all directions. A body with a hinged flap doesn't: the
/// flap gives way along its hinge. The inertia `F = I_A A` of such an articulated body is still a
/// symmetric 6 x 6 matrix, but no longer described by ten numbers [Featherstone 2008, sec. 7.1].
/// Real time: no allocation, lock, exception or system call. Threads: safe.

#pragma once

#include "chain_dynamics/spatial.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Symmetric 6 x 6 inertia `[J, H; H', M]`: moment = J w + H v, force = H' w + M v.
template <typename Scalar>
struct ArticulatedInertia {
  Matrix3<Scalar> J;  ///< moment by angular acceleration, symmetric; kg m^2
  Matrix3<Scalar> H;  ///< moment by linear acceleration; kg m
  Matrix3<Scalar> M;  ///< force by linear acceleration, symmetric; kg

  static ArticulatedInertia zero() {
    return {Matrix3<Scalar>::Zero(), Matrix3<Scalar>::Zero(), Matrix3<Scalar>::Zero()};
  }

  /// Adds a rigid body: `[I, [mc]x; [mc]x', m 1]` [Featherstone 2008, sec. 2.13].
  ArticulatedInertia& operator+=(const SpatialInertia<Scalar>& rigid) {
    J += rigid.inertia;
    H += skew<Scalar>(rigid.first_moment);
    M.diagonal().array() += rigid.mass;
    return *this;
  }

  friend Force<Scalar> operator*(const ArticulatedInertia& I, const Motion<Scalar>& A) {
    return {I.J * A.angular + I.H * A.linear, I.H.transpose() * A.angular + I.M * A.linear};
  }

  /// `I S`: the column of the joint's axis.
  Force<Scalar> timesAxis(bool prismatic) const {
    if (prismatic) {
      return {H.col(2), M.col(2)};
    }
    return {J.col(2), H.row(2).transpose()};
  }

  /// `I - U D^-1 U'`: what is left when the body gives way along its joint, U = I S, D = S' U.
  ArticulatedInertia released(const Force<Scalar>& U, const Scalar& inverse_D) const {
    const Vector3<Scalar> n = U.moment * inverse_D;
    const Vector3<Scalar> f = U.force * inverse_D;
    return {J - U.moment * n.transpose(), H - U.moment * f.transpose(),
            M - U.force * f.transpose()};
  }

  /// `I_A = X_AB I_B`: the same body, stated in frame A [Featherstone 2008, sec. 7.1].
  friend ArticulatedInertia operator*(const Transform<Scalar>& X_AB,
                                      const ArticulatedInertia& I_B) {
    // turn the axes
    const Matrix3<Scalar>& R = X_AB.R;
    const Matrix3<Scalar> turned_J = R * I_B.J * R.transpose();
    const Matrix3<Scalar> turned_H = R * I_B.H * R.transpose();
    const Matrix3<Scalar> M_A = R * I_B.M * R.transpose();

    // move the origin, with v_B = v_A - p x w and n_A = n_B + p x f
    const Matrix3<Scalar> p_x = skew<Scalar>(X_AB.p);
    const Matrix3<Scalar> H_A = turned_H + p_x * M_A;
    const Matrix3<Scalar> J_A = turned_J - turned_H * p_x + p_x * H_A.transpose();
    return {J_A, H_A, M_A};
  }
};

}  // namespace v2
}  // namespace chain_dynamics

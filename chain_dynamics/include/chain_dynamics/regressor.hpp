// SPDX-License-Identifier: Apache-2.0

/// @file
/// The torques as a linear function of the inertial parameters: what identification fits.
///
///     Eigen::MatrixXd Y(n, 10 * n);
///     regressor(chain, q, qd, qdd, Y);
///     tau = Y * parameters(chain) + rotor_inertia.cwiseProduct(qdd);
///
/// The force that gives a body its motion, with the classical acceleration of the frame's origin
/// a_c = a + w x v and the angular acceleration dw, is linear in its ten parameters:
///
///     force  = m a_c + dw x mc + w x (w x mc)
///     moment = mc x a_c + I dw + w x (I w)
///
/// so it is a 6 x 10 matrix, made of the motion alone, times [m, mc, I]. Carried from joint to
/// joint like any force, its columns are the torques of one unit of each parameter.

#pragma once

#include <Eigen/Core>

#include "chain_dynamics/kinematics.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// The ten parameters of every link, one below the other: `p` of `tau = Y p`.
///
/// @return 10 n: [m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz] of link 1, of link 2, ...
inline Eigen::VectorXd parameters(const Chain& chain) {
  Eigen::VectorXd p(10 * chain.jointCount());
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    p.segment<10>(10 * i) = internal::link<double>(chain.links(), i).toVector();
  }
  return p;
}

namespace internal {

// Ten forces side by side, one per unit of each parameter.
template <typename Scalar>
struct ForceColumns {
  Eigen::Matrix<Scalar, 3, 10> moment;
  Eigen::Matrix<Scalar, 3, 10> force;
};

// The matrix L of I w = L(w) [Ixx, Ixy, Ixz, Iyy, Iyz, Izz].
template <typename Scalar>
Eigen::Matrix<Scalar, 3, 6> inertiaTimes(const Vector3<Scalar>& w) {
  const Scalar o(0);
  Eigen::Matrix<Scalar, 3, 6> L;
  L << w.x(), w.y(), w.z(), o, o, o,  //
      o, w.x(), o, w.y(), w.z(), o,   //
      o, o, w.x(), o, w.y(), w.z();
  return L;
}

// Force on a body moving with V and A, as a function of its parameters.
template <typename Scalar>
ForceColumns<Scalar> bodyRegressor(const Motion<Scalar>& V, const Motion<Scalar>& A) {
  const Matrix3<Scalar> w_x = skew<Scalar>(V.angular);
  const Vector3<Scalar> a_c = A.linear + V.angular.cross(V.linear);
  ForceColumns<Scalar> columns;

  // m: (0, a_c)
  columns.moment.col(0).setZero();
  columns.force.col(0) = a_c;

  // mc: (-a_c x, dw x + w x w x)
  columns.moment.template middleCols<3>(1) = -skew<Scalar>(a_c);
  columns.force.template middleCols<3>(1) = skew<Scalar>(A.angular) + w_x * w_x;

  // I: (L(dw) + w x L(w), 0)
  columns.moment.template rightCols<6>() = inertiaTimes(A.angular) + w_x * inertiaTimes(V.angular);
  columns.force.template rightCols<6>().setZero();
  return columns;
}

// F_A = X_AB F_B, column by column.
template <typename Scalar>
ForceColumns<Scalar> operator*(const Transform<Scalar>& X_AB, const ForceColumns<Scalar>& F_B) {
  ForceColumns<Scalar> F_A;
  F_A.force = X_AB.R * F_B.force;
  F_A.moment = X_AB.R * F_B.moment + skew<Scalar>(X_AB.p) * F_A.force;
  return F_A;
}

}  // namespace internal

/// Regressor of the inverse dynamics: `Y(q, qd, qdd)` with `tau = Y p` for any parameters p.
///
/// O(n^2). Row j holds zeros for the links before joint j. Rotor inertia isn't among the ten
/// parameters: it adds rotor_inertia qdd to tau. The columns are linearly dependent for every
/// robot: only some combinations of parameters (the base parameters) have any influence.
///
/// @tparam Scalar   (of all arguments) float, double or a dual number.
/// @param q,qd,qdd  n each; rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2); order of
///                  chain.jointNames().
/// @param[out] Y    n x 10 n; ten columns per link, for [m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy,
///                  Iyz, Izz] in the link's frame; N m (prismatic N) per unit of the parameter.
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Q, typename Qd, typename Qdd, typename MatrixY>
void regressor(const Chain& chain, const Eigen::MatrixBase<Q>& q, const Eigen::MatrixBase<Qd>& qd,
               const Eigen::MatrixBase<Qdd>& qdd, const Eigen::MatrixBase<MatrixY>& Y) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(Y.rows() == n && Y.cols() == 10 * n);
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);
  Scratch<Motion<Scalar>> A(n);
  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);
  internal::linkAccelerations(chain, X, V, qd, qdd, chain.gravity(), A);

  MatrixY& output = Y.const_cast_derived();
  output.setZero();
  for (Eigen::Index i = 0; i < n; ++i) {
    // link i loads its own joint and every joint before it
    internal::ForceColumns<Scalar> F = internal::bodyRegressor(V[i], A[i]);
    for (Eigen::Index j = i; j >= 0; --j) {
      const bool prismatic = isPrismatic(internal::joint(chain, j));
      output.row(j).template segment<10>(10 * i) = (prismatic ? F.force : F.moment).row(2);
      if (j > 0) F = X[j] * F;
    }
  }
}

}  // namespace v2
}  // namespace chain_dynamics

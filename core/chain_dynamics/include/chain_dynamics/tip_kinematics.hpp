// SPDX-License-Identifier: Apache-2.0

/// @file
/// Where the tip is, and how the joints move it.
///
///     const Transform<double> X_0T = tipPose(chain, q);
///     Eigen::Matrix<double, 6, Eigen::Dynamic> J(6, chain.jointCount());
///     tipJacobian(chain, q, J);                 // (v, w) = J qd
///     tipJacobianDerivative(chain, q, qd, dJ);  // (dv/dt, dw/dt) = J qdd + dJ qd
///
/// The tip T is chain.tip(), fixed to the last link. Rows 0 to 2 of J are linear, 3 to 5 angular (the
/// order of KDL, Pinocchio and ROS messages; spatial.hpp has them the other way round): velocity v of
/// the tip's origin and angular velocity w of the last link, both **in the axes of the root frame**.
/// Everything here is stated in those axes, where the columns are simple geometry. With z the axis of
/// joint i, p its origin and r = p_T - p the arm from there to the tip:
///
///     revolute    column (z x r, z)     its derivative (z' x r + z x r', z')
///     prismatic   column (z, 0)         its derivative (z', 0)
///
/// The dash is a derivative by time: z' = w x z, with w that of the link.

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cassert>

#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/kinematics.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace internal {

// X_0[i]: pose of link i in the axes of the root frame, from the first joint's place at q = 0, which a
// Jacobian doesn't depend on. Returns the tip's origin.
template <typename Q, typename Scalar>
Vector3<Scalar> linksOnFirstJoint(const Chain& chain, const Eigen::MatrixBase<Q>& q,
                                  Scratch<Transform<Scalar>>& X_0) {
  const Eigen::Index n = chain.jointCount();
  assert(q.size() == n);
  X_0[0] = jointPose<Scalar>(joint(chain, 0), q[0]);
  X_0[0].p = Vector3<Scalar>::Zero();
  if (isPrismatic(joint(chain, 0))) X_0[0].p = X_0[0].R.col(2) * q[0];
  for (Eigen::Index i = 1; i < n; ++i) {
    X_0[i] = X_0[i - 1] * jointPose<Scalar>(joint(chain, i), q[i]);
  }
  return (X_0[n - 1] * chain.tip().template cast<Scalar>()).p;
}

}  // namespace internal

/// Pose of the tip frame in the root frame, `X_0T(q)`.
///
/// @tparam Scalar  (of q) float, double or a dual number.
/// @param q        n; rad (prismatic m); order of chain.jointNames().
/// @return         R, and p in m.
/// Real time: no allocation, lock, exception or system call. Threads: safe.
template <typename Q>
inline Transform<typename Q::Scalar> tipPose(const Chain& chain, const Eigen::MatrixBase<Q>& q) {
  using Scalar = typename Q::Scalar;
  assert(q.size() == chain.jointCount());
  Transform<Scalar> X_0i = Transform<Scalar>::identity();
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    X_0i = X_0i * jointPose<Scalar>(internal::joint(chain, i), q[i]);
  }
  return X_0i * chain.tip().template cast<Scalar>();
}

/// Jacobian of the tip, `J(q)`: `(v, w) = J qd`, velocity of the tip's origin and angular velocity in
/// the axes of the root frame.
///
/// Column by column from the joints' axes, O(n) [Featherstone 2008, sec. 2.10; Siciliano et al.,
/// Robotics, 2009, sec. 3.1.3].
///
/// @tparam Scalar  (of q, J) float, double or a dual number.
/// @param q        n; rad (prismatic m); order of chain.jointNames().
/// @param[out] J   6 x n, linear rows first; m and 1 per rad (prismatic 1 and 1/m).
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Q, typename MatrixJ>
void tipJacobian(const Chain& chain, const Eigen::MatrixBase<Q>& q,
                 const Eigen::MatrixBase<MatrixJ>& J) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(J.rows() == 6 && J.cols() == n);
  MatrixJ& out = J.const_cast_derived();
  Scratch<Transform<Scalar>> X_0(n);
  const Vector3<Scalar> p_tip = internal::linksOnFirstJoint(chain, q, X_0);

  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector3<Scalar> z = X_0[i].R.col(2);
    if (isPrismatic(internal::joint(chain, i))) {
      out.col(i) << z, Vector3<Scalar>::Zero();
    } else {
      out.col(i) << z.cross(p_tip - X_0[i].p), z;
    }
  }
}

/// Derivative of the tip's Jacobian by time, `dJ(q, qd)`: the tip accelerates by `J qdd + dJ qd`.
///
/// @tparam Scalar  (of q, qd, dJ) float, double or a dual number.
/// @param q,qd     n each; rad, rad/s (prismatic m, m/s); order of chain.jointNames().
/// @param[out] dJ  6 x n, linear rows first; those of tipJacobian() per second.
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Q, typename Qd, typename MatrixJ>
void tipJacobianDerivative(const Chain& chain, const Eigen::MatrixBase<Q>& q,
                           const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<MatrixJ>& dJ) {
  using Number = Dual<typename Q::Scalar, 1>;
  const Eigen::Index n = chain.jointCount();
  assert(qd.size() == n && dJ.rows() == 6 && dJ.cols() == n);
  Scratch<Number> q_memory(n);
  Scratch<Eigen::Matrix<Number, 6, 1>> J_memory(n);
  Eigen::Map<Eigen::Matrix<Number, Eigen::Dynamic, 1>> moving(&q_memory[0], n);
  Eigen::Map<Eigen::Matrix<Number, 6, Eigen::Dynamic>> J(J_memory[0].data(), 6, n);

  // the one direction of the dual numbers is time
  for (Eigen::Index j = 0; j < n; ++j)
    moving[j] = {q[j], Eigen::Matrix<typename Q::Scalar, 1, 1>(qd[j])};
  tipJacobian(chain, moving, J);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i < 6; ++i) dJ.const_cast_derived()(i, j) = J(i, j).derivative[0];
  }
}

}  // namespace v2
}  // namespace chain_dynamics

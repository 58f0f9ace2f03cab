// SPDX-License-Identifier: Apache-2.0

/// @file
/// The torques as a linear function of the inertial parameters: what identification fits.
///
///     Eigen::MatrixXd Y(n, 10 * n);
///     regressor(chain, q, qd, qdd, Y);
///     tau = Y * parameters(chain) + rotor_inertia.cwiseProduct(qdd);
///
/// The force `I A + V x* (I V)` that gives a body its motion is linear in its ten parameters, so a column
/// is the force of one unit of a parameter, carried from joint to joint like any force.

#pragma once

#include <Eigen/Core>
#include <cassert>

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
  for (Eigen::Index column = 0; column < 10 * n; ++column) {
    // the force that a unit of the parameter needs: it loads the link's own joint and those before it
    const Eigen::Index link = column / 10;
    const auto I = SpatialInertia<Scalar>::fromVector(Vector10<Scalar>::Unit(column % 10));
    Force<Scalar> F = I * A[link] + cross(V[link], I * V[link]);
    for (Eigen::Index j = link; j >= 0; --j) {
      output(j, column) = alongAxis(internal::joint(chain, j), F);
      if (j > 0) F = X[j] * F;
    }
  }
}

}  // namespace v2
}  // namespace chain_dynamics

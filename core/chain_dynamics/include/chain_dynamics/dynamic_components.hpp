// SPDX-License-Identifier: Apache-2.0

/// @file
/// All terms of the equation of motion, in one pass over the links and back.
///
///     dynamicComponents(chain, q, qd, H, c, g);
///     tau = H * qdd + c + g;   // what torques(chain, q, qd, qdd, tau) gives

#pragma once

#include <Eigen/Core>
#include <cassert>

#include "chain_dynamics/gravity_vector.hpp"
#include "chain_dynamics/inertia_matrix.hpp"
#include "chain_dynamics/kinematics.hpp"
#include "chain_dynamics/torques.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Inertia matrix, Coriolis and gravity torques: `H(q)`, `C(q, qd) qd`, `g(q)`.
///
/// The algorithms of inertia_matrix.hpp, coriolis_vector.hpp and gravity_vector.hpp on the same
/// kinematics: one sine and cosine per joint, one pass from root to tip.
///
/// @tparam Scalar  (of all arguments) float, double or a dual number.
/// @param sets     ParameterSets [parameter_sets.hpp]; left out: chain.links().
/// @param q,qd     n each; rad, rad/s (prismatic m, m/s); order of chain.jointNames().
/// @param[out] H   n x n; kg m^2 (prismatic kg, mixed kg m).
/// @param[out] c   n; N m (prismatic N): C(q, qd) qd.
/// @param[out] g   n; N m (prismatic N).
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Sets, typename Q, typename Qd, typename MatrixH, typename C, typename G>
void dynamicComponents(const Chain& chain, const Sets& sets, const Eigen::MatrixBase<Q>& q,
                       const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<MatrixH>& H,
                       const Eigen::MatrixBase<C>& c, const Eigen::MatrixBase<G>& g) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(H.rows() == n && H.cols() == n && c.size() == n && g.size() == n);
  assert(internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);
  Scratch<Motion<Scalar>> A(n);
  Scratch<Vector3<Scalar>> a(n);

  // how the links move and where gravity points, from root to tip
  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);
  internal::velocityAccelerations(chain, X, V, qd, A);
  internal::gravityInLinks(chain, X, a);

  // which forces that needs, from tip to root
  internal::inertiaOfPoses(chain, sets, X, H.const_cast_derived());
  internal::torquesOfMotion(chain, sets, X, V, A, c.const_cast_derived());
  internal::gravityOfPoses(chain, sets, X, a, g.const_cast_derived());
}
template <typename Q, typename Qd, typename MatrixH, typename C, typename G>
void dynamicComponents(const Chain& chain, const Eigen::MatrixBase<Q>& q,
                       const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<MatrixH>& H,
                       const Eigen::MatrixBase<C>& c, const Eigen::MatrixBase<G>& g) {
  dynamicComponents(chain, internal::OwnParameters(), q, qd, H, c, g);
}

}  // namespace v2
}  // namespace chain_dynamics

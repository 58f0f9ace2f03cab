// SPDX-License-Identifier: Apache-2.0

/// @file
/// Coriolis and centrifugal torques: what it takes to keep the joint velocities constant.
///
///     Eigen::VectorXd c(chain.jointCount());
///     coriolisVector(chain, q, qd, c);

#pragma once

#include <Eigen/Core>
#include <cassert>

#include "chain_dynamics/kinematics.hpp"
#include "chain_dynamics/torques.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Coriolis and centrifugal torques: `C(q, qd) qd`.
///
/// The recursion of torques.hpp at qdd = 0 and without gravity [Featherstone 2008, sec. 5.3], O(n).
/// Only the product is computed, without the matrix [coriolis_matrix.hpp].
///
/// @tparam Scalar  (of q, qd, c) float, double or a dual number.
/// @param sets     ParameterSets [parameter_sets.hpp]; left out: chain.links().
/// @param q,qd     n each; rad, rad/s (prismatic m, m/s); order of chain.jointNames().
/// @param[out] c   n; N m (prismatic N).
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Sets, typename Q, typename Qd, typename C>
void coriolisVector(const Chain& chain, const Sets& sets, const Eigen::MatrixBase<Q>& q,
                    const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<C>& c) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(c.size() == n && internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);
  Scratch<Motion<Scalar>> A(n);

  // how the links move, from root to tip
  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);
  internal::velocityAccelerations(chain, X, V, qd, A);

  // which forces that needs, from tip to root
  internal::torquesOfMotion(chain, sets, X, V, A, c.const_cast_derived());
}
template <typename Q, typename Qd, typename C>
void coriolisVector(const Chain& chain, const Eigen::MatrixBase<Q>& q,
                    const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<C>& c) {
  coriolisVector(chain, internal::OwnParameters(), q, qd, c);
}

}  // namespace v2
}  // namespace chain_dynamics

// SPDX-License-Identifier: Apache-2.0

/// @file
/// Kinetic and potential energy: what the torques' work goes into.
///
///     const double energy = kineticEnergy(chain, q, qd) + potentialEnergy(chain, q);
///
/// Computed from the links' velocities and positions, not from H or g: independent of them, which
/// is what the tests of this package rely on.

#pragma once

#include <Eigen/Core>
#include <cassert>
#include <vector>

#include "chain_dynamics/kinematics.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace internal {

// Potential energy of gravity with one parameter set.
template <typename Q>
typename Q::Scalar potentialEnergyOf(const Chain& chain, const std::vector<LinkParameters>& links,
                                     const Eigen::MatrixBase<Q>& q) {
  using Scalar = typename Q::Scalar;
  assert(q.size() == chain.jointCount());
  const Vector3<Scalar> gravity = chain.gravity().template cast<Scalar>();

  Transform<Scalar> X_0i = Transform<Scalar>::identity();
  Scalar energy(0);
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    X_0i = X_0i * jointPose<Scalar>(joint(chain, i), q[i]);
    const SpatialInertia<Scalar> I = link<Scalar>(links, i);
    energy -= gravity.dot(X_0i.p * I.mass + X_0i.R * I.first_moment);
  }
  return energy;
}

}  // namespace internal

/// Kinetic energy: `T(q, qd) = sum of 1/2 V' I V + 1/2 rotor_inertia qd^2`, which is `1/2 qd' H
/// qd`.
///
/// O(n) [Featherstone 2008, sec. 2.13].
///
/// @tparam Scalar  (of q, qd) float, double or a dual number.
/// @param q,qd     n each; rad, rad/s (prismatic m, m/s); order of chain.jointNames().
/// @return         J.
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Q, typename Qd>
typename Q::Scalar kineticEnergy(const Chain& chain, const Eigen::MatrixBase<Q>& q,
                                 const Eigen::MatrixBase<Qd>& qd) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);
  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);

  Scalar twice_energy(0);
  for (Eigen::Index i = 0; i < n; ++i) {
    const SpatialInertia<Scalar> I = internal::link<Scalar>(chain.links(), i);
    const Scalar rotor_inertia(internal::joint(chain, i).rotor_inertia);
    twice_energy += dot(V[i], I * V[i]) + rotor_inertia * qd[i] * qd[i];
  }
  return Scalar(0.5) * twice_energy;
}

/// Potential energy of gravity: `U(q) = - sum of gravity . (m p + R mc)`, zero at the root's
/// origin.
///
/// p and R are position and rotation of each link in the root frame. O(n).
///
/// @tparam Scalar  (of q) float, double or a dual number.
/// @param q        n; rad (prismatic m); order of chain.jointNames().
/// @return         J.
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Q>
typename Q::Scalar potentialEnergy(const Chain& chain, const Eigen::MatrixBase<Q>& q) {
  return internal::potentialEnergyOf(chain, chain.links(), q);
}

}  // namespace v2
}  // namespace chain_dynamics

// SPDX-License-Identifier: Apache-2.0

/// @file
/// Inverse dynamics: which joint torques belong to this motion?
///
///     Eigen::VectorXd tau(chain.jointCount());
///     torques(chain, q, qd, qdd, tau);

#pragma once

#include <Eigen/Core>

#include "chain_dynamics/kinematics.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace internal {

// Rows first..n-1 of the torques with one parameter set, from the links' motion.
// F is the force through joint i: what link i and all links after it need for their motion.
template <typename Scalar, typename Tau>
void torquesOfMotion(const Chain& chain, const std::vector<LinkParameters>& links,
                     const Scratch<Transform<Scalar>>& X, const Scratch<Motion<Scalar>>& V,
                     const Scratch<Motion<Scalar>>& A, Eigen::Index first, Tau& tau) {
  Force<Scalar> F = Force<Scalar>::zero();
  for (Eigen::Index i = chain.jointCount() - 1; i >= first; --i) {
    // F += I A + V x* (I V)
    const SpatialInertia<Scalar> I = link<Scalar>(links, i);
    F += I * A[i] + cross(V[i], I * V[i]);

    // tau = S' F
    tau[i] = alongAxis(joint(chain, i), F);

    // on to the link before
    if (i > first) {
      F = X[i] * F;
    }
  }
}

// What the motors' own rotors need, which no link's parameters hold: rotor_inertia qdd.
// Kept aside until the end, so that tau may be the memory of an input.
template <typename Qdd, typename Scalar>
void rotorTorques(const Chain& chain, const Eigen::MatrixBase<Qdd>& qdd, Scratch<Scalar>& rotor) {
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    rotor[i] = Scalar(joint(chain, i).rotor_inertia) * qdd[i];
  }
}

// tau += other
template <typename Scalar, typename Tau>
void addTo(Tau& tau, const Scratch<Scalar>& other) {
  for (Eigen::Index i = 0; i < tau.size(); ++i) {
    tau[i] += other[i];
  }
}

}  // namespace internal

/// Joint torques of a given motion: `tau = H(q) qdd + C(q, qd) qd + g(q)`.
///
/// Recursive Newton-Euler in link frames [Featherstone 2008, sec. 5.3, table 5.1], O(n). Without
/// friction: see friction.hpp.
///
/// @tparam Scalar   (of q, qd, qdd, tau) float, double or a dual number.
/// @param q,qd,qdd  n each; rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2); order of
///                  chain.jointNames().
/// @param[out] tau  n; N m (prismatic N).
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Q, typename Qd, typename Qdd, typename Tau>
void torques(const Chain& chain, const Eigen::MatrixBase<Q>& q, const Eigen::MatrixBase<Qd>& qd,
             const Eigen::MatrixBase<Qdd>& qdd, const Eigen::MatrixBase<Tau>& tau) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(tau.size() == n);
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);
  Scratch<Motion<Scalar>> A(n);
  Scratch<Scalar> rotor(n);

  // how the links move, from root to tip
  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);
  internal::linkAccelerations(chain, X, V, qd, qdd, chain.gravity(), A);

  // which forces that needs, from tip to root
  internal::rotorTorques(chain, qdd, rotor);
  internal::torquesOfMotion(chain, chain.links(), X, V, A, 0, tau.const_cast_derived());
  internal::addTo(tau.const_cast_derived(), rotor);
}

}  // namespace v2
}  // namespace chain_dynamics

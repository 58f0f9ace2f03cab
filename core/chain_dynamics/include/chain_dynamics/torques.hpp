// SPDX-License-Identifier: Apache-2.0

/// @file
/// Inverse dynamics: which joint torques belong to this motion?
///
///     Eigen::VectorXd tau(chain.jointCount());
///     torques(chain, q, qd, qdd, tau);

#pragma once

#include <Eigen/Core>
#include <cassert>
#include <vector>

#include "chain_dynamics/gravity_vector.hpp"
#include "chain_dynamics/kinematics.hpp"
#include "chain_dynamics/parameter_sets.hpp"

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

    // on to the parent link
    if (i > first) F = X[i] * F;
  }
}

// The torques, row j with set j.
template <typename Sets, typename Scalar, typename Tau>
void torquesOfMotion(const Chain& chain, const Sets& sets, const Scratch<Transform<Scalar>>& X,
                     const Scratch<Motion<Scalar>>& V, const Scratch<Motion<Scalar>>& A, Tau& tau) {
  forEachSet(chain, sets, [&](const std::vector<LinkParameters>& links, Eigen::Index first) {
    torquesOfMotion(chain, links, X, V, A, first, tau);
  });
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
  for (Eigen::Index i = 0; i < tau.size(); ++i) tau[i] += other[i];
}

// tau += g of the set for gravity, if there is one
template <typename Sets, typename Scalar, typename Tau>
void addGravityOfItsSet(const Chain& chain, const Sets& sets, const Scratch<Transform<Scalar>>& X,
                        Tau& tau) {
  if (gravitySet(sets) == nullptr) return;
  Scratch<Vector3<Scalar>> a(chain.jointCount());
  Scratch<Scalar> g(chain.jointCount());
  gravityInLinks(chain, X, a);
  gravityOfPoses(chain, sets, X, a, g);
  addTo(tau, g);
}

}  // namespace internal

/// Joint torques of a given motion: `tau = H(q) qdd + C(q, qd) qd + g(q)`.
///
/// Recursive Newton-Euler in link frames [Featherstone 2008, sec. 5.3, table 5.1], O(n). Without
/// friction: see friction.hpp.
///
/// @tparam Scalar   (of q, qd, qdd, tau) float, double or a dual number.
/// @param sets      ParameterSets [parameter_sets.hpp]; left out: chain.links().
/// @param q,qd,qdd  n each; rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2); order of
///                  chain.jointNames().
/// @param[out] tau  n; N m (prismatic N).
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Sets, typename Q, typename Qd, typename Qdd, typename Tau>
void torques(const Chain& chain, const Sets& sets, const Eigen::MatrixBase<Q>& q,
             const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<Qdd>& qdd,
             const Eigen::MatrixBase<Tau>& tau) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(tau.size() == n && internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);
  Scratch<Motion<Scalar>> A(n);
  Scratch<Scalar> rotor(n);

  // how the links move, from root to tip; gravity with its own parameters comes on top
  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);
  internal::linkAccelerations(chain, X, V, qd, qdd, internal::gravityOfMotion(chain, sets), A);

  // which forces that needs, from tip to root
  internal::rotorTorques(chain, qdd, rotor);
  internal::torquesOfMotion(chain, sets, X, V, A, tau.const_cast_derived());
  internal::addTo(tau.const_cast_derived(), rotor);
  internal::addGravityOfItsSet(chain, sets, X, tau.const_cast_derived());
}
template <typename Q, typename Qd, typename Qdd, typename Tau>
void torques(const Chain& chain, const Eigen::MatrixBase<Q>& q, const Eigen::MatrixBase<Qd>& qd,
             const Eigen::MatrixBase<Qdd>& qdd, const Eigen::MatrixBase<Tau>& tau) {
  torques(chain, internal::OwnParameters(), q, qd, qdd, tau);
}

}  // namespace v2
}  // namespace chain_dynamics

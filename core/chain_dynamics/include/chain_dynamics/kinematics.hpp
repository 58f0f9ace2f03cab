// SPDX-License-Identifier: Apache-2.0

/// @file
/// The passes from root to tip: where the links are, how they move, how gravity looks from them.
///
///     Scratch<Transform<double>> X(n);
///     Scratch<Motion<double>> V(n);
///     internal::linkPoses(chain, q, X);
///     internal::linkVelocities(chain, X, qd, V);
///
/// Every algorithm of this package starts with some of these and then goes back from tip to root
/// with the inertial parameters. No pass reads a parameter, so several quantities, or several
/// parameter sets, share one. Everything is stated in link frames [Featherstone 2008, sec. 5.3].
/// In loops, index i is link i + 1 of the book, and X[i] the pose of its frame in the one before.
///
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.

#pragma once

#include <Eigen/Core>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/joint_axis.hpp"
#include "chain_dynamics/scratch.hpp"
#include "chain_dynamics/spatial.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// `X_(i-1)i = placement RotZ(q)`, prismatic `placement TransZ(q)`: pose of a link on the one
/// before.
///
/// @param q  rad, any number of turns; prismatic m.
template <typename Scalar>
Transform<Scalar> jointPose(const Joint& joint, const Scalar& q) {
  Transform<Scalar> X = joint.placement.template cast<Scalar>();

  // TransZ(q) moves along the third column, and needs no sine
  if (isPrismatic(joint)) {
    X.p += X.R.col(2) * q;
    return X;
  }

  // RotZ(q) mixes the first two columns
  using std::cos;
  using std::sin;
  const Scalar c = cos(q);
  const Scalar s = sin(q);
  const Vector3<Scalar> x = X.R.col(0);
  const Vector3<Scalar> y = X.R.col(1);
  X.R.col(0) = x * c + y * s;
  X.R.col(1) = y * c - x * s;
  return X;
}

namespace internal {

// The i-th joint or link: Eigen counts with signed numbers, the standard library doesn't.
inline const Joint& joint(const Chain& chain, Eigen::Index i) {
  return chain.joints()[static_cast<std::size_t>(i)];
}
template <typename Scalar>
SpatialInertia<Scalar> link(const std::vector<LinkParameters>& links, Eigen::Index i) {
  return links[static_cast<std::size_t>(i)].template cast<Scalar>();
}

// X[i]: pose of link i in link i - 1.
template <typename Q, typename Scalar>
void linkPoses(const Chain& chain, const Eigen::MatrixBase<Q>& q, Scratch<Transform<Scalar>>& X) {
  assert(q.size() == chain.jointCount());
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    X[i] = jointPose<Scalar>(joint(chain, i), q[i]);
  }
}

// V[i] = iX_(i-1) V[i-1] + S qd[i], from a root at rest [Featherstone 2008, eq. 5.14].
template <typename Qd, typename Scalar>
void linkVelocities(const Chain& chain, const Scratch<Transform<Scalar>>& X,
                    const Eigen::MatrixBase<Qd>& qd, Scratch<Motion<Scalar>>& V) {
  assert(qd.size() == chain.jointCount());
  V[0] = Motion<Scalar>::zero();
  addAlongAxis<Scalar>(joint(chain, 0), qd[0], V[0]);
  for (Eigen::Index i = 1; i < chain.jointCount(); ++i) {
    V[i] = X[i].inverseTimes(V[i - 1]);
    addAlongAxis<Scalar>(joint(chain, i), qd[i], V[i]);
  }
}

// A[i] = iX_(i-1) A[i-1] + V[i] x S qd[i]: what the velocities alone accelerate
// [Featherstone 2008, eq. 5.15 with qdd = 0].
template <typename Qd, typename Scalar>
void velocityAccelerations(const Chain& chain, const Scratch<Transform<Scalar>>& X,
                           const Scratch<Motion<Scalar>>& V, const Eigen::MatrixBase<Qd>& qd,
                           Scratch<Motion<Scalar>>& A) {
  A[0] = Motion<Scalar>::zero();  // V[0] is along the axis: V[0] x S = 0
  for (Eigen::Index i = 1; i < chain.jointCount(); ++i) {
    A[i] = X[i].inverseTimes(A[i - 1]);
    addVelocityProduct<Scalar>(joint(chain, i), V[i], qd[i], A[i]);
  }
}

// A[i] = iX_(i-1) A[i-1] + V[i] x S qd[i] + S qdd[i] [Featherstone 2008, eq. 5.15], from a root
// that accelerates upwards at A_0.linear = -gravity: that is how gravity feels.
template <typename Qd, typename Qdd, typename Scalar>
void linkAccelerations(const Chain& chain, const Scratch<Transform<Scalar>>& X,
                       const Scratch<Motion<Scalar>>& V, const Eigen::MatrixBase<Qd>& qd,
                       const Eigen::MatrixBase<Qdd>& qdd, const Eigen::Vector3d& gravity,
                       Scratch<Motion<Scalar>>& A) {
  assert(qdd.size() == chain.jointCount());
  Motion<Scalar> A_previous = {Vector3<Scalar>::Zero(), -gravity.template cast<Scalar>()};
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    A[i] = X[i].inverseTimes(A_previous);
    addVelocityProduct<Scalar>(joint(chain, i), V[i], qd[i], A[i]);
    addAlongAxis<Scalar>(joint(chain, i), qdd[i], A[i]);
    A_previous = A[i];
  }
}

// a[i] = -gravity, expressed in link i: the acceleration of a robot that doesn't fall.
template <typename Scalar>
void gravityInLinks(const Chain& chain, const Scratch<Transform<Scalar>>& X,
                    Scratch<Vector3<Scalar>>& a) {
  Vector3<Scalar> a_previous = -chain.gravity().template cast<Scalar>();
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    a[i] = X[i].R.transpose() * a_previous;
    a_previous = a[i];
  }
}

}  // namespace internal
}  // namespace v2
}  // namespace chain_dynamics

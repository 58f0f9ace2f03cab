// SPDX-License-Identifier: Apache-2.0

/// @file
/// What a joint lets through: its motion subspace S, the z axis of its link's frame.
///
///     addAlongAxis(joint, qd, V);        // V += S qd
///     tau = alongAxis(joint, F);         // tau = S' F
///
/// S is the motion of one rad/s about z (revolute) or one m/s along z (prismatic)
/// [Featherstone 2008, sec. 3.5]. No algorithm multiplies by an axis: each product with S is one
/// entry, or one column. The type of the joint is the same for every state, so the branch on it is
/// not a branch on a Scalar.
///
/// Real time: no allocation, lock, exception or system call. Threads: safe.

#pragma once

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/spatial.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// `S' F`: the part of a force that the motor feels; the rest goes into the bearings.
template <typename Scalar>
Scalar alongAxis(const Joint& joint, const Force<Scalar>& F) {
  return isPrismatic(joint) ? F.force.z() : F.moment.z();
}

/// `M += S rate`.
template <typename Scalar>
void addAlongAxis(const Joint& joint, const Scalar& rate, Motion<Scalar>& M) {
  (isPrismatic(joint) ? M.linear : M.angular).z() += rate;
}

/// `A += V x S qd`: acceleration because the axis is carried along by its link.
template <typename Scalar>
void addVelocityProduct(const Joint& joint, const Motion<Scalar>& V, const Scalar& qd,
                        Motion<Scalar>& A) {
  // revolute: V x (z qd, 0) = (w x z qd, v x z qd); prismatic: V x (0, z qd) = (0, w x z qd)
  const Vector3<Scalar>& crosses_linear = isPrismatic(joint) ? V.angular : V.linear;
  A.linear.x() += crosses_linear.y() * qd;
  A.linear.y() -= crosses_linear.x() * qd;
  if (!isPrismatic(joint)) {
    A.angular.x() += V.angular.y() * qd;
    A.angular.y() -= V.angular.x() * qd;
  }
}

/// `I S`: force that accelerates the body at one rad/s^2 or m/s^2 along the axis.
template <typename Scalar>
Force<Scalar> timesAxis(const SpatialInertia<Scalar>& I, const Joint& joint) {
  const Scalar zero(0);
  const Vector3<Scalar> mc_x_z(I.first_moment.y(), -I.first_moment.x(), zero);
  if (isPrismatic(joint)) return {mc_x_z, Vector3<Scalar>(zero, zero, I.mass)};
  return {I.inertia.col(2), -mc_x_z};
}

}  // namespace v2
}  // namespace chain_dynamics

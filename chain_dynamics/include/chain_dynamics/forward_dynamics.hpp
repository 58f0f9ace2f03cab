// SPDX-License-Identifier: Apache-2.0

/// @file
/// Forward dynamics: how does the robot move under these joint torques?
///
///     Eigen::VectorXd qdd(chain.jointCount());
///     forwardDynamics(chain, q, qd, tau, qdd);   // then integrate: that is a simulator

#pragma once

#include <Eigen/Core>

#include "chain_dynamics/articulated_inertia.hpp"
#include "chain_dynamics/kinematics.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace internal {

// What the pass from tip to root leaves for the pass back, per joint.
template <typename Scalar>
struct ArticulatedJoint {
  Motion<Scalar> c;  // V x S qd, the acceleration that velocities cause
  Force<Scalar> U;   // I_A S: force that moves the joint, and all that hangs on it loosely
  Scalar inverse_D;  // 1 / (S' U + rotor_inertia): acceleration per torque
  Scalar u;          // torque left for accelerating
};

// From tip to root: the articulated inertia I_A and bias force p_A of each link.
template <typename Tau, typename Qd, typename Scalar>
void articulate(const Chain& chain, const Scratch<Transform<Scalar>>& X,
                const Scratch<Motion<Scalar>>& V, const Eigen::MatrixBase<Qd>& qd,
                const Eigen::MatrixBase<Tau>& tau, Scratch<ArticulatedJoint<Scalar>>& joints) {
  ArticulatedInertia<Scalar> I_A = ArticulatedInertia<Scalar>::zero();
  Force<Scalar> p_A = Force<Scalar>::zero();
  for (Eigen::Index i = chain.jointCount() - 1; i >= 0; --i) {
    const Joint& at = joint(chain, i);
    ArticulatedJoint<Scalar>& out = joints[i];

    // I_A += I, p_A += V x* (I V)
    const SpatialInertia<Scalar> I = link<Scalar>(chain.links(), i);
    I_A += I;
    p_A += cross(V[i], I * V[i]);

    // U = I_A S, D = S' U, u = tau - S' p_A
    out.c = Motion<Scalar>::zero();
    addVelocityProduct<Scalar>(at, V[i], qd[i], out.c);
    out.U = I_A.timesAxis(isPrismatic(at));
    out.inverse_D = Scalar(1) / (alongAxis(at, out.U) + Scalar(at.rotor_inertia));
    out.u = tau[i] - alongAxis(at, p_A);

    // what the parent link feels: I_a = I_A - U U' / D, p_a = p_A + I_a c + U u / D
    if (i > 0) {
      const ArticulatedInertia<Scalar> I_a = I_A.released(out.U, out.inverse_D);
      p_A = X[i] * (p_A + I_a * out.c + out.U * (out.u * out.inverse_D));
      I_A = X[i] * I_a;
    }
  }
}

// From root to tip: each joint's acceleration, given that of the parent link.
template <typename Scalar, typename Qdd>
void accelerate(const Chain& chain, const Scratch<Transform<Scalar>>& X,
                const Scratch<ArticulatedJoint<Scalar>>& joints, Qdd& qdd) {
  Motion<Scalar> A = {Vector3<Scalar>::Zero(), -chain.gravity().template cast<Scalar>()};
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    // A = iX_(i-1) A + c, qdd = (u - U' A) / D, A += S qdd
    A = X[i].inverseTimes(A) + joints[i].c;
    qdd[i] = (joints[i].u - dot(A, joints[i].U)) * joints[i].inverse_D;
    addAlongAxis<Scalar>(joint(chain, i), qdd[i], A);
  }
}

}  // namespace internal

/// Joint accelerations under given torques: `qdd = H(q)^-1 (tau - C(q, qd) qd - g(q))`.
///
/// Articulated body algorithm in link frames [Featherstone 2008, sec. 7.3, table 7.1], O(n).
/// Without friction. A joint that moves neither mass nor rotor inertia (H singular) gives infinity
/// or NaN in every joint that depends on it, no error. With parameters that no rigid bodies have
/// (Chain::warnings()) H needn't be positive definite: the result still solves the equation, but
/// describes no motion of a robot.
///
/// @tparam Scalar   (of all arguments) float, double or a dual number.
/// @param q,qd,tau  n each; rad, rad/s, N m (prismatic m, m/s, N); order of chain.jointNames().
/// @param[out] qdd  n; rad/s^2 (prismatic m/s^2).
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Q, typename Qd, typename Tau, typename Qdd>
void forwardDynamics(const Chain& chain, const Eigen::MatrixBase<Q>& q,
                     const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<Tau>& tau,
                     const Eigen::MatrixBase<Qdd>& qdd) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(tau.size() == n && qdd.size() == n);
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);
  Scratch<internal::ArticulatedJoint<Scalar>> joints(n);

  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);
  internal::articulate(chain, X, V, qd, tau, joints);
  internal::accelerate(chain, X, joints, qdd.const_cast_derived());
}

}  // namespace v2
}  // namespace chain_dynamics

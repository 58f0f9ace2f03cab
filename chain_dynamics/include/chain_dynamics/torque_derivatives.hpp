// SPDX-License-Identifier: Apache-2.0

/// @file
/// Derivatives of inverse dynamics: how do the torques change with position, velocity,
/// acceleration?
///
///     Eigen::MatrixXd dtau_dq(n, n), dtau_dqd(n, n), H(n, n);
///     torqueDerivatives(chain, q, qd, qdd, dtau_dq, dtau_dqd, H);   // H = dtau/dqdd
///
/// Turn joint j a little further. Link i after it, with all that hangs on it, goes along as one
/// block, and if the world went along too, nothing would change for joint i. But the world stays:
/// compared with the block, it is the *base* on which joint j stands that has got another motion.
/// The links feel that as an additional velocity and acceleration, the same motion for all of them:
///
///     by q_j:     dV = V x S,   dA = A x S + V x (V x S)          S: axis of joint j
///     by qd_j:    dV = S,       dA = 2 V x S                      V, A: motion of link j
///     by qdd_j:   dV = 0,       dA = S
///
/// What that costs in torque needs only sums over the links from i to the tip: their inertia I_c
/// for dA, and the flow of their mass for dV, whose effect is Coriolis' force [mass_flow.hpp]. A
/// joint j before the one that turns, i, has no such block. Its torque holds the same additional
/// force of the links after i, and the force F that was there before, which has turned along: S_i
/// x* F.

#pragma once

#include <Eigen/Core>

#include "chain_dynamics/kinematics.hpp"
#include "chain_dynamics/mass_flow.hpp"
#include "chain_dynamics/parameter_sets.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace internal {

// What a unit of a joint's travel adds to the motion of all links after it.
template <typename Scalar>
struct AxisRates {
  Motion<Scalar> first;   // V x S
  Motion<Scalar> second;  // A x S + V x (V x S)
};

template <typename Scalar>
void axisRates(const Chain& chain, const Scratch<Motion<Scalar>>& V,
               const Scratch<Motion<Scalar>>& A, Scratch<AxisRates<Scalar>>& rates) {
  for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
    const Motion<Scalar> S = axisMotion<Scalar>(joint(chain, i));
    rates[i].first = cross(V[i], S);
    rates[i].second = cross(A[i], S) + cross(V[i], rates[i].first);
  }
}

// A link and all after it.
template <typename Scalar>
struct Block {
  SpatialInertia<Scalar> I_c = SpatialInertia<Scalar>::zero();
  MassFlow<Scalar> flow = MassFlow<Scalar>::zero();
  Force<Scalar> F = Force<Scalar>::zero();  // through the joint that holds it

  void add(const SpatialInertia<Scalar>& I, const Motion<Scalar>& V, const Motion<Scalar>& A) {
    I_c += I;
    flow += flowOf(I, V);
    F += I * A + cross(V, I * V);
  }
  void moveBy(const Transform<Scalar>& X) {
    I_c = X * I_c;
    flow = X * flow;
    F = X * F;
  }
};

// What joint i needs for, or does with, a small change: forces that go on to the joints before.
template <typename Scalar>
struct ForceRates {
  Force<Scalar> by_q, by_qd, by_qdd;  // of the force through joint i, by its own travel
  Force<Scalar> turned;  // joint i's torque by a turn of what is before it: Coriolis' alone

  ForceRates(const Block<Scalar>& block, const Joint& at, const AxisRates<Scalar>& rates) {
    const Motion<Scalar> S = axisMotion<Scalar>(at);
    by_q = block.flow.coriolis(rates.first.angular) + block.I_c * rates.second + cross(S, block.F);
    by_qd = block.flow.coriolis(S.angular) + (block.I_c * rates.first) * Scalar(2);
    by_qdd = timesAxis(block.I_c, at);
    turned = {block.flow.coriolisAlong(S), Vector3<Scalar>::Zero()};
  }
  void moveBy(const Transform<Scalar>& X) {
    by_q = X * by_q;
    by_qd = X * by_qd;
    by_qdd = X * by_qdd;
    turned = X * turned;
  }
};

// The three matrices.
template <typename MatrixQ, typename MatrixQd, typename MatrixH>
struct DerivativeMatrices {
  MatrixQ& q;
  MatrixQd& qd;
  MatrixH& qdd;
};
template <typename MatrixQ, typename MatrixQd, typename MatrixH>
DerivativeMatrices<MatrixQ, MatrixQd, MatrixH> derivativeMatrices(
    const Chain& chain, const Eigen::MatrixBase<MatrixQ>& q, const Eigen::MatrixBase<MatrixQd>& qd,
    const Eigen::MatrixBase<MatrixH>& qdd) {
  [[maybe_unused]] const Eigen::Index n = chain.jointCount();
  assert(q.rows() == n && q.cols() == n);
  assert(qd.rows() == n && qd.cols() == n);
  assert(qdd.rows() == n && qdd.cols() == n);
  return {q.const_cast_derived(), qd.const_cast_derived(), qdd.const_cast_derived()};
}

// Row i up to the diagonal, and column i of the rows from `first` to the diagonal.
template <typename Scalar, typename Matrices>
void derivativesUpToDiagonal(const Chain& chain, const Scratch<Transform<Scalar>>& X,
                             const Scratch<AxisRates<Scalar>>& rates, Eigen::Index i,
                             Eigen::Index first, ForceRates<Scalar>& forces, const Matrices& out) {
  for (Eigen::Index j = i; j >= 0; --j) {
    const Joint& at = joint(chain, j);
    const Motion<Scalar> S = axisMotion<Scalar>(at);
    const auto& [first_rate, second_rate] = rates[j];
    out.q(i, j) = dot(first_rate, forces.turned) + dot(second_rate, forces.by_qdd);
    out.qd(i, j) = dot(S, forces.turned) + Scalar(2) * dot(first_rate, forces.by_qdd);
    out.qdd(i, j) = alongAxis(at, forces.by_qdd);
    if (j >= first) {
      out.q(j, i) = alongAxis(at, forces.by_q);
      out.qd(j, i) = alongAxis(at, forces.by_qd);
      out.qdd(j, i) = out.qdd(i, j);
    }
    forces.moveBy(X[j]);
  }
  out.qdd(i, i) += Scalar(joint(chain, i).rotor_inertia);
}

// Rows first..n-1 with one parameter set, from the links' motion.
template <typename Scalar, typename Matrices>
void derivativesOfMotion(const Chain& chain, const std::vector<LinkParameters>& links,
                         const Scratch<Transform<Scalar>>& X, const Scratch<Motion<Scalar>>& V,
                         const Scratch<Motion<Scalar>>& A, Eigen::Index first,
                         const Matrices& out) {
  Scratch<AxisRates<Scalar>> rates(chain.jointCount());
  axisRates(chain, V, A, rates);
  Block<Scalar> block;
  for (Eigen::Index i = chain.jointCount() - 1; i >= first; --i) {
    block.add(link<Scalar>(links, i), V[i], A[i]);
    ForceRates<Scalar> forces(block, joint(chain, i), rates[i]);
    derivativesUpToDiagonal(chain, X, rates, i, first, forces, out);
    block.moveBy(X[i]);
  }
}

// dtau_dq += dg/dq of one parameter set: the second derivatives of potential energy, symmetric.
template <typename Scalar, typename MatrixQ>
void addGravityDerivatives(const Chain& chain, const std::vector<LinkParameters>& links,
                           const Scratch<Transform<Scalar>>& X, MatrixQ& dtau_dq) {
  Scratch<Vector3<Scalar>> a(chain.jointCount());
  gravityInLinks(chain, X, a);
  Scalar m(0);
  Vector3<Scalar> mc = Vector3<Scalar>::Zero();
  for (Eigen::Index i = chain.jointCount() - 1; i >= 0; --i) {
    m += link<Scalar>(links, i).mass;
    mc += link<Scalar>(links, i).first_moment;

    // mass that joint i moves, times how it moves
    Vector3<Scalar> f(-mc.y(), mc.x(), Scalar(0));
    if (isPrismatic(joint(chain, i))) f = {Scalar(0), Scalar(0), m};
    for (Eigen::Index j = i; j >= 0; --j) {
      if (!isPrismatic(joint(chain, j))) {
        // a turn about z changes gravity, as the links feel it, by a x z
        const Scalar change = f.x() * a[j].y() - f.y() * a[j].x();
        dtau_dq(i, j) += change;
        if (j < i) dtau_dq(j, i) += change;
      }
      f = X[j].R * f;
    }
    mc = X[i].R * mc + m * X[i].p;
  }
}

}  // namespace internal

/// Derivatives of the joint torques: `dtau/dq`, `dtau/dqd` and `dtau/dqdd = H(q)`.
///
/// Recursion over blocks of links in link frames, exact, O(n^2) [Carpentier and Mansard 2018,
/// Robotics: Science and Systems; in this form Singh, Russell, Wensing 2022, arXiv 2105.05102].
/// Without friction: see addFrictionDerivatives() in model.hpp.
///
/// @tparam Scalar         (of all arguments) float, double or a dual number.
/// @param sets            ParameterSets [parameter_sets.hpp]; left out: chain.links().
/// @param q,qd,qdd        n each; rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2); order of
///                        chain.jointNames().
/// @param[out] dtau_dq    n x n: entry (i, j) is that of tau_i by q_j; N m/rad (prismatic N, m).
/// @param[out] dtau_dqd   n x n; N m s/rad (prismatic N, m).
/// @param[out] dtau_dqdd  n x n: H; kg m^2 (prismatic kg, mixed kg m).
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Sets, typename Q, typename Qd, typename Qdd, typename MatrixQ, typename MatrixQd,
          typename MatrixH>
void torqueDerivatives(const Chain& chain, const Sets& sets, const Eigen::MatrixBase<Q>& q,
                       const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<Qdd>& qdd,
                       const Eigen::MatrixBase<MatrixQ>& dtau_dq,
                       const Eigen::MatrixBase<MatrixQd>& dtau_dqd,
                       const Eigen::MatrixBase<MatrixH>& dtau_dqdd) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);
  Scratch<Motion<Scalar>> A(n);
  const auto out = internal::derivativeMatrices(chain, dtau_dq, dtau_dqd, dtau_dqdd);

  // gravity with its own parameters comes on top
  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);
  internal::linkAccelerations(chain, X, V, qd, qdd, internal::gravityOfMotion(chain, sets), A);
  const auto rows = [&](const std::vector<LinkParameters>& links, Eigen::Index first) {
    internal::derivativesOfMotion(chain, links, X, V, A, first, out);
  };
  internal::forEachSet(chain, sets, rows);
  if (const auto* own = internal::gravitySet(sets)) {
    internal::addGravityDerivatives(chain, *own, X, out.q);
  }
}
template <typename Q, typename Qd, typename Qdd, typename MatrixQ, typename MatrixQd,
          typename MatrixH>
void torqueDerivatives(const Chain& chain, const Eigen::MatrixBase<Q>& q,
                       const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<Qdd>& qdd,
                       const Eigen::MatrixBase<MatrixQ>& dtau_dq,
                       const Eigen::MatrixBase<MatrixQd>& dtau_dqd,
                       const Eigen::MatrixBase<MatrixH>& dtau_dqdd) {
  torqueDerivatives(chain, internal::OwnParameters(), q, qd, qdd, dtau_dq, dtau_dqd, dtau_dqdd);
}

}  // namespace v2
}  // namespace chain_dynamics

// SPDX-License-Identifier: Apache-2.0

/// @file
/// The Coriolis matrix C of Christoffel's symbols.
///
///     Eigen::MatrixXd C(chain.jointCount(), chain.jointCount());
///     coriolisMatrix(chain, q, qd, C);   // C qd is that of coriolisVector()
///
/// Many matrices have this product with qd. The one of Christoffel's symbols is
///
///     C_ij = sum of 1/2 (dH_ij/dq_k + dH_ik/dq_j - dH_jk/dq_i) qd_k        over k
///
/// and is the one for which dH/dt = C + C', so that dH/dt - 2 C is skew: observers and adaptive
/// control need that. Its sum is symmetric in j and k, so the derivative of the product finds each
/// term twice: d(C qd)_i / dqd_j = 2 C_ij. Half of a derivative of the torques, therefore, by the
/// argument of torque_derivatives.hpp. When joint j moves, all links after it, i among them, move
/// along as one block, which feels
///
///     velocity S_j:                  Coriolis' force on the flow of its mass  [mass_flow.hpp]
///     acceleration V_j x S_j:        I_c times it
///
/// and joint i, or j where i is before it, holds against the part along its axis.

#pragma once

#include <Eigen/Core>

#include "chain_dynamics/kinematics.hpp"
#include "chain_dynamics/mass_flow.hpp"
#include "chain_dynamics/parameter_sets.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace internal {

// Row i up to the diagonal, and column i of the rows from `first` to the diagonal; link i and all
// links after it have inertia I_c and flow. S_rate[j] is V_j x S_j.
template <typename Scalar, typename MatrixC>
void coriolisUpToDiagonal(const Chain& chain, const SpatialInertia<Scalar>& I_c,
                          const MassFlow<Scalar>& flow, const Scratch<Transform<Scalar>>& X,
                          const Scratch<Motion<Scalar>>& S_rate, Eigen::Index i, Eigen::Index first,
                          MatrixC& C) {
  const Scalar half(0.5);
  const Motion<Scalar> S_i = axisMotion<Scalar>(joint(chain, i));

  // what the block needs for joint i's motion; joint i's part of what it needs for any motion
  Force<Scalar> F = flow.coriolis(S_i.angular) * half + I_c * S_rate[i];
  Force<Scalar> inertial = timesAxis(I_c, joint(chain, i));
  Force<Scalar> coriolis = {flow.coriolisAlong(S_i) * half, Vector3<Scalar>::Zero()};
  for (Eigen::Index j = i; j >= 0; --j) {
    C(i, j) = alongAxis(joint(chain, j), coriolis) + dot(S_rate[j], inertial);
    if (j >= first && j < i) C(j, i) = alongAxis(joint(chain, j), F);

    // on to the parent link
    F = X[j] * F;
    inertial = X[j] * inertial;
    coriolis = {X[j].R * coriolis.moment, coriolis.force};
  }
}

// Rows first..n-1 with one parameter set, from the links' motion.
template <typename Scalar, typename MatrixC>
void coriolisOfMotion(const Chain& chain, const std::vector<LinkParameters>& links,
                      const Scratch<Transform<Scalar>>& X, const Scratch<Motion<Scalar>>& V,
                      Eigen::Index first, MatrixC& C) {
  const Eigen::Index n = chain.jointCount();
  Scratch<Motion<Scalar>> S_rate(n);
  for (Eigen::Index i = 0; i < n; ++i) S_rate[i] = cross(V[i], axisMotion<Scalar>(joint(chain, i)));
  SpatialInertia<Scalar> I_c = SpatialInertia<Scalar>::zero();
  MassFlow<Scalar> flow = MassFlow<Scalar>::zero();
  for (Eigen::Index i = n - 1; i >= first; --i) {
    const SpatialInertia<Scalar> I = link<Scalar>(links, i);
    I_c += I;
    flow += flowOf(I, V[i]);
    coriolisUpToDiagonal(chain, I_c, flow, X, S_rate, i, first, C);

    // on to the parent link
    I_c = X[i] * I_c;
    flow = X[i] * flow;
  }
}

}  // namespace internal

/// Coriolis matrix of Christoffel's symbols: `C(q, qd)`, with `dH/dt = C + C'`, which doesn't hold
/// for different sets for the rows.
///
/// Recursion over blocks of links in link frames, O(n^2) [Echeandia and Wensing 2021, Numerical
/// methods to compute the Coriolis matrix and Christoffel symbols for rigid-body systems, J. Comput.
/// Nonlinear Dynam. 16(9)].
///
/// @tparam Scalar  (of q, qd, C) float, double or a dual number.
/// @param sets     ParameterSets [parameter_sets.hpp]; left out: chain.links().
/// @param q,qd     n each; rad, rad/s (prismatic m, m/s); order of chain.jointNames().
/// @param[out] C   n x n; kg m^2/s (prismatic kg/s, mixed kg m/s).
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.
template <typename Sets, typename Q, typename Qd, typename MatrixC>
void coriolisMatrix(const Chain& chain, const Sets& sets, const Eigen::MatrixBase<Q>& q,
                    const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<MatrixC>& C) {
  using Scalar = typename Q::Scalar;
  const Eigen::Index n = chain.jointCount();
  assert(C.rows() == n && C.cols() == n && internal::haveSizesOf(chain, sets));
  Scratch<Transform<Scalar>> X(n);
  Scratch<Motion<Scalar>> V(n);

  internal::linkPoses(chain, q, X);
  internal::linkVelocities(chain, X, qd, V);
  const auto rows = [&](const std::vector<LinkParameters>& links, Eigen::Index first) {
    internal::coriolisOfMotion(chain, links, X, V, first, C.const_cast_derived());
  };
  internal::forEachSet(chain, sets, rows);
}
template <typename Q, typename Qd, typename MatrixC>
void coriolisMatrix(const Chain& chain, const Eigen::MatrixBase<Q>& q,
                    const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<MatrixC>& C) {
  coriolisMatrix(chain, internal::OwnParameters(), q, qd, C);
}

}  // namespace v2
}  // namespace chain_dynamics

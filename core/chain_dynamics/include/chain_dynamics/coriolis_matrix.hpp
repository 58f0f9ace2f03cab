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
/// term twice: d(C qd)_i / dqd_j = 2 C_ij. FastModel computes it by a recursion over blocks of links.

#pragma once

#include <Eigen/Core>
#include <cassert>

#include "chain_dynamics/coriolis_vector.hpp"
#include "chain_dynamics/dual.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Coriolis matrix of Christoffel's symbols: `C(q, qd)`, with `dH/dt = C + C'`, which doesn't hold
/// for different sets for the rows.
///
/// Half the derivative of coriolisVector() by the velocities, by dual numbers, O(n^2).
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
  assert(C.rows() == chain.jointCount() && C.cols() == chain.jointCount());
  const auto by_qd = [&](const auto& varied, auto& c) {
    coriolisVector(chain, sets, q.template cast<Dual<Scalar, 1>>(), varied, c);
  };
  differentiate(qd, by_qd, C);
  C.const_cast_derived() *= Scalar(0.5);
}
template <typename Q, typename Qd, typename MatrixC>
void coriolisMatrix(const Chain& chain, const Eigen::MatrixBase<Q>& q,
                    const Eigen::MatrixBase<Qd>& qd, const Eigen::MatrixBase<MatrixC>& C) {
  coriolisMatrix(chain, internal::OwnParameters(), q, qd, C);
}

}  // namespace v2
}  // namespace chain_dynamics

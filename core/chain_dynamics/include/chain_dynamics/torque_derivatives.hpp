// SPDX-License-Identifier: Apache-2.0

/// @file
/// Derivatives of inverse dynamics: how do the torques change with position, velocity,
/// acceleration?
///
///     Eigen::MatrixXd dtau_dq(n, n), dtau_dqd(n, n), H(n, n);
///     torqueDerivatives(chain, q, qd, qdd, dtau_dq, dtau_dqd, H);   // H = dtau/dqdd
///
/// FastModel computes the same by a recursion over blocks of links.

#pragma once

#include <Eigen/Core>
#include <cassert>

#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/inertia_matrix.hpp"
#include "chain_dynamics/torques.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Derivatives of the joint torques: `dtau/dq`, `dtau/dqd` and `dtau/dqdd = H(q)`.
///
/// The torques of dual numbers [dual.hpp], exact, O(n^2). Without friction: see addFrictionDerivatives() in model.hpp.
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
  using Number = Dual<typename Q::Scalar, 1>;
  [[maybe_unused]] const Eigen::Index n = chain.jointCount();
  assert(dtau_dq.rows() == n && dtau_dq.cols() == n);
  assert(dtau_dqd.rows() == n && dtau_dqd.cols() == n);
  const auto by_q = [&](const auto& varied, auto& tau) {
    torques(chain, sets, varied, qd, qdd, tau);
  };
  const auto by_qd = [&](const auto& varied, auto& tau) {
    torques(chain, sets, q.template cast<Number>(), varied, qdd, tau);
  };
  differentiate(q, by_q, dtau_dq);
  differentiate(qd, by_qd, dtau_dqd);
  inertiaMatrix(chain, sets, q, dtau_dqdd);
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

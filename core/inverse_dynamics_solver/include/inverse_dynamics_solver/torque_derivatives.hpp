// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability: how the torques change with position, velocity and acceleration.
///
///     if (const auto* derivatives = dynamic_cast<const TorqueDerivatives*>(solver.get())) {
///       const auto [dtau_dq, dtau_dqd, H] = derivatives->getTorqueDerivatives(q, qd, qdd);
///     }
#pragma once

#include <Eigen/Core>
#include <tuple>
#include <utility>

#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Exact derivatives of getTorques(), friction included unless it is switched off. Where a friction
/// law jumps (Coulomb friction at rest), its derivative is that beside the jump.
class TorqueDerivatives : public Capability {
 public:
  ~TorqueDerivatives() override;

  /// `dtau/dq` [N m/rad], `dtau/dqd` [N m s/rad], `dtau/dqdd = H` [kg m^2], n x n each (prismatic N
  /// instead of N m, m instead of rad): entry (i, j) is that of tau_i by joint j.
  std::tuple<Eigen::MatrixXd, Eigen::MatrixXd, Eigen::MatrixXd> getTorqueDerivatives(
      const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd) const {
    const Eigen::Index n = jointsFor("getTorqueDerivatives");
    Eigen::MatrixXd dtau_dq(n, n), dtau_dqd(n, n), dtau_dqdd(n, n);
    getTorqueDerivatives(q, qd, qdd, dtau_dq, dtau_dqd, dtau_dqdd);
    return {std::move(dtau_dq), std::move(dtau_dqd), std::move(dtau_dqdd)};
  }
  void getTorqueDerivatives(const ConstVectorRef& q, const ConstVectorRef& qd,
                            const ConstVectorRef& qdd, MatrixRef dtau_dq, MatrixRef dtau_dqd,
                            MatrixRef dtau_dqdd) const;

  /// Side by side, n x (n N) each.
  std::tuple<Eigen::MatrixXd, Eigen::MatrixXd, Eigen::MatrixXd> getTorqueDerivativesBatch(
      const ConstStatesRef& q, const ConstStatesRef& qd, const ConstStatesRef& qdd) const {
    const Eigen::Index n = q.joints;
    Eigen::MatrixXd dtau_dq(n, n * q.count), dtau_dqd(n, n * q.count), dtau_dqdd(n, n * q.count);
    getTorqueDerivativesBatch(q, qd, qdd, dtau_dq, dtau_dqd, dtau_dqdd);
    return {std::move(dtau_dq), std::move(dtau_dqd), std::move(dtau_dqdd)};
  }
  void getTorqueDerivativesBatch(const ConstStatesRef& q, const ConstStatesRef& qd,
                                 const ConstStatesRef& qdd, const StridedMatrices& dtau_dq,
                                 const StridedMatrices& dtau_dqd,
                                 const StridedMatrices& dtau_dqdd) const;

 protected:
  /// @name What a solver implements
  /// As the compute... of InverseDynamicsSolver; a batch by default one state after the other.
  /// @{
  virtual void computeTorqueDerivatives(const ConstVectorRef& q, const ConstVectorRef& qd,
                                        const ConstVectorRef& qdd, MatrixRef dtau_dq,
                                        MatrixRef dtau_dqd, MatrixRef dtau_dqdd) const = 0;
  virtual void computeTorqueDerivativesBatch(const ConstStates& q, const ConstStates& qd,
                                             const ConstStates& qdd, const StridedMatrices& dtau_dq,
                                             const StridedMatrices& dtau_dqd,
                                             const StridedMatrices& dtau_dqdd) const;
  /// @}
};

}  // namespace v2
}  // namespace inverse_dynamics_solver

// SPDX-License-Identifier: Apache-2.0
/// @file
/// A tree by workspaces of chains: the sums over its branches [chain_dynamics/mechanism.hpp].
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/spatial.hpp"
#include "inverse_dynamics_solver/external_wrench.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/pooled_solver.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Workspaces of the branches, whose tips are computed where these are TipWorkspaces.
class SumOfChains : public TipWorkspace {
 public:
  /// @param chains  one per branch.
  SumOfChains(std::shared_ptr<const std::vector<chain_dynamics::Branch>> branches,
              std::vector<std::unique_ptr<Workspace>> chains)
      : branches_(std::move(branches)), chains_(std::move(chains)) {}

  void inertiaMatrix(const ConstVectorRef& q, MatrixRef H) override;
  void coriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef c) override;
  void gravityVector(const ConstVectorRef& q, VectorRef g) override;
  void torques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
               VectorRef tau) override;
  void tipPose(std::size_t tip, const ConstVectorRef& q,
               chain_dynamics::Transform<double>& pose) override;
  void tipJacobian(std::size_t tip, const ConstVectorRef& q, MatrixRef J) override;
  void tipJacobianDerivative(std::size_t tip, const ConstVectorRef& q, const ConstVectorRef& qd,
                             MatrixRef dJ) override;
  void externalTorques(std::size_t tip, const ConstVectorRef& q, WrenchFrame frame,
                       const ConstVectorRef& wrench, VectorRef tau) override;

 private:
  Workspace& of(const chain_dynamics::Branch& branch) const {
    return *chains_[static_cast<std::size_t>(&branch - branches_->data())];
  }
  TipWorkspace& withTip(std::size_t tip) const { return static_cast<TipWorkspace&>(*chains_[tip]); }

  std::shared_ptr<const std::vector<chain_dynamics::Branch>> branches_;
  std::vector<std::unique_ptr<Workspace>> chains_;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver

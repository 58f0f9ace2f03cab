// SPDX-License-Identifier: Apache-2.0
/// @file
/// A tree by workspaces of chains: the sums over its branches [chain_dynamics/mechanism.hpp].
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
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
  /// @param n       number of coordinates.
  /// @param chains  one per branch.
  SumOfChains(Eigen::Index n, std::shared_ptr<const std::vector<chain_dynamics::Branch>> branches,
              std::vector<std::unique_ptr<Workspace>> chains);

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
  /// A branch with what its chain is given and gives.
  struct Part {
    const chain_dynamics::Branch& branch;
    std::unique_ptr<Workspace> chain;
    Eigen::VectorXd q, qd, qdd, tau;
    Eigen::MatrixXd H, J;

    TipWorkspace& withTip() const { return static_cast<TipWorkspace&>(*chain); }
    void setPositions(const ConstVectorRef& of_coordinates);
    void setMotion(const ConstVectorRef& of_coordinates, Eigen::VectorXd& of_joints) const;
  };

  std::shared_ptr<const std::vector<chain_dynamics::Branch>> branches_;
  std::vector<Part> parts_;
  Eigen::VectorXd sum_;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver

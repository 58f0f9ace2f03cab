// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/pooled_solver.hpp"

#include <Eigen/Cholesky>
#include <cstddef>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/friction.hpp"
#include "chain_dynamics/friction_laws/coefficients.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/model.hpp"
#include "chain_dynamics/spatial.hpp"
#include "chain_dynamics/text.hpp"
#include "inverse_dynamics_solver/configuration.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"
#include "sum_of_chains.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

/// The friction that a robot description states doesn't depend on load.
constexpr double kNoLoad = 0.0;

}  // namespace

auto PooledSolver::configure(const Configuration& configuration) -> JointInfo {
  // Everything that can fail comes first.
  refuseMotorsAndSprings(configuration);
  auto bare =
      std::make_unique<const chain_dynamics::Model>(mechanismFromDescription(configuration));
  const chain_dynamics::Chain& chain = bare->chain;
  const std::size_t max_threads = readMaxThreads(configuration);
  auto conditions = readConditions(configuration, chain.gravity());
  auto robot = robotOf(conditions->appliedTo(*bare), max_threads);
  const bool inertia_is_physical = bare->inertiaIsPhysical();
  JointInfo info{chain.jointNames(), chain.warnings(), chain.jointTypes()};
  std::vector<std::shared_ptr<const PooledTip>> tips;
  info.tip_names = chain_dynamics::tipNames(*bare);
  while (tips.size() < info.tip_names.size()) {
    tips.push_back(std::make_shared<const PooledTip>(*this, tips.size()));
  }
  DescriptionFriction friction = descriptionFriction(configuration, chain);
  info.warnings.insert(info.warnings.end(), friction.warnings.begin(), friction.warnings.end());
  std::vector<chain_dynamics::FrictionForm> laws;
  laws.reserve(friction.laws.size());
  for (const auto& law : friction.laws) laws.push_back(law.form());
  configuration.rejectOthers();

  // Nothing below can fail.
  beginWith(std::move(robot), std::move(conditions));
  bare_ = std::move(bare);
  tips_ = std::move(tips);
  max_threads_ = max_threads;
  friction_ = std::move(laws);
  inertia_is_physical_ = inertia_is_physical;
  return info;
}

auto PooledSolver::treeWorkspaceMaker(const chain_dynamics::Model& tree) const -> WorkspaceMaker {
  throw InvalidParameterValueException(
      "parameter 'tip'", "wrong value",
      "one link, without joints that mimic others, as the solver computes chains",
      (tree.branches.size() == 1 ? "a joint that mimics another, before " : "") +
          chain_dynamics::joined(chain_dynamics::tipNames(tree)),
      "name another tip, or take rigid_body_inverse_dynamics_solver");
}

auto PooledSolver::sumOfChains(const chain_dynamics::Model& tree) const -> WorkspaceMaker {
  std::vector<WorkspaceMaker> makers;
  makers.reserve(tree.branches.size());
  for (const chain_dynamics::Branch& branch : tree.branches) {
    makers.push_back(workspaceMaker(branch.chain));
  }
  return [branches = std::make_shared<const std::vector<chain_dynamics::Branch>>(tree.branches),
          makers] {
    std::vector<std::unique_ptr<Workspace>> chains;
    chains.reserve(makers.size());
    for (const WorkspaceMaker& make : makers) chains.push_back(make());
    return std::make_unique<SumOfChains>(branches, std::move(chains));
  };
}

auto PooledSolver::robotOf(const chain_dynamics::Model& model, std::size_t max_threads) const
    -> std::unique_ptr<const PooledRobot> {
  try {
    return std::make_unique<const PooledRobot>(
        PooledRobot{std::make_unique<WorkspacePool<Workspace>>(
            max_threads,
            model.branches.empty() ? workspaceMaker(model.chain) : treeWorkspaceMaker(model))});
  } catch (const std::bad_alloc&) {
    throw Exception("robot " + model.name, "no memory left",
                    "room for a workspace for each of max_threads",
                    std::to_string(model.chain.jointCount()) + " joints, max_threads " +
                        std::to_string(max_threads),
                    "set max_threads to what is used at the same time");
  }
}

auto PooledSolver::robotUnder(const Conditions& conditions) const
    -> std::unique_ptr<const PooledRobot> {
  return robotOf(conditions.appliedTo(*bare_), max_threads_);
}

void PooledSolver::computeInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const {
  borrow<Workspace>()->inertiaMatrix(q, H);
}

void PooledSolver::computeCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                                         VectorRef c) const {
  borrow<Workspace>()->coriolisVector(q, qd, c);
}

void PooledSolver::computeGravityVector(const ConstVectorRef& q, VectorRef g) const {
  borrow<Workspace>()->gravityVector(q, g);
}

void PooledSolver::computeFriction(const ConstVectorRef&, const ConstVectorRef& qd,
                                   VectorRef f) const {
  f.setZero();
  addFriction(qd, f);
}

void PooledSolver::addFriction(const ConstVectorRef& qd, VectorRef f) const {
  for (std::size_t j = 0; j < friction_.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    f[i] += chain_dynamics::friction(friction_[j], qd[i], kNoLoad);
  }
}

void PooledSolver::addFrictionSlopes(const ConstVectorRef& qd, MatrixRef dtau_dqd) const {
  for (std::size_t j = 0; j < friction_.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    dtau_dqd(i, i) += chain_dynamics::frictionSlope(friction_[j], qd[i], kNoLoad);
  }
}

void PooledSolver::computeDynamicComponents(const ConstVectorRef& q, const ConstVectorRef& qd,
                                            MatrixRef H, VectorRef c, VectorRef g) const {
  const auto workspace = borrow<Workspace>();
  workspace->inertiaMatrix(q, H);
  workspace->coriolisVector(q, qd, c);
  workspace->gravityVector(q, g);
}

void PooledSolver::computeTorques(const ConstVectorRef& q, const ConstVectorRef& qd,
                                  const ConstVectorRef& qdd, VectorRef tau) const {
  borrow<Workspace>()->torques(q, qd, qdd, tau);
  addFriction(qd, tau);
}

void PooledSolver::computeTreeAccelerations(const ConstVectorRef& q, const ConstVectorRef& qd,
                                            const ConstVectorRef& tau, VectorRef qdd) const {
  constexpr int kMost = chain_dynamics::kMostCoordinates;
  using Numbers = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMost, 1>;
  const Eigen::Index n = q.size();
  const Numbers at_rest = Numbers::Zero(n);
  Numbers rest(n);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMost, kMost> H(n, n);
  const auto workspace = borrow<Workspace>();
  workspace->torques(q, qd, at_rest, rest);
  addFriction(qd, rest);
  rest = tau - rest;
  workspace->inertiaMatrix(q, H);
  qdd = H.llt().solve(rest);
}

void PooledTip::computeTipPose(const ConstVectorRef& q,
                               chain_dynamics::Transform<double>& pose) const {
  solver_.borrow<TipWorkspace>()->tipPose(tip_, q, pose);
}

void PooledTip::computeTipJacobian(const ConstVectorRef& q, MatrixRef J) const {
  solver_.borrow<TipWorkspace>()->tipJacobian(tip_, q, J);
}

void PooledTip::computeTipJacobianDerivative(const ConstVectorRef& q, const ConstVectorRef& qd,
                                             MatrixRef dJ) const {
  solver_.borrow<TipWorkspace>()->tipJacobianDerivative(tip_, q, qd, dJ);
}

void PooledTip::computeExternalTorques(const ConstVectorRef& q, WrenchFrame frame,
                                       const ConstVectorRef& wrench, VectorRef tau) const {
  solver_.borrow<TipWorkspace>()->externalTorques(tip_, q, frame, wrench, tau);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver

// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/pooled_solver.hpp"

#include <cstddef>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/friction.hpp"
#include "chain_dynamics/friction_laws/coefficients.hpp"
#include "chain_dynamics/model.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {
namespace {

/// The friction that a robot description states doesn't depend on load.
constexpr double kNoLoad = 0.0;

}  // namespace

auto PooledSolver::configure(const Configuration& configuration) -> JointInfo {
  // Everything that can fail comes first.
  refuseMotorsAndSprings(configuration);
  auto bare = std::make_unique<const chain_dynamics::Model>(chainFromDescription(configuration));
  const chain_dynamics::Chain& chain = bare->chain;
  const std::size_t max_threads = readMaxThreads(configuration);
  auto conditions = readConditions(configuration, chain.gravity());
  auto robot = robotOf(conditions->appliedTo(*bare).chain, max_threads);
  const bool inertia_is_physical = bare->inertiaIsPhysical();
  JointInfo info{chain.jointNames(), chain.warnings(), chain.jointTypes()};
  DescriptionFriction friction = descriptionFriction(configuration, chain);
  info.warnings.insert(info.warnings.end(), friction.warnings.begin(), friction.warnings.end());
  std::vector<chain_dynamics::FrictionForm> laws;
  laws.reserve(friction.laws.size());
  for (const auto& law : friction.laws) laws.push_back(law.form());
  configuration.rejectOthers();

  // Nothing below can fail.
  beginWith(std::move(robot), std::move(conditions));
  bare_ = std::move(bare);
  max_threads_ = max_threads;
  friction_ = std::move(laws);
  inertia_is_physical_ = inertia_is_physical;
  return info;
}

auto PooledSolver::robotOf(const chain_dynamics::Chain& chain, std::size_t max_threads) const
    -> std::unique_ptr<const PooledRobot> {
  try {
    return std::make_unique<const PooledRobot>(PooledRobot{
        std::make_unique<WorkspacePool<Workspace>>(max_threads, workspaceMaker(chain))});
  } catch (const std::bad_alloc&) {
    throw Exception(
        "chain " + chain.name(), "no memory left", "room for a workspace for each of max_threads",
        std::to_string(chain.jointCount()) + " joints, max_threads " + std::to_string(max_threads),
        "set max_threads to what is used at the same time");
  }
}

auto PooledSolver::robotUnder(const Conditions& conditions) const
    -> std::unique_ptr<const PooledRobot> {
  return robotOf(conditions.appliedTo(*bare_).chain, max_threads_);
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

}  // namespace v2
}  // namespace inverse_dynamics_solver

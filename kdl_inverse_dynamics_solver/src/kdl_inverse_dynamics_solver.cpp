// SPDX-License-Identifier: Apache-2.0
#include "kdl_inverse_dynamics_solver/kdl_inverse_dynamics_solver.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>

#include "chain_dynamics/model.hpp"
#include "kdl_chain.hpp"
#include "workspace.hpp"

namespace kdl_inverse_dynamics_solver {
namespace {

constexpr std::int64_t kMostThreads = 4096;

std::size_t readMaxThreads(const Configuration& configuration) {
  // A thread that is interrupted within a call keeps its workspace: more than one per processor is
  // needed.
  const std::int64_t standard = std::max<std::int64_t>(16, std::thread::hardware_concurrency());
  const auto threads = configuration.get<std::int64_t>("max_threads").value_or(standard);
  if (threads < 1 || threads > kMostThreads) {
    throw inverse_dynamics_solver::InvalidParameterValueException(
        inverse_dynamics_solver::errorText(
            "parameter '" + configuration.fullName("max_threads") + "'", "wrong value",
            "1 to " + std::to_string(kMostThreads), std::to_string(threads),
            "give the number of threads that compute at the same time"));
  }
  return static_cast<std::size_t>(threads);
}

}  // namespace

InverseDynamicsSolverKDL::InverseDynamicsSolverKDL() = default;
InverseDynamicsSolverKDL::~InverseDynamicsSolverKDL() = default;

auto InverseDynamicsSolverKDL::configure(const Configuration& configuration) -> JointInfo {
  // Everything that can fail, aside.
  const chain_dynamics::Chain chain = chainFromDescription(configuration);
  const std::size_t threads = readMaxThreads(configuration);
  auto pool = std::make_unique<WorkspacePool>(toKdl(chain), toKdl(chain.gravity()), threads);
  const bool inertia_is_physical = chain_dynamics::Model(chain).inertiaIsPhysical();
  JointInfo info{chain.jointNames(), chain.warnings()};

  // Nothing below can fail.
  pool_ = std::move(pool);
  inertia_is_physical_ = inertia_is_physical;
  return info;
}

void InverseDynamicsSolverKDL::computeInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const {
  pool_->acquire()->inertiaMatrix(q, H);
}

void InverseDynamicsSolverKDL::computeCoriolisVector(const ConstVectorRef& q,
                                                     const ConstVectorRef& qd, VectorRef c) const {
  pool_->acquire()->coriolisVector(q, qd, c);
}

void InverseDynamicsSolverKDL::computeGravityVector(const ConstVectorRef& q, VectorRef g) const {
  pool_->acquire()->gravityVector(q, g);
}

void InverseDynamicsSolverKDL::computeDynamicComponents(const ConstVectorRef& q,
                                                        const ConstVectorRef& qd, MatrixRef H,
                                                        VectorRef c, VectorRef g) const {
  const WorkspacePool::Lease workspace = pool_->acquire();
  workspace->inertiaMatrix(q, H);
  workspace->coriolisVector(q, qd, c);
  workspace->gravityVector(q, g);
}

void InverseDynamicsSolverKDL::computeTorques(const ConstVectorRef& q, const ConstVectorRef& qd,
                                              const ConstVectorRef& qdd, VectorRef tau) const {
  pool_->acquire()->torques(q, qd, qdd, tau);
}

}  // namespace kdl_inverse_dynamics_solver

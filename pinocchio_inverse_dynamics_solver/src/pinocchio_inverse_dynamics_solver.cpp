// SPDX-License-Identifier: Apache-2.0
#include "pinocchio_inverse_dynamics_solver/pinocchio_inverse_dynamics_solver.hpp"

#include <utility>

#include "chain_dynamics/model.hpp"
#include "pinocchio_model.hpp"
#include "workspace.hpp"

namespace pinocchio_inverse_dynamics_solver {

InverseDynamicsSolverPinocchio::InverseDynamicsSolverPinocchio() = default;
InverseDynamicsSolverPinocchio::~InverseDynamicsSolverPinocchio() = default;

auto InverseDynamicsSolverPinocchio::configure(const Configuration& configuration) -> JointInfo {
  // Everything that can fail, aside.
  const chain_dynamics::Chain chain = chainFromDescription(configuration);
  auto models = std::make_shared<const Models>(
      Models{toPinocchio(chain), toPinocchio(chain.withGravity(Eigen::Vector3d::Zero()))});
  auto pool = std::make_unique<Pool>(readMaxThreads(configuration),
                                     [models] { return std::make_unique<Workspace>(models); });
  const bool inertia_is_physical = chain_dynamics::Model(chain).inertiaIsPhysical();
  JointInfo info{chain.jointNames(), chain.warnings()};

  // Nothing below can fail.
  pool_ = std::move(pool);
  inertia_is_physical_ = inertia_is_physical;
  return info;
}

void InverseDynamicsSolverPinocchio::computeInertiaMatrix(const ConstVectorRef& q,
                                                          MatrixRef H) const {
  pool_->acquire()->inertiaMatrix(q, H);
}

void InverseDynamicsSolverPinocchio::computeCoriolisVector(const ConstVectorRef& q,
                                                           const ConstVectorRef& qd,
                                                           VectorRef c) const {
  pool_->acquire()->coriolisVector(q, qd, c);
}

void InverseDynamicsSolverPinocchio::computeGravityVector(const ConstVectorRef& q,
                                                          VectorRef g) const {
  pool_->acquire()->gravityVector(q, g);
}

void InverseDynamicsSolverPinocchio::computeDynamicComponents(const ConstVectorRef& q,
                                                              const ConstVectorRef& qd, MatrixRef H,
                                                              VectorRef c, VectorRef g) const {
  const auto workspace = pool_->acquire();
  workspace->inertiaMatrix(q, H);
  workspace->coriolisVector(q, qd, c);
  workspace->gravityVector(q, g);
}

void InverseDynamicsSolverPinocchio::computeTorques(const ConstVectorRef& q,
                                                    const ConstVectorRef& qd,
                                                    const ConstVectorRef& qdd,
                                                    VectorRef tau) const {
  pool_->acquire()->torques(q, qd, qdd, tau);
}

}  // namespace pinocchio_inverse_dynamics_solver

// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/tip_regressor.hpp"

#include <chain_dynamics/spatial.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <inverse_dynamics_solver/variable_gravity.hpp>
#include <memory>
#include <string>
#include <utility>

#include "chain_dynamics/regressor.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::InverseDynamicsSolver;
using Vector6 = Eigen::Matrix<double, 6, 1>;

template <class Capability>
const Capability& capabilityOf(const InverseDynamicsSolver* solver, const char* name) {
  if (solver == nullptr) {
    throw InvalidParameterValueException("payload: solver", "missing", "an initialized solver",
                                         "none", "load one with SolverLoader");
  }
  const auto* const capability = dynamic_cast<const Capability*>(solver);
  if (capability == nullptr) {
    throw InvalidParameterValueException("payload: solver", "it can't tell how the tip moves",
                                         std::string("a solver with the capability ") + name,
                                         "one without it", "use one of this project's solvers");
  }
  return *capability;
}

}  // namespace

TipRegressor::TipRegressor(std::shared_ptr<const InverseDynamicsSolver> solver)
    : solver_(std::move(solver)),
      kinematics_(&capabilityOf<inverse_dynamics_solver::Kinematics>(solver_.get(), "Kinematics")) {
  const auto& base =
      capabilityOf<inverse_dynamics_solver::VariableGravity>(solver_.get(), "VariableGravity");
  gravity_ = base.gravity() - base.baseAcceleration();
  J_ = Eigen::MatrixXd::Zero(6, solver_->jointCount());
  dJ_ = J_;
}

void TipRegressor::compute(const inverse_dynamics_solver::ConstVectorRef& q,
                           const inverse_dynamics_solver::ConstVectorRef& qd,
                           const inverse_dynamics_solver::ConstVectorRef& qdd,
                           inverse_dynamics_solver::MatrixRef Y) {
  chain_dynamics::Transform<double> X_0t;
  kinematics_->getTipPose(q, X_0t);
  kinematics_->getTipJacobian(q, J_);
  kinematics_->getTipJacobianDerivative(q, qd, dJ_);
  Vector6 velocity, acceleration;
  velocity.noalias() = J_.lazyProduct(qd);
  acceleration.noalias() = J_.lazyProduct(qdd) + dJ_.lazyProduct(qd);

  // Motion of the tip frame in its own axes. Its origin's acceleration is the classical one, so the
  // linear velocity, which would make the spatial one of it, is left at zero.
  const Eigen::Matrix3d R_t0 = X_0t.R.transpose();
  const chain_dynamics::Motion<double> V{R_t0 * velocity.tail<3>(), Eigen::Vector3d::Zero()};
  const chain_dynamics::Motion<double> A{R_t0 * acceleration.tail<3>(),
                                         R_t0 * (acceleration.head<3>() - gravity_)};

  // tau = J' [R f; R n] of the force that a unit of each parameter needs
  Eigen::Matrix<double, 6, 10> F_0;
  for (Eigen::Index column = 0; column < 10; ++column) {
    const auto I = chain_dynamics::SpatialInertia<double>::fromVector(
        chain_dynamics::Vector10<double>::Unit(column));
    const chain_dynamics::Force<double> F = I * A + cross(V, I * V);
    F_0.col(column).head<3>().noalias() = X_0t.R * F.force;
    F_0.col(column).tail<3>().noalias() = X_0t.R * F.moment;
  }
  Y.noalias() = J_.transpose().lazyProduct(F_0);
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

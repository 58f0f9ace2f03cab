// SPDX-License-Identifier: Apache-2.0
/// @file
/// What one thread computes with: Pinocchio's data of a model.
#pragma once

#include <memory>

#include "chain_dynamics/spatial.hpp"
#include "inverse_dynamics_solver/external_wrench.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/pooled_solver.hpp"
#include "pinocchio_headers.hpp"

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::MatrixRef;
using inverse_dynamics_solver::VectorRef;
using inverse_dynamics_solver::WrenchFrame;

/// A model that all threads read.
struct Models {
  Model with_gravity;
  Model without_gravity;
};

/// Pinocchio's data and all that is written to. One thread at a time.
class PinocchioWorkspace : public inverse_dynamics_solver::Workspace {
 public:
  explicit PinocchioWorkspace(std::shared_ptr<const Models> models);

  void inertiaMatrix(const ConstVectorRef& q, MatrixRef H) override;
  void coriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd, VectorRef c) override;
  void gravityVector(const ConstVectorRef& q, VectorRef g) override;
  void torques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
               VectorRef tau) override;

  /// @name As the compute... of the capabilities, without friction
  /// @{
  void tipPose(const ConstVectorRef& q, chain_dynamics::Transform<double>& pose);
  void tipJacobian(const ConstVectorRef& q, MatrixRef J);
  void tipJacobianDerivative(const ConstVectorRef& q, const ConstVectorRef& qd, MatrixRef dJ);
  void externalTorques(const ConstVectorRef& q, WrenchFrame frame, const ConstVectorRef& wrench,
                       VectorRef tau);
  void coriolisMatrix(const ConstVectorRef& q, const ConstVectorRef& qd, MatrixRef C);
  double kineticEnergy(const ConstVectorRef& q, const ConstVectorRef& qd);
  double potentialEnergy(const ConstVectorRef& q);
  void torqueDerivatives(const ConstVectorRef& q, const ConstVectorRef& qd,
                         const ConstVectorRef& qdd, MatrixRef dtau_dq, MatrixRef dtau_dqd,
                         MatrixRef dtau_dqdd);
  void regressor(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                 MatrixRef Y);
  void accelerations(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& tau,
                     VectorRef qdd);
  /// @}

 private:
  const Model& model() const { return models_->with_gravity; }
  pinocchio::FrameIndex tip() const { return model().frames.size() - 1; }

  std::shared_ptr<const Models> models_;
  Data data_;
  Data::Matrix6x jacobian_;
  Eigen::VectorXd zero_;
};

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver

// SPDX-License-Identifier: Apache-2.0
/// @file
/// What one thread computes with: Pinocchio's data of a model.
#pragma once

#include <cstddef>
#include <memory>

#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/spatial.hpp"
#include "inverse_dynamics_solver/external_wrench.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/pooled_solver.hpp"
#include "pinocchio_headers.hpp"
#include "pinocchio_model.hpp"

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::MatrixRef;
using inverse_dynamics_solver::VectorRef;
using inverse_dynamics_solver::WrenchFrame;

/// Pinocchio's data and all that is written to. One thread at a time.
class PinocchioWorkspace : public inverse_dynamics_solver::TipWorkspace {
 public:
  explicit PinocchioWorkspace(std::shared_ptr<const Models> models);

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

  /// @name As the compute... of the capabilities, without friction
  /// @{
  void coriolisMatrix(const ConstVectorRef& q, const ConstVectorRef& qd, MatrixRef C);
  double kineticEnergy(const ConstVectorRef& q, const ConstVectorRef& qd);
  double potentialEnergy(const ConstVectorRef& q);
  void torqueDerivatives(const ConstVectorRef& q, const ConstVectorRef& qd,
                         const ConstVectorRef& qdd, MatrixRef dtau_dq, MatrixRef dtau_dqd,
                         MatrixRef dtau_dqdd);
  Eigen::Index linkCount() const { return model().nv; }
  void regressor(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                 MatrixRef Y);
  /// Of a chain.
  void accelerations(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& tau,
                     VectorRef qdd);
  /// @}

 private:
  const Model& model() const { return models_->with_gravity; }
  /// The first frame is Pinocchio's own.
  static pinocchio::FrameIndex frameOf(std::size_t tip) { return tip + 1; }
  bool isChain() const { return models_->S.empty(); }

  /// @name Of the joints, from the coordinates
  /// @{
  ConstVectorRef positions(const ConstVectorRef& q);
  ConstVectorRef motion(const ConstVectorRef& x, Eigen::VectorXd& memory) const;
  /// @}

  /// @name Of the coordinates, from the joints
  /// @{
  void write(const Eigen::VectorXd& of_joints, VectorRef tau) const;
  template <class Matrix>
  void writeMatrix(const Matrix& of_joints, MatrixRef H) const;
  void writeJacobian(MatrixRef J) const;
  /// To write to: Pinocchio leaves out joints that don't move the tip.
  Data::Matrix6x& emptyJacobian() {
    if (!isChain()) jacobian_.setZero();
    return jacobian_;
  }
  /// data_.M, of which the upper triangle alone is computed.
  void writeInertia(MatrixRef H) const;
  /// @}

  std::shared_ptr<const Models> models_;
  Data data_;
  Data::Matrix6x jacobian_;
  Eigen::VectorXd zero_;
  Eigen::VectorXd q_, qd_, qdd_, tau_;  // of a tree's joints
};

template <class Matrix>
void PinocchioWorkspace::writeMatrix(const Matrix& of_joints, MatrixRef H) const {
  if (isChain()) {
    H = of_joints;
    return;
  }
  H.setZero();
  addMatrix(models_->S, of_joints, H);
}

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver

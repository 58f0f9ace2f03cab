// SPDX-License-Identifier: Apache-2.0
/// @file
/// A planar arm with two joints about the y axis and a point mass at the end of each link, in
/// closed form; it hangs down at q = 0. With the parameter `fault` it breaks one promise or law:
/// what the conformance tests must find.
#pragma once

#include <atomic>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/spatial.hpp>
#include <memory>
#include <string>

#include "inverse_dynamics_solver/coriolis_matrix.hpp"
#include "inverse_dynamics_solver/energies.hpp"
#include "inverse_dynamics_solver/external_wrench.hpp"
#include "inverse_dynamics_solver/forward_dynamics.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/kinematics.hpp"
#include "inverse_dynamics_solver/motor_currents.hpp"
#include "inverse_dynamics_solver/regressor.hpp"
#include "inverse_dynamics_solver/torque_derivatives.hpp"

namespace two_link_solver {

using namespace inverse_dynamics_solver;

class TwoLinkSolver : public InverseDynamicsSolver,
                      public MotorCurrents,
                      public Kinematics,
                      public ExternalWrench,
                      public CoriolisMatrix,
                      public Energies,
                      public TorqueDerivatives,
                      public Regressor,
                      public ForwardDynamics {
 public:
  using ExternalWrench::getTorques;
  using ExternalWrench::getTorquesBatch;
  using InverseDynamicsSolver::getTorques;
  using InverseDynamicsSolver::getTorquesBatch;

 protected:
  JointInfo configure(const Configuration& configuration) override;
  void computeInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const override;
  void computeCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                             VectorRef c) const override;
  void computeGravityVector(const ConstVectorRef& q, VectorRef g) const override;
  void computeFriction(const ConstVectorRef& q, const ConstVectorRef& qd,
                       VectorRef f) const override;
  void computeDynamicComponents(const ConstVectorRef& q, const ConstVectorRef& qd, MatrixRef H,
                                VectorRef c, VectorRef g) const override;
  void computeTorques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                      VectorRef tau) const override;
  void computeTorquesBatch(const ConstStates& q, const ConstStates& qd, const ConstStates& qdd,
                           const States& tau) const override;
  bool inertiaIsPhysicalImpl() const override { return true; }

  const InverseDynamicsSolver& torqueSolver() const override { return *this; }
  Gains driveGains() const override;
  void computeTipPose(const ConstVectorRef& q,
                      chain_dynamics::Transform<double>& pose) const override;
  void computeTipJacobian(const ConstVectorRef& q, MatrixRef J) const override;
  void computeTipJacobianDerivative(const ConstVectorRef& q, const ConstVectorRef& qd,
                                    MatrixRef dJ) const override;
  void computeExternalTorques(const ConstVectorRef& q, WrenchFrame frame,
                              const ConstVectorRef& wrench, VectorRef tau) const override;
  void computeCoriolisMatrix(const ConstVectorRef& q, const ConstVectorRef& qd,
                             MatrixRef C) const override;
  bool hasEnergiesImpl() const override { return !has("energies are refused without a reason"); }
  double computeKineticEnergy(const ConstVectorRef& q, const ConstVectorRef& qd) const override;
  double computePotentialEnergy(const ConstVectorRef& q) const override;
  void computeTorqueDerivatives(const ConstVectorRef& q, const ConstVectorRef& qd,
                                const ConstVectorRef& qdd, MatrixRef dtau_dq, MatrixRef dtau_dqd,
                                MatrixRef dtau_dqdd) const override;
  void computeRegressor(const ConstVectorRef& q, const ConstVectorRef& qd,
                        const ConstVectorRef& qdd, MatrixRef Y) const override;
  void computeAccelerations(const ConstVectorRef& q, const ConstVectorRef& qd,
                            const ConstVectorRef& tau, VectorRef qdd) const override;

 private:
  bool has(const char* fault) const { return fault_ == fault; }

  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();
  bool friction_ = true;
  std::unique_ptr<const chain_dynamics::Chain> chain_;
  mutable std::string fault_;                // mutable for the fault that allocates
  mutable std::atomic<double> shared_{0.0};  // for the fault that isn't thread-safe
};

}  // namespace two_link_solver

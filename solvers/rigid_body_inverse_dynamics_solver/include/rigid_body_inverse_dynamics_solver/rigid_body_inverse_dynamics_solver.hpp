// SPDX-License-Identifier: Apache-2.0
/// @file
/// Inverse dynamics of any serial robot or tree, from a URDF or from a model file, by the engine
/// chain_dynamics.
///
///     auto solver = SolverLoader().load(
///         "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody");
///     solver->initialize({{"tip", "tool0"}}, "", urdf);           // rigid bodies of a URDF
///     solver->initialize({{"model", "franka_gaz2019_feasible"}});   // a model file
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/model.hpp"
#include "chain_dynamics/spatial.hpp"
#include "chain_dynamics/states.hpp"
#include "inverse_dynamics_solver/changeable_robot.hpp"
#include "inverse_dynamics_solver/configuration.hpp"
#include "inverse_dynamics_solver/coriolis_matrix.hpp"
#include "inverse_dynamics_solver/energies.hpp"
#include "inverse_dynamics_solver/external_wrench.hpp"
#include "inverse_dynamics_solver/forward_dynamics.hpp"
#include "inverse_dynamics_solver/friction_memory.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/kinematics.hpp"
#include "inverse_dynamics_solver/load_friction.hpp"
#include "inverse_dynamics_solver/regressor.hpp"
#include "inverse_dynamics_solver/torque_derivatives.hpp"
#include "inverse_dynamics_solver/torque_deviation.hpp"

namespace rigid_body_inverse_dynamics_solver {
inline namespace v2 {

using inverse_dynamics_solver::Configuration;
using inverse_dynamics_solver::ConstStates;
using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::MatrixRef;
using inverse_dynamics_solver::States;
using inverse_dynamics_solver::StridedMatrices;
using inverse_dynamics_solver::VectorRef;
using inverse_dynamics_solver::WrenchFrame;

/// A model made ready to compute with.
struct ReadyModel {
  explicit ReadyModel(chain_dynamics::Model of) : model(std::move(of)), fast(model) {}

  /// With the kernels of another one, without comparing them again.
  ReadyModel(chain_dynamics::Model of, const ReadyModel& original)
      : model(std::move(of)), fast(model, original.fast) {}

  chain_dynamics::Model model;
  chain_dynamics::FastModel fast;
};

/// Kinematics and wrenches of one tip of a tree, by its branch, and the torques of the solver.
class RigidBodyTip : public inverse_dynamics_solver::Kinematics,
                     public inverse_dynamics_solver::ExternalWrench {
 public:
  RigidBodyTip(const inverse_dynamics_solver::InverseDynamicsSolver& solver,
               chain_dynamics::Branch branch)
      : solver_(solver), branch_(std::move(branch)), fast_(chain_dynamics::Model(branch_.chain)) {}

 protected:
  const inverse_dynamics_solver::InverseDynamicsSolver& torqueSolver() const override {
    return solver_;
  }
  const inverse_dynamics_solver::Kinematics& kinematicsOfTip(std::size_t tip) const override;
  const inverse_dynamics_solver::ExternalWrench& externalWrenchAtTip(
      std::size_t tip) const override;
  void computeTipPose(const ConstVectorRef& q,
                      chain_dynamics::Transform<double>& pose) const override;
  void computeTipJacobian(const ConstVectorRef& q, MatrixRef J) const override;
  void computeTipJacobianDerivative(const ConstVectorRef& q, const ConstVectorRef& qd,
                                    MatrixRef dJ) const override;
  void computeExternalTorques(const ConstVectorRef& q, WrenchFrame frame,
                              const ConstVectorRef& wrench, VectorRef tau) const override;

 private:
  const inverse_dynamics_solver::InverseDynamicsSolver& solver_;
  chain_dynamics::Branch branch_;
  chain_dynamics::FastModel fast_;  // of the branch's chain
};

/// The engine as a solver.
///
/// Parameters in addition to those of every solver [configuration.hpp]: bodies at the tip
/// [payload.hpp]; `model`, a string, the path of a model file or the name of one in the package
/// inverse_dynamics_robots; empty by default: the robot description (URDF).
///
/// A model file takes precedence over a robot description, which a node often carries for other
/// programs. It states geometry, inertia, gravity, friction and drive gains itself; then `gravity`
/// replaces the file's only where it is given, and each of `springs` the file's of its joint. `root`,
/// `tip`, `attached`, `locked_joints`, `allow_massless`, `urdf_friction`, `rotor_inertia` and `motors`
/// have no meaning, and bodies that the description attaches to the model's joints aren't included:
/// warnings() lists what was given in vain.
///
/// Without a model file, friction is that of the description where `urdf_friction` is true, else
/// zero.
///
/// Chains of up to 64 joints; with several tips, or joints that mimic others, trees of up to 64
/// coordinates and 128 joints [chain_dynamics/mechanism.hpp].
///
/// Capabilities: all of rigid bodies; accelerations are refused where the inertia isn't physical,
/// energies where rows have parameters of their own. TorqueDeviation: of a model file that states it.
///
/// Real time and threads: as the base class promises.
class InverseDynamicsSolverRigidBody : public inverse_dynamics_solver::InverseDynamicsSolver,
                                       public inverse_dynamics_solver::ChangeableRobot<ReadyModel>,
                                       public inverse_dynamics_solver::Kinematics,
                                       public inverse_dynamics_solver::ExternalWrench,
                                       public inverse_dynamics_solver::CoriolisMatrix,
                                       public inverse_dynamics_solver::Energies,
                                       public inverse_dynamics_solver::TorqueDerivatives,
                                       public inverse_dynamics_solver::Regressor,
                                       public inverse_dynamics_solver::ForwardDynamics,
                                       public inverse_dynamics_solver::LoadFriction,
                                       public inverse_dynamics_solver::FrictionMemory,
                                       public inverse_dynamics_solver::TorqueDeviation {
 public:
  using ExternalWrench::getTorques;
  using ExternalWrench::getTorquesBatch;
  using InverseDynamicsSolver::getTorques;
  using InverseDynamicsSolver::getTorquesBatch;

 protected:
  JointInfo configure(const Configuration& configuration) override;

  /// For solvers of one particular robot: computes with this model from now on, with gravity and
  /// friction as the configuration says. Warns of parameters without meaning, and of bodies in the
  /// robot description that the model doesn't include. All or nothing, as configure().
  JointInfo use(chain_dynamics::Model model, const Configuration& configuration);

  /// The model of the bare robot, without payloads; only after a successful initialize().
  const chain_dynamics::Model& model() const { return *model_; }

  const InverseDynamicsSolver& torqueSolver() const override { return *this; }

  void computeInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const override {
    withCurrentRobot([&](const ReadyModel& robot) {
      robot.fast.inertiaMatrix(q.data(), H.data(), H.outerStride());
    });
  }
  void computeCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                             VectorRef c) const override {
    withCurrentRobot(
        [&](const ReadyModel& robot) { robot.fast.coriolisVector(q.data(), qd.data(), c.data()); });
  }
  void computeGravityVector(const ConstVectorRef& q, VectorRef g) const override {
    withCurrentRobot(
        [&](const ReadyModel& robot) { robot.fast.gravityVector(q.data(), g.data()); });
  }
  void computeFriction(const ConstVectorRef& q, const ConstVectorRef& qd,
                       VectorRef f) const override {
    withCurrentRobot(
        [&](const ReadyModel& robot) { robot.fast.frictionVector(q.data(), qd.data(), f.data()); });
  }
  void computeDynamicComponents(const ConstVectorRef& q, const ConstVectorRef& qd, MatrixRef H,
                                VectorRef c, VectorRef g) const override {
    withCurrentRobot([&](const ReadyModel& robot) {
      robot.fast.dynamicComponents(q.data(), qd.data(), H.data(), H.outerStride(), c.data(),
                                   g.data());
    });
  }
  void computeTorques(const ConstVectorRef& q, const ConstVectorRef& qd, const ConstVectorRef& qdd,
                      VectorRef tau) const override {
    withCurrentRobot([&](const ReadyModel& robot) {
      robot.fast.torques(q.data(), qd.data(), qdd.data(), tau.data());
    });
  }

  // The states of a batch belong to one robot, so it is read once.
  void computeInertiaMatrixBatch(const ConstStates& q, const StridedMatrices& H) const override {
    currentRobot()->fast.inertiaMatrixBatch(q, H);
  }
  void computeCoriolisVectorBatch(const ConstStates& q, const ConstStates& qd,
                                  const States& c) const override {
    currentRobot()->fast.coriolisVectorBatch(q, qd, c);
  }
  void computeFrictionBatch(const ConstStates& q, const ConstStates& qd,
                            const States& f) const override {
    currentRobot()->fast.frictionVectorBatch(q, qd, f);
  }
  void computeGravityVectorBatch(const ConstStates& q, const States& g) const override {
    currentRobot()->fast.gravityVectorBatch(q, g);
  }
  void computeDynamicComponentsBatch(const ConstStates& q, const ConstStates& qd,
                                     const StridedMatrices& H, const States& c,
                                     const States& g) const override {
    currentRobot()->fast.dynamicComponentsBatch(q, qd, H, c, g);
  }
  void computeTorquesBatch(const ConstStates& q, const ConstStates& qd, const ConstStates& qdd,
                           const States& tau) const override {
    currentRobot()->fast.torquesBatch(q, qd, qdd, tau);
  }

  /// @name Capabilities
  /// @{

  // Payload and gravity change nothing about the tip: any robot will do.
  void computeTipPose(const ConstVectorRef& q,
                      chain_dynamics::Transform<double>& pose) const override {
    initialRobot().fast.tipPose(q.data(), pose.R.data(), pose.p.data());
  }
  void computeTipJacobian(const ConstVectorRef& q, MatrixRef J) const override {
    initialRobot().fast.tipJacobian(q.data(), J.data(), J.outerStride());
  }
  void computeTipJacobianDerivative(const ConstVectorRef& q, const ConstVectorRef& qd,
                                    MatrixRef dJ) const override {
    initialRobot().fast.tipJacobianDerivative(q.data(), qd.data(), dJ.data(), dJ.outerStride());
  }
  void computeTipPoseBatch(const ConstStates& q, const StridedMatrices& R,
                           const States& p) const override {
    initialRobot().fast.tipPoseBatch(q, R, p);
  }
  void computeTipJacobianBatch(const ConstStates& q, const StridedMatrices& J) const override {
    initialRobot().fast.tipJacobianBatch(q, J);
  }
  void computeTipJacobianDerivativeBatch(const ConstStates& q, const ConstStates& qd,
                                         const StridedMatrices& dJ) const override {
    initialRobot().fast.tipJacobianDerivativeBatch(q, qd, dJ);
  }
  const inverse_dynamics_solver::Kinematics& kinematicsOfTip(std::size_t tip) const override {
    return tip == 0 ? static_cast<const Kinematics&>(*this) : *other_tips_[tip - 1];
  }
  const inverse_dynamics_solver::ExternalWrench& externalWrenchAtTip(
      std::size_t tip) const override {
    return tip == 0 ? static_cast<const ExternalWrench&>(*this) : *other_tips_[tip - 1];
  }
  void computeExternalTorques(const ConstVectorRef& q, WrenchFrame frame,
                              const ConstVectorRef& wrench, VectorRef tau) const override;
  void computeExternalTorquesBatch(const ConstStates& q, WrenchFrame frame,
                                   const ConstStates& wrenches, const States& tau) const override;

  void computeCoriolisMatrix(const ConstVectorRef& q, const ConstVectorRef& qd,
                             MatrixRef C) const override {
    currentRobot()->fast.coriolisMatrix(q.data(), qd.data(), C.data(), C.outerStride());
  }
  double computeKineticEnergy(const ConstVectorRef& q, const ConstVectorRef& qd) const override {
    return chain_dynamics::kineticEnergy(currentRobot()->model, q, qd);
  }
  double computePotentialEnergy(const ConstVectorRef& q) const override {
    return chain_dynamics::potentialEnergy(currentRobot()->model, q);
  }
  void computeTorqueDerivatives(const ConstVectorRef& q, const ConstVectorRef& qd,
                                const ConstVectorRef& qdd, MatrixRef dtau_dq, MatrixRef dtau_dqd,
                                MatrixRef dtau_dqdd) const override;
  Eigen::Index linkCountImpl() const override { return initialRobot().fast.linkCount(); }
  void computeRegressor(const ConstVectorRef& q, const ConstVectorRef& qd,
                        const ConstVectorRef& qdd, MatrixRef Y) const override {
    currentRobot()->fast.regressor(q.data(), qd.data(), qdd.data(), Y.data(), Y.outerStride());
  }
  void computeAccelerations(const ConstVectorRef& q, const ConstVectorRef& qd,
                            const ConstVectorRef& tau, VectorRef qdd) const override {
    currentRobot()->fast.forwardDynamics(q.data(), qd.data(), tau.data(), qdd.data());
  }
  void computeCoriolisMatrixBatch(const ConstStates& q, const ConstStates& qd,
                                  const StridedMatrices& C) const override {
    currentRobot()->fast.coriolisMatrixBatch(q, qd, C);
  }
  void computeTorqueDerivativesBatch(const ConstStates& q, const ConstStates& qd,
                                     const ConstStates& qdd, const StridedMatrices& dtau_dq,
                                     const StridedMatrices& dtau_dqd,
                                     const StridedMatrices& dtau_dqdd) const override {
    currentRobot()->fast.torqueDerivativesBatch(q, qd, qdd, dtau_dq, dtau_dqd, dtau_dqdd);
  }
  void computeRegressorBatch(const ConstStates& q, const ConstStates& qd, const ConstStates& qdd,
                             const StridedMatrices& Y) const override;
  void computeAccelerationsBatch(const ConstStates& q, const ConstStates& qd,
                                 const ConstStates& tau, const States& qdd) const override {
    currentRobot()->fast.forwardDynamicsBatch(q, qd, tau, qdd);
  }
  /// @}

  bool inertiaIsPhysicalImpl() const override { return inertia_is_physical_; }
  bool hasEnergiesImpl() const override { return model().row_parameters.empty(); }
  bool frictionDependsOnPositionImpl() const override {
    return chain_dynamics::frictionDependsOnLoad(model());
  }
  chain_dynamics::FrictionState frictionStateImpl() const override {
    return chain_dynamics::FrictionState(model());
  }
  Deviations torqueDeviation() const override {
    return {model().torque_deviation.data(), model().torque_deviation.size()};
  }
  const std::vector<chain_dynamics::SeenRange>& seenRangesImpl() const override {
    return model().seen;
  }

 private:
  JointInfo keep(chain_dynamics::Model model, const Configuration& configuration,
                 std::vector<std::string> warnings);

  std::unique_ptr<const ReadyModel> robotUnder(const Conditions& conditions) const override;

  std::unique_ptr<const chain_dynamics::Model> model_;
  std::vector<std::unique_ptr<const RigidBodyTip>> other_tips_;  // all but the first
  bool inertia_is_physical_ = false;
};

}  // namespace v2
}  // namespace rigid_body_inverse_dynamics_solver

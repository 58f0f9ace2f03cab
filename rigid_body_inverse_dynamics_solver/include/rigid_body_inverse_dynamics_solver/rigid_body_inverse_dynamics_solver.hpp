// SPDX-License-Identifier: Apache-2.0
/// @file
/// Inverse dynamics of any serial robot, from a URDF or from a model file, by the engine
/// chain_dynamics.
///
///     auto solver = SolverLoader().load(
///         "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody");
///     solver->initialize({{"tip", "tool0"}}, "", urdf);           // rigid bodies of a URDF
///     solver->initialize({{"model", "franka_gaz2019_feasible"}});   // a model file
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/model.hpp"
#include "inverse_dynamics_solver/changeable_robot.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"

namespace rigid_body_inverse_dynamics_solver {
inline namespace v2 {

using inverse_dynamics_solver::Configuration;
using inverse_dynamics_solver::ConstStates;
using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::MatrixRef;
using inverse_dynamics_solver::States;
using inverse_dynamics_solver::StridedMatrices;
using inverse_dynamics_solver::VectorRef;

/// A model made ready to compute with.
struct ReadyModel {
  chain_dynamics::Model model;
  std::unique_ptr<const chain_dynamics::FastModel> fast;  ///< null: a chain too long for it
};

/// The engine as a solver.
///
/// Parameters in addition to those of every solver [configuration.hpp]: bodies at the tip
/// [payload.hpp]; `model`, a string, the path of a model file or the name of one in the package
/// inverse_dynamics_robots; empty by default: the robot description (URDF).
///
/// A model file takes precedence over a robot description, which a node often carries for other
/// programs. It states geometry, inertia, gravity, friction and drive gains itself; then `gravity`
/// replaces the file's only where it is given. `root`, `tip`, `attached`, `locked_joints`,
/// `allow_massless` and `urdf_friction` have no meaning, and bodies that the description attaches
/// to the model's joints aren't included: warnings() lists what was given in vain.
///
/// Without a model file, friction is that of the description where `urdf_friction` is true, else
/// zero.
///
/// Real time and threads: as the base class promises, for up to 64 joints.
class InverseDynamicsSolverRigidBody : public inverse_dynamics_solver::InverseDynamicsSolver,
                                       public inverse_dynamics_solver::ChangeableRobot<ReadyModel> {
 protected:
  JointInfo configure(const Configuration& configuration) override;

  /// For solvers of one particular robot: computes with this model from now on, with gravity and
  /// friction as the configuration says. Warns of parameters without meaning, and of bodies in the
  /// robot description that the model doesn't include. All or nothing, as configure().
  JointInfo use(chain_dynamics::Model model, const Configuration& configuration);

  /// The model of the bare robot, without payloads; only after a successful initialize().
  const chain_dynamics::Model& model() const { return *model_; }

  const InverseDynamicsSolver& torqueSolver() const override { return *this; }

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
  void computeInertiaMatrixBatch(const ConstStates& q, const StridedMatrices& H) const override;
  void computeCoriolisVectorBatch(const ConstStates& q, const ConstStates& qd,
                                  const States& c) const override;
  void computeFrictionBatch(const ConstStates& q, const ConstStates& qd,
                            const States& f) const override;
  void computeGravityVectorBatch(const ConstStates& q, const States& g) const override;
  void computeDynamicComponentsBatch(const ConstStates& q, const ConstStates& qd,
                                     const StridedMatrices& H, const States& c,
                                     const States& g) const override;
  void computeTorquesBatch(const ConstStates& q, const ConstStates& qd, const ConstStates& qdd,
                           const States& tau) const override;
  void computeParts(bool shared, const std::function<void()>& compute) const override;
  bool inertiaIsPhysicalImpl() const override { return inertia_is_physical_; }

 private:
  JointInfo keep(chain_dynamics::Model model, const Configuration& configuration,
                 std::vector<std::string> warnings);

  std::unique_ptr<const ReadyModel> robotUnder(const Conditions& conditions) const override;

  std::unique_ptr<const chain_dynamics::Model> model_;
  bool inertia_is_physical_ = false;
};

}  // namespace v2
}  // namespace rigid_body_inverse_dynamics_solver

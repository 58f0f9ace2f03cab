// SPDX-License-Identifier: Apache-2.0

/// @file
/// A solver whose torques can be computed in one's head: tau = (2 qdd_1 + 10, 3 qdd_2 + 20).

#pragma once

#include <inverse_dynamics_evaluation/run_configuration.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>

namespace inverse_dynamics_ros {

class TwoJointSolver : public inverse_dynamics_solver::InverseDynamicsSolver {
 public:
  static std::shared_ptr<const TwoJointSolver> make() {
    auto solver = std::make_shared<TwoJointSolver>();
    solver->initialize();
    return solver;
  }

 protected:
  using ConstVector = inverse_dynamics_solver::ConstVectorRef;
  using Vector = inverse_dynamics_solver::VectorRef;

  JointInfo configure(const inverse_dynamics_solver::Configuration&) override {
    return {{"a", "b"}, {}};
  }
  void computeInertiaMatrix(const ConstVector&,
                            inverse_dynamics_solver::MatrixRef H) const override {
    H << 2, 0, 0, 3;
  }
  void computeCoriolisVector(const ConstVector&, const ConstVector&, Vector c) const override {
    c.setZero();
  }
  void computeGravityVector(const ConstVector&, Vector g) const override { g << 10, 20; }
  bool inertiaIsPhysicalImpl() const override { return true; }
};

/// What parameters of a node with that solver state of efforts.
inline inverse_dynamics_evaluation::EffortOptions effortsOfTwoJoints(
    const std::string& effort, const std::vector<double>& drive_gains) {
  inverse_dynamics_evaluation::RunConfiguration robot;
  robot.plugin = "package/TwoJointSolver";
  robot.effort = effort;
  robot.drive_gains = drive_gains;
  return inverse_dynamics_evaluation::effortOptions(robot, *TwoJointSolver::make());
}

}  // namespace inverse_dynamics_ros

// SPDX-License-Identifier: Apache-2.0
//
// Every exported target is linked and used without pluginlib: solvers are ordinary classes too.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <memory>

#include "chain_dynamics/torques.hpp"
#include "franka_inria_inverse_dynamics_solver/franka_inria_inverse_dynamics_solver.hpp"
#include "inverse_dynamics_control/inverse_dynamics_control.hpp"
#include "inverse_dynamics_evaluation/metrics.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "kdl_inverse_dynamics_solver/kdl_inverse_dynamics_solver.hpp"
#include "rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp"
#include "ur10_inverse_dynamics_solver/ur10_inverse_dynamics_solver.hpp"

namespace inverse_dynamics_documentation_tests::exported_targets_test {

// A mass of 2 kg, 0.5 m from a horizontal axis.
const char* const kPendulum = R"(<robot name="pendulum">
  <link name="base"/>
  <link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
    <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
  <joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 -1 0"/></joint>
</robot>)";

const Eigen::VectorXd kHorizontal = Eigen::VectorXd::Zero(1);

// g = m g l [N m]; exact but for rounding.
const double kHoldingTorque = 2 * 9.81 * 0.5;
const double kRounding = 1e-12;

TEST(ExportedTargets, ChainDynamicsHoldsAPendulum) {
  const chain_dynamics::Joint hinge{"hinge", chain_dynamics::JointType::kRevolute};
  const auto arm =
      chain_dynamics::LinkParameters::fromCenterOfMass(2, {0.5, 0, 0}, Eigen::Matrix3d::Zero());
  const chain_dynamics::Chain pendulum("pendulum", {hinge}, {arm}, {0, -9.81, 0});
  Eigen::VectorXd tau(1);
  chain_dynamics::torques(pendulum, kHorizontal, kHorizontal, kHorizontal, tau);
  EXPECT_NEAR(tau[0], kHoldingTorque, kRounding);
}

TEST(ExportedTargets, SolversFromAUrdfHoldAPendulum) {
  kdl_inverse_dynamics_solver::InverseDynamicsSolverKDL kdl;
  rigid_body_inverse_dynamics_solver::InverseDynamicsSolverRigidBody rigid_body;
  for (inverse_dynamics_solver::InverseDynamicsSolver* solver :
       {static_cast<inverse_dynamics_solver::InverseDynamicsSolver*>(&kdl),
        static_cast<inverse_dynamics_solver::InverseDynamicsSolver*>(&rigid_body)}) {
    solver->initialize({}, "", kPendulum);
    EXPECT_NEAR(solver->getTorques(kHorizontal, kHorizontal, kHorizontal)[0], kHoldingTorque,
                kRounding);
  }
}

TEST(ExportedTargets, IdentifiedSolversBringTheirOwnRobot) {
  ur10_inverse_dynamics_solver::InverseDynamicsSolverUR10 ur10;
  franka_inria_inverse_dynamics_solver::InverseDynamicsSolverFrankaInria panda;
  ur10.initialize();
  panda.initialize();
  EXPECT_EQ(ur10.jointCount(), 6);
  EXPECT_EQ(panda.jointCount(), 7);
}

TEST(ExportedTargets, ControlHoldsAPendulum) {
  auto solver = std::make_shared<kdl_inverse_dynamics_solver::InverseDynamicsSolverKDL>();
  solver->initialize({}, "", kPendulum);
  inverse_dynamics_control::LawOptions options;
  options.limits.effort = Eigen::VectorXd::Constant(1, 20);
  options.damping = Eigen::VectorXd::Zero(1);
  inverse_dynamics_control::GravityCompensation law(solver, options);
  Eigen::VectorXd tau(1);
  EXPECT_EQ(law.update(inverse_dynamics_control::JointState(1), 1e-3, tau),
            inverse_dynamics_control::Status::kOk);
  EXPECT_NEAR(tau[0], kHoldingTorque, kRounding);
}

TEST(ExportedTargets, EvaluationMeasuresAnError) {
  const Eigen::MatrixXd measured = Eigen::RowVector2d(0, 4);
  const Eigen::MatrixXd computed = Eigen::RowVector2d(1, 3);
  EXPECT_EQ(inverse_dynamics_evaluation::metrics(computed, measured)[0].rmse, 1);
}

}  // namespace inverse_dynamics_documentation_tests::exported_targets_test

// SPDX-License-Identifier: Apache-2.0
//
// What docs/migration.md shows of C++, and what it says that it does.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <fstream>
#include <inverse_dynamics_solver/external_wrench.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <inverse_dynamics_solver/motor_currents.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <iostream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace inverse_dynamics_documentation_tests::migration_test {

using inverse_dynamics_solver::ExternalWrench;
using inverse_dynamics_solver::Kinematics;
using inverse_dynamics_solver::MotorCurrents;
using inverse_dynamics_solver::SolverLoader;
using inverse_dynamics_solver::WrenchInRoot;

const double kRounding = 1e-10;  // of some hundred N m

const char* const kUr10 = "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10";
const char* const kKdl = "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL";

std::string ur10() {
  std::ifstream file(UR10_URDF);
  return {std::istreambuf_iterator<char>(file), {}};
}

const Eigen::VectorXd kQ = Eigen::VectorXd::LinSpaced(6, -1.0, 1.0);
const Eigen::VectorXd kQd = Eigen::VectorXd::LinSpaced(6, 0.5, -0.5);
const Eigen::VectorXd kQdd = Eigen::VectorXd::Constant(6, 1.0);

TEST(Migration, CallsOfTheReferenceImplementationHaveTheirCounterparts) {
  const std::string urdf = ur10();
  const Eigen::VectorXd &q = kQ, &qd = kQd, &qdd = kQdd;
  const Eigen::Vector3d force(20.0, 0.0, -5.0), torque(0.0, 1.0, 0.0);
  testing::internal::CaptureStdout();

  // Headers end in .hpp. pluginlib::ClassLoader works as before; SolverLoader needs no arguments.
  const auto solver = SolverLoader().load("ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10");

  // Identified solvers must be initialized, too: until then, methods throw UninitializedException.
  solver->initialize();

  // getDynamicParameters(), which still exists, too
  const auto [H, c, g] = solver->getDynamicComponents(q, qd);

  // The constants K1 to K6 and NUMBER_OF_JOINTS
  const auto& motors = dynamic_cast<const MotorCurrents&>(*solver);
  const Eigen::VectorXd K = motors.getDriveGainsMatrix().diagonal();
  const Eigen::Index n = solver->jointCount();

  // The free function getCurrents(q, qd, qdd, i), without friction; those of one term likewise
  const Eigen::VectorXd i_f = solver->getFrictionVector(qd).cwiseQuotient(K);
  const Eigen::VectorXd i = motors.getCurrents(q, qd, qdd) - i_f;

  // rclcpp::exceptions::InvalidParameterValueException. All exceptions of that family now derive from
  // inverse_dynamics_solver::Exception, a std::runtime_error.
  try {
    solver->initialize({{"gravity", std::vector<double>{0.0, -9.81}}});
  } catch (const inverse_dynamics_solver::InvalidParameterValueException& e) {
    std::cout << e.what() << "\n";
  }

  // The description is an argument, and parameters come from a map instead of a node. Without the
  // parameter `tip`, the tip is the leaf of the URDF. Bodies fixed beyond the tip, or beside the chain,
  // are included, unless `attached` is "ignore", as in the released solver.
  const auto kdl = SolverLoader().load("kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL");
  kdl->initialize({{"tip", "tool0"}, {"attached", "ignore"}}, "", urdf);

  // getJacobian(q) and getTorques(q, qd, qdd, external_wrench), which haven't been released yet
  const Eigen::MatrixXd J = dynamic_cast<const Kinematics&>(*kdl).getTipJacobian(q);
  const Eigen::VectorXd tau =
      dynamic_cast<const ExternalWrench&>(*kdl).getTorques(q, qd, qdd, WrenchInRoot{force, torque});

  EXPECT_NE(testing::internal::GetCapturedStdout().find("parameter 'gravity': wrong value"),
            std::string::npos);
  const Eigen::VectorXd f = solver->getFrictionVector(qd);
  EXPECT_TRUE((K.cwiseProduct(i) + f).isApprox(solver->getTorques(q, qd, qdd), kRounding));
  EXPECT_TRUE((H * qdd + c + g + f).isApprox(solver->getTorques(q, qd, qdd), kRounding));
  EXPECT_EQ(n, 6);
  EXPECT_NEAR(K[0], 13.5841, 1e-12);
  EXPECT_TRUE(kdl->getFrictionVector(qd).isZero(0.0));
  const Eigen::VectorXd wrench = (Eigen::VectorXd(6) << force, torque).finished();
  EXPECT_TRUE(tau.isApprox(kdl->getTorques(q, qd, qdd) + J.transpose() * wrench, kRounding));
}

TEST(Migration, GetDynamicParametersIsThere) {
  const auto solver = SolverLoader().load(kUr10);
  solver->initialize();
  const auto [H, c, g] = solver->getDynamicParameters(kQ, kQd);
  EXPECT_EQ(H, solver->getInertiaMatrix(kQ));
  EXPECT_EQ(c, solver->getCoriolisVector(kQ, kQd));
  EXPECT_EQ(g, solver->getGravityVector(kQ));
}

TEST(Migration, BodiesBeyondTheTipCountUnlessTheyAreIgnored) {
  std::string urdf = ur10();
  const std::string load =
      "<link name='load'><inertial><mass value='5'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' "
      "iyz='0' izz='0.01'/></inertial></link><joint name='to_load' type='fixed'><parent "
      "link='tool0'/><child link='load'/></joint></robot>";
  urdf.replace(urdf.rfind("</robot>"), std::string::npos, load);
  const auto shoulder = [&](const std::string& attached) {
    const auto kdl = SolverLoader().load(kKdl);
    kdl->initialize({{"tip", "tool0"}, {"attached", attached}}, "", urdf);
    return kdl->getGravityVector(Eigen::VectorXd::Zero(6))[1];  // stretched out
  };
  EXPECT_NEAR(shoulder("ignore"), -119.172, 1e-3);
  EXPECT_NEAR(shoulder("lump"), -177.262, 1e-3);
  EXPECT_NEAR(shoulder("lump") - shoulder("ignore"), -5 * 9.81 * (0.612 + 0.5723), kRounding);
}

}  // namespace inverse_dynamics_documentation_tests::migration_test

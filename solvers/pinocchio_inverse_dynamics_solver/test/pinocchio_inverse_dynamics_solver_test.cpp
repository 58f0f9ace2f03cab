// SPDX-License-Identifier: Apache-2.0
#include "pinocchio_inverse_dynamics_solver/pinocchio_inverse_dynamics_solver.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/parameters.hpp"

namespace pinocchio_inverse_dynamics_solver::pinocchio_inverse_dynamics_solver_test {

using inverse_dynamics_solver::Parameters;
using inverse_dynamics_solver::conformance::expectReferenceValues;
using inverse_dynamics_solver::conformance::robotsFile;
using inverse_dynamics_solver::conformance::textOf;

/// [N m, kg m^2] Two versions of a program, operations in another order, on terms of up to some
/// hundred N m.
constexpr double kTolerance = 1e-10;

void compare(const std::string& robot, const Parameters& parameters) {
  InverseDynamicsSolverPinocchio solver;
  solver.initialize(parameters, "", textOf(robotsFile("urdf/" + robot + ".urdf")));
  expectReferenceValues(solver, robot + "_urdf.json", kTolerance);
}

TEST(InverseDynamicsSolverPinocchio, Ur10GivesTheReferenceValues) {
  compare("ur10", {{"root", "base_link"}, {"tip", "tool0"}});
}

TEST(InverseDynamicsSolverPinocchio, PandaGivesTheReferenceValues) {
  compare("panda", {{"root", "fer_link0"}, {"tip", "fer_link8"}});
}

TEST(InverseDynamicsSolverPinocchio, PositionsOfContinuousJointsAreAngles) {
  InverseDynamicsSolverPinocchio solver;
  solver.initialize({{"tip", "tool"}}, "", textOf(robotsFile("urdf/oblique_arm.urdf")));
  Eigen::VectorXd q = Eigen::VectorXd::Constant(solver.jointCount(), 0.3);
  const Eigen::VectorXd g = solver.getGravityVector(q);
  ASSERT_EQ(solver.jointNames()[2], "spin");
  q[2] += 2 * M_PI;
  EXPECT_TRUE(solver.getGravityVector(q).isApprox(g, 1e-12));
  q[2] += 0.1;
  EXPECT_FALSE(solver.getGravityVector(q).isApprox(g, 1e-3));
}

/// Memory of this process, in MB.
double residentMemory() {
  std::ifstream file("/proc/self/statm");
  double pages = 0;
  file >> pages >> pages;
  return pages * 4096e-6;
}

/// Rods of 0.1 m, about x and y in turn.
std::string snake(int joints) {
  std::string urdf = "<robot name='snake'><link name='l0'/>";
  for (int i = 1; i <= joints; ++i) {
    const std::string own = std::to_string(i), parent = std::to_string(i - 1);
    urdf += "<link name='l" + own +
            "'><inertial><origin xyz='0 0 0.05'/><mass value='0.3'/><inertia ixx='0.01' iyy='0.01' "
            "izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='j" +
            own + "' type='continuous'><parent link='l" + parent + "'/><child link='l" + own +
            "'/><origin xyz='0 0 0.1'/><axis xyz='" + (i % 2 == 0 ? "1 0 0" : "0 1 0") +
            "'/></joint>";
  }
  return urdf + "</robot>";
}

/// Pinocchio's second derivatives of 100 joints take 32 MB in each of 16 workspaces.
TEST(InverseDynamicsSolverPinocchio, WorkspacesOfLongChainsHoldNoSecondDerivatives) {
  const double before = residentMemory();
  InverseDynamicsSolverPinocchio solver;
  solver.initialize({{"max_threads", 16}}, "", snake(100));
  EXPECT_LT(residentMemory() - before, 150.0);
  EXPECT_EQ(solver.jointCount(), 100);
}

}  // namespace pinocchio_inverse_dynamics_solver::pinocchio_inverse_dynamics_solver_test

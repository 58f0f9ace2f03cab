// SPDX-License-Identifier: Apache-2.0
#include "pinocchio_inverse_dynamics_solver/pinocchio_inverse_dynamics_solver.hpp"

#include <gtest/gtest.h>

#include "inverse_dynamics_solver/conformance/reference_values.hpp"

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

}  // namespace pinocchio_inverse_dynamics_solver::pinocchio_inverse_dynamics_solver_test

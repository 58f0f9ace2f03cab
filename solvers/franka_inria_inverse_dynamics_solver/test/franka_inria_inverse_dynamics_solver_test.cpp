// SPDX-License-Identifier: Apache-2.0
#include "franka_inria_inverse_dynamics_solver/franka_inria_inverse_dynamics_solver.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/motor_currents.hpp"
#include "inverse_dynamics_solver/solver_loader.hpp"

namespace franka_inria_inverse_dynamics_solver::franka_inria_inverse_dynamics_solver_test {

using inverse_dynamics_solver::conformance::expectReferenceValues;

const char* const kPlugin = "franka_inria_inverse_dynamics_solver/InverseDynamicsSolverFrankaInria";

// N m, kg m^2. The same polynomial of sines and cosines, evaluated in another order; the file's
// fitted figures have a relative 1e-14.
constexpr double kTolerance = 1e-10;

using Vector7 = Eigen::Matrix<double, 7, 1>;

Vector7 ramp(double first, double last) { return Vector7::LinSpaced(first, last); }

const Vector7 kQ = ramp(-1.2, 1.5);
const Vector7 kQd = ramp(0.9, -1.1);
const Vector7 kQdd = ramp(-2.0, 3.0);

TEST(FrankaInria, GivesTheValuesOfTheReferenceImplementation) {
  const inverse_dynamics_solver::SolverLoader loader;
  const auto solver = loader.load(kPlugin);
  solver->initialize();
  expectReferenceValues(*solver, "franka_inria.json", kTolerance);
}

TEST(FrankaInria, JointsAreThoseOfTheRobot) {
  InverseDynamicsSolverFrankaInria solver;
  solver.initialize();
  EXPECT_EQ(solver.jointNames(),
            (std::vector<std::string>{"fer_joint1", "fer_joint2", "fer_joint3", "fer_joint4",
                                      "fer_joint5", "fer_joint6", "fer_joint7"}));
}

TEST(FrankaInria, FrictionIsZeroAtRestAndOpposesMotion) {
  InverseDynamicsSolverFrankaInria solver;
  solver.initialize();
  EXPECT_EQ(solver.getFrictionVector(Vector7::Zero()), Vector7::Zero());
  EXPECT_GT(solver.getFrictionVector(Vector7::Constant(0.5)).minCoeff(), 0.05);
  EXPECT_LT(solver.getFrictionVector(Vector7::Constant(-0.5)).maxCoeff(), -0.05);
}

TEST(FrankaInria, IgnoresARobotDescription) {
  InverseDynamicsSolverFrankaInria alone, beside;
  alone.initialize();
  beside.initialize({{"root", std::string("base")}, {"tip", std::string("hand")}}, "",
                    "<not a URDF");
  EXPECT_EQ(beside.getTorques(kQ, kQd, kQdd), alone.getTorques(kQ, kQd, kQdd));
}

TEST(FrankaInria, HasNoMotorCurrents) {
  const inverse_dynamics_solver::SolverLoader loader;
  const auto solver = loader.load(kPlugin);
  EXPECT_EQ(dynamic_cast<const inverse_dynamics_solver::MotorCurrents*>(solver.get()), nullptr);
}

}  // namespace franka_inria_inverse_dynamics_solver::franka_inria_inverse_dynamics_solver_test

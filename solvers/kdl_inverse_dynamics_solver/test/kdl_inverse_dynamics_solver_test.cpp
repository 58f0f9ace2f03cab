// SPDX-License-Identifier: Apache-2.0
#include "kdl_inverse_dynamics_solver/kdl_inverse_dynamics_solver.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/coriolis_vector.hpp>
#include <chain_dynamics/gravity_vector.hpp>
#include <chain_dynamics/inertia_matrix.hpp>
#include <chain_dynamics/torques.hpp>
#include <inverse_dynamics_solver/configuration.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"

namespace kdl_inverse_dynamics_solver::kdl_inverse_dynamics_solver_test {

using inverse_dynamics_solver::Parameters;
using inverse_dynamics_solver::conformance::errorOf;

std::string obliqueArm() {
  using namespace inverse_dynamics_solver::conformance;
  return textOf(robotsFile("urdf/oblique_arm.urdf"));
}

/// [N m, N, kg m^2] KDL and the engine do the same operations in another order, on terms of up to
/// 1e3; 1e-16 each, some hundred of them.
constexpr double kRounding = 1e-11;

/// The engine is other code, and no part of KDL.
TEST(InverseDynamicsSolverKDL, AgreesWithTheEngineWhateverIsTakenOfTheRobot) {
  const std::vector<Parameters> choices = {
      {{"ids.tip", "tool"}},
      {{"ids.tip", "tool"}, {"ids.attached", "ignore"}},
      {{"ids.tip", "tool"}, {"ids.locked_joints.grip", 0.8}},
      {{"ids.tip", "finger"}, {"ids.gravity", std::vector<double>{1.0, 2.0, 3.0}}},
      {{"ids.root", "upper"}, {"ids.tip", "wrist"}},
      {{"ids.root", "pedestal"}, {"ids.tip", "slide"}},
      {{"ids.root", "finger"}, {"ids.tip", "floor"}, {"ids.rotor_inertia.push", 0.7}},
      {{"ids.root", "cover"}, {"ids.tip", "tool"}, {"ids.rotor_inertia.spin", 0.05}}};
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  Eigen::VectorXd last;
  for (const Parameters& choice : choices) {
    InverseDynamicsSolverKDL solver;
    solver.initialize(choice, "ids", obliqueArm());
    const chain_dynamics::Chain chain =
        chainFromDescription(readConfiguration(choice, "ids", obliqueArm()));
    const Eigen::Index n = chain.jointCount();
    ASSERT_EQ(solver.jointNames(), chain.jointNames());
    for (int k = 0; k < 20; ++k) {
      const auto draw = [&](double) { return uniform(random); };
      const Eigen::VectorXd q = Eigen::VectorXd::NullaryExpr(n, draw);
      const Eigen::VectorXd qd = Eigen::VectorXd::NullaryExpr(n, draw);
      const Eigen::VectorXd qdd = Eigen::VectorXd::NullaryExpr(n, draw);
      Eigen::MatrixXd H(n, n);
      Eigen::VectorXd c(n), g(n), tau(n);
      chain_dynamics::inertiaMatrix(chain, q, H);
      chain_dynamics::coriolisVector(chain, q, qd, c);
      chain_dynamics::gravityVector(chain, q, g);
      chain_dynamics::torques(chain, q, qd, qdd, tau);
      EXPECT_LE((solver.getInertiaMatrix(q) - H).cwiseAbs().maxCoeff(), kRounding);
      EXPECT_LE((solver.getCoriolisVector(q, qd) - c).cwiseAbs().maxCoeff(), kRounding);
      EXPECT_LE((solver.getGravityVector(q) - g).cwiseAbs().maxCoeff(), kRounding);
      EXPECT_LE((solver.getTorques(q, qd, qdd) - tau).cwiseAbs().maxCoeff(), kRounding);
    }

    // And the choice matters.
    const Eigen::VectorXd g = solver.getGravityVector(Eigen::VectorXd::Ones(n));
    EXPECT_FALSE(g.size() == last.size() && g.isApprox(last, 1e-6));
    last = g;
  }
}

TEST(InverseDynamicsSolverKDL, CalculatesRightWithMoreThreadsThanWorkspaces) {
  InverseDynamicsSolverKDL one, many;
  one.initialize({{"ids.max_threads", 1}, {"ids.tip", "tool"}}, "ids", obliqueArm());
  many.initialize({{"ids.max_threads", 100}, {"ids.tip", "tool"}}, "ids", obliqueArm());
  const Eigen::MatrixXd q = Eigen::MatrixXd::Random(3, 64);
  const Eigen::MatrixXd expected = many.getTorquesBatch(q, q, q);
  std::vector<std::thread> threads;
  std::atomic<int> different{0};
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < 100; ++k) different += one.getTorquesBatch(q, q, q) == expected ? 0 : 1;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(different, 0);
}

TEST(InverseDynamicsSolverKDL, RefusesMotorsAndSpringsByName) {
  for (const std::string name : {"ids.motors", "ids.springs.spin.stiffness"}) {
    InverseDynamicsSolverKDL solver;
    const Parameters parameters = {{"ids.tip", "tool"}, {name, 1.0}};
    const std::string error = errorOf<inverse_dynamics_solver::InvalidParameterValueException>(
        [&] { solver.initialize(parameters, "ids", obliqueArm()); });
    EXPECT_NE(error.find("'" + name + "'"), std::string::npos) << error;
    EXPECT_NE(error.find("rigid_body_inverse_dynamics_solver"), std::string::npos) << error;
  }
}

}  // namespace kdl_inverse_dynamics_solver::kdl_inverse_dynamics_solver_test

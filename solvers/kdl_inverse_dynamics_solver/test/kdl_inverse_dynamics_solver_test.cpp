// SPDX-License-Identifier: Apache-2.0
#include "kdl_inverse_dynamics_solver/kdl_inverse_dynamics_solver.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/model.hpp>
#include <inverse_dynamics_solver/configuration.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <inverse_dynamics_solver/pooled_solver.hpp>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"
#include "inverse_dynamics_solver/conformance/two_arms.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"

namespace kdl_inverse_dynamics_solver::kdl_inverse_dynamics_solver_test {

using inverse_dynamics_solver::Parameters;
using inverse_dynamics_solver::ParameterValue;
using inverse_dynamics_solver::conformance::errorOf;
using inverse_dynamics_solver::conformance::twoArms;

std::string obliqueArm() {
  using namespace inverse_dynamics_solver::conformance;
  return textOf(robotsFile("urdf/oblique_arm.urdf"));
}

/// [N m, N, kg m^2] KDL and the engine do the same operations in another order, on terms of up to
/// 1e3; 1e-16 each, some hundred of them.
constexpr double kRounding = 1e-11;

/// The engine is other code, and no part of KDL.
TEST(InverseDynamicsSolverKDL, AgreesWithTheEngineWhateverIsTakenOfTheRobot) {
  const std::string arm = obliqueArm(), two_arms = twoArms();
  const std::vector<std::pair<Parameters, std::string>> choices = {
      {{{"ids.tip", "tool"}}, arm},
      {{{"ids.tip", "tool"}, {"ids.attached", "ignore"}}, arm},
      {{{"ids.tip", "tool"}, {"ids.locked_joints.grip", 0.8}}, arm},
      {{{"ids.tip", "finger"}, {"ids.gravity", std::vector<double>{1.0, 2.0, 3.0}}}, arm},
      {{{"ids.root", "upper"}, {"ids.tip", "wrist"}}, arm},
      {{{"ids.root", "pedestal"}, {"ids.tip", "slide"}}, arm},
      {{{"ids.root", "finger"}, {"ids.tip", "floor"}, {"ids.rotor_inertia.push", 0.7}}, arm},
      {{{"ids.root", "cover"}, {"ids.tip", "tool"}, {"ids.rotor_inertia.spin", 0.05}}, arm},
      {{{"ids.tip", "*"}, {"ids.rotor_inertia.left_other_finger_joint", 0.7}}, two_arms},
      {{{"ids.root", "left_hand"}, {"ids.tip", "right_tool,left_finger"}}, two_arms}};
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  Eigen::VectorXd last;
  for (const auto& [choice, urdf] : choices) {
    InverseDynamicsSolverKDL solver;
    solver.initialize(choice, "ids", urdf);
    const chain_dynamics::Model model(
        mechanismFromDescription(readConfiguration(choice, "ids", urdf)));
    const Eigen::Index n = model.chain.jointCount();
    ASSERT_EQ(solver.jointNames(), model.chain.jointNames());
    for (int k = 0; k < 20; ++k) {
      const auto draw = [&](double) { return uniform(random); };
      const Eigen::VectorXd q = Eigen::VectorXd::NullaryExpr(n, draw);
      const Eigen::VectorXd qd = Eigen::VectorXd::NullaryExpr(n, draw);
      const Eigen::VectorXd qdd = Eigen::VectorXd::NullaryExpr(n, draw);
      Eigen::MatrixXd H(n, n);
      Eigen::VectorXd c(n), g(n), tau(n);
      chain_dynamics::inertiaMatrix(model, q, H);
      chain_dynamics::coriolisVector(model, q, qd, c);
      chain_dynamics::gravityVector(model, q, g);
      chain_dynamics::torques(model, q, qd, qdd, tau);
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

/// A PooledSolver that doesn't say how it computes trees.
struct ChainsOnly : InverseDynamicsSolverKDL {
  WorkspaceMaker treeWorkspaceMaker(const chain_dynamics::Model& tree) const override {
    return PooledSolver::treeWorkspaceMaker(tree);
  }
};

TEST(PooledSolver, RefusesTreesByDefault) {
  using namespace inverse_dynamics_solver;  // NOLINT(google-build-using-namespace)
  ChainsOnly solver;
  const auto errorOf = [&solver](const char* tip, const std::string& urdf) {
    return conformance::errorOf<InvalidParameterValueException>([&] {
      solver.initialize({{"tip", tip}}, "", urdf);
    });
  };
  const std::string several = errorOf("*", twoArms());
  EXPECT_TRUE(conformance::contains(
      several, {"'tip'", "one link", "got right_tool, left_finger, left_other_finger;"}))
      << several;
  std::string urdf = twoArms();
  const std::string elbow = "<child link='right_elbow'/>";
  ASSERT_NE(urdf.find(elbow), std::string::npos);
  urdf.insert(urdf.find(elbow), "<mimic joint='right_shoulder_joint'/>");
  const std::string one = errorOf("right_tool", urdf);
  EXPECT_TRUE(conformance::contains(one, {"a joint that mimics another, before right_tool;"}))
      << one;
  EXPECT_FALSE(solver.isInitialized());
  solver.initialize({{"tip", "right_tool"}}, "", twoArms());
  EXPECT_EQ(solver.jointCount(), 5);
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
  const std::map<std::string, ParameterValue> refused = {
      {"ids.motors", std::vector<double>(25, 1.0)}, {"ids.springs.spin.stiffness", 1.0}};
  for (const auto& [name, value] : refused) {
    InverseDynamicsSolverKDL solver;
    const Parameters parameters = {{"ids.tip", "tool"}, {name, value}};
    const std::string error = errorOf<inverse_dynamics_solver::InvalidParameterValueException>(
        [&] { solver.initialize(parameters, "ids", obliqueArm()); });
    EXPECT_NE(error.find("'" + name + "'"), std::string::npos) << error;
    EXPECT_NE(error.find("rigid_body_inverse_dynamics_solver"), std::string::npos) << error;
  }
  const Parameters none = {{"ids.tip", "tool"}, {"ids.motors", ""}};  // what a node may declare
  EXPECT_NO_THROW(InverseDynamicsSolverKDL().initialize(none, "ids", obliqueArm()));
}

}  // namespace kdl_inverse_dynamics_solver::kdl_inverse_dynamics_solver_test

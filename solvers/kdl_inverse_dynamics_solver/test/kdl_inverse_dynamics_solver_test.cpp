// SPDX-License-Identifier: Apache-2.0
#include "kdl_inverse_dynamics_solver/kdl_inverse_dynamics_solver.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/coriolis_vector.hpp>
#include <chain_dynamics/gravity_vector.hpp>
#include <chain_dynamics/inertia_matrix.hpp>
#include <chain_dynamics/torques.hpp>
#include <cmath>
#include <inverse_dynamics_solver/configuration.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "inverse_dynamics_solver/conformance/reference_values.hpp"

namespace kdl_inverse_dynamics_solver::kdl_inverse_dynamics_solver_test {

using inverse_dynamics_solver::Parameters;

std::string obliqueArm() {
  using namespace inverse_dynamics_solver::conformance;
  return textOf(robotsFile("urdf/oblique_arm.urdf"));
}

/// [N m, N, kg m^2] KDL and the engine do the same operations in another order, on terms of up to
/// 1e3; 1e-16 each, some hundred of them.
constexpr double kRounding = 1e-11;

/// Worked by hand: two rods of 1 m in the x-z plane, joints about y, 2 kg and 3 kg at their ends;
/// at q = 0 they point along +x.
TEST(InverseDynamicsSolverKDL, PlanarArmGivesTheValuesWorkedByHand) {
  const std::string link = R"("><inertial><origin xyz="1 0 0"/><mass value=")";
  const std::string inertia =
      R"("/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>)";
  const std::string urdf = R"(<robot name="planar"><link name="base"/>)"
                           R"(<link name="one)" +
                           link + "2" + inertia + R"(<link name="two)" + link + "3" + inertia + R"(
    <joint name="a" type="continuous"><parent link="base"/><child link="one"/>
      <axis xyz="0 1 0"/></joint>
    <joint name="b" type="continuous"><parent link="one"/><child link="two"/>
      <origin xyz="1 0 0"/><axis xyz="0 1 0"/></joint></robot>)";
  InverseDynamicsSolverKDL solver;
  solver.initialize({{"gravity", std::vector<double>{0.0, 0.0, -10.0}}}, "", urdf);
  ASSERT_EQ(solver.jointNames(), (std::vector<std::string>{"a", "b"}));

  // Stretched along +x, at rest: gravity pulls down, and a positive turn about y lowers the arm, so
  // the motors must turn it back: -(2 * 1 + 3 * 2) 10 and -3 * 1 * 10.
  EXPECT_TRUE(solver.getGravityVector(Eigen::Vector2d(0, 0)).isApprox(Eigen::Vector2d(-80, -30)));

  // H = [2 + 3 * 4, 3 * 2; 3 * 2, 3] stretched; with the elbow at a right angle [2 + 3 * 2, 3; 3,
  // 3].
  EXPECT_TRUE(solver.getInertiaMatrix(Eigen::Vector2d(0, 0))
                  .isApprox((Eigen::Matrix2d() << 14, 6, 6, 3).finished()));
  const Eigen::Vector2d bent(0.4, M_PI_2);
  EXPECT_TRUE(solver.getInertiaMatrix(bent).isApprox((Eigen::Matrix2d() << 8, 3, 3, 3).finished()));

  // C qd = 3 sin(q2) (-(2 qd1 qd2 + qd2^2), qd1^2) with qd = (1, 2): -3 (4 + 4), 3.
  EXPECT_TRUE(solver.getCoriolisVector(bent, Eigen::Vector2d(1, 2))
                  .isApprox(Eigen::Vector2d(-24, 3), 1e-14));
  EXPECT_EQ(solver.getFrictionVector(Eigen::Vector2d(1, 2)), Eigen::Vector2d::Zero());
  EXPECT_TRUE(solver.inertiaIsPhysical());
}

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

}  // namespace kdl_inverse_dynamics_solver::kdl_inverse_dynamics_solver_test

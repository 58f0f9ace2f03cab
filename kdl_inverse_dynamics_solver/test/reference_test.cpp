// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cstdlib>

#include "files.hpp"
#include "inverse_dynamics_solver/solver_loader.hpp"

namespace {

using namespace inverse_dynamics_solver;
using namespace kdl_inverse_dynamics_solver::test;

/// [N m, kg m^2] Two programs do the same operations in another order; on terms of up to some
/// hundred N m that leaves less than 1e-12.
constexpr double kTolerance = 1e-10;

struct Robot {
  const char* reference;  // file of values that Pinocchio computed
  const char* urdf;
  const char* root;
  const char* tip;
};

constexpr Robot kUr10 = {"reference/ur10_urdf.json", "urdf/ur10.urdf", "base_link", "tool0"};
constexpr Robot kPanda = {"reference/panda_urdf.json", "urdf/panda.urdf", "fer_link0", "fer_link8"};

Eigen::VectorXd vectorOf(const YAML::Node& node) {
  const auto values = node.as<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

void expectNear(const Eigen::MatrixXd& value, const Eigen::MatrixXd& expected, const char* what,
                std::size_t state) {
  ASSERT_EQ(value.size(), expected.size()) << what;
  EXPECT_LE((value - expected).cwiseAbs().maxCoeff(), kTolerance) << what << ", state " << state;
}

/// Every quantity of a solver of this URDF against the values of the file.
void compare(const Robot& robot, const std::string& urdf) {
  const auto solver = SolverLoader().load("kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL");
  solver->initialize({{"ids.root", robot.root}, {"ids.tip", robot.tip}}, "ids", urdf);
  const YAML::Node reference = YAML::LoadFile(robotsFile(robot.reference));
  EXPECT_EQ(solver->jointNames(), reference["joint_names"].as<std::vector<std::string>>());
  const Eigen::Index n = solver->jointCount();
  ASSERT_GT(reference["states"].size(), 0U);
  for (std::size_t k = 0; k < reference["states"].size(); ++k) {
    const YAML::Node state = reference["states"][k];
    const Eigen::VectorXd q = vectorOf(state["q"]), qd = vectorOf(state["qd"]);
    const Eigen::VectorXd qdd = vectorOf(state["qdd"]);

    // Rows of H one after another, each a list or not.
    Eigen::MatrixXd H(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        const YAML::Node inertia = state["inertia"];
        H(i, j) =
            inertia[0].IsSequence() ? inertia[i][j].as<double>() : inertia[i * n + j].as<double>();
      }
    }
    expectNear(solver->getInertiaMatrix(q), H, "inertia", k);
    expectNear(solver->getCoriolisVector(q, qd), vectorOf(state["coriolis"]), "coriolis", k);
    expectNear(solver->getGravityVector(q), vectorOf(state["gravity"]), "gravity", k);
    expectNear(solver->getTorques(q, qd, qdd), vectorOf(state["torques"]), "torques", k);
    const auto [H_all, c_all, g_all] = solver->getDynamicComponents(q, qd);
    expectNear(H_all, H, "inertia of all components", k);
    expectNear(c_all, vectorOf(state["coriolis"]), "coriolis of all components", k);
    expectNear(g_all, vectorOf(state["gravity"]), "gravity of all components", k);
  }
}

TEST(Reference, Ur10GivesPinocchiosValues) { compare(kUr10, textOf(robotsFile(kUr10.urdf))); }

TEST(Reference, PandaGivesPinocchiosValues) { compare(kPanda, textOf(robotsFile(kPanda.urdf))); }

/// The makers' descriptions, with meshes and all, which aren't part of the project.
class MakersDescription : public ::testing::TestWithParam<Robot> {};

TEST_P(MakersDescription, GivesPinocchiosValues) {
  const char* const data = std::getenv("IDS_DATA_DIR");
  if (data == nullptr) GTEST_SKIP() << "IDS_DATA_DIR isn't set: no makers' robot descriptions";
  compare(GetParam(), textOf(std::string(data) + "/" + GetParam().urdf));
}

INSTANTIATE_TEST_SUITE_P(Robots, MakersDescription, ::testing::Values(kUr10, kPanda));

}  // namespace

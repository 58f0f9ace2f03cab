// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/solver_loader.hpp"

namespace kdl_inverse_dynamics_solver::reference_test {

using namespace inverse_dynamics_solver;
using namespace inverse_dynamics_solver::conformance;

/// [N m, kg m^2] Two programs do the same operations in another order; on terms of up to some
/// hundred N m that leaves less than 1e-12.
constexpr double kTolerance = 1e-10;

struct Robot {
  const char* reference;  // file of values that Pinocchio computed
  const char* urdf;
  const char* root;
  const char* tip;
};

constexpr Robot kUr10 = {"ur10_urdf.json", "urdf/ur10.urdf", "base_link", "tool0"};
constexpr Robot kPanda = {"panda_urdf.json", "urdf/panda.urdf", "fer_link0", "fer_link8"};

void compare(const Robot& robot, const std::string& urdf) {
  const auto solver = SolverLoader().load("kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL");
  solver->initialize({{"ids.root", robot.root}, {"ids.tip", robot.tip}}, "ids", urdf);
  expectReferenceValues(*solver, robot.reference, kTolerance);
}

TEST(Reference, Ur10GivesPinocchiosValues) { compare(kUr10, textOf(robotsFile(kUr10.urdf))); }

TEST(Reference, PandaGivesPinocchiosValues) { compare(kPanda, textOf(robotsFile(kPanda.urdf))); }

/// The makers' descriptions, with meshes and all, which aren't part of the project.
class MakersDescription : public ::testing::TestWithParam<Robot> {};

TEST_P(MakersDescription, GivesPinocchiosValues) {
  const char* const variable = std::getenv("IDS_DATA_DIR");
  const std::string data = variable == nullptr ? "" : variable;
  if (data.empty()) GTEST_SKIP() << "IDS_DATA_DIR isn't set: no makers' robot descriptions";
  compare(GetParam(), textOf(data + "/" + GetParam().urdf));
}

INSTANTIATE_TEST_SUITE_P(Robots, MakersDescription, ::testing::Values(kUr10, kPanda));

}  // namespace kdl_inverse_dynamics_solver::reference_test

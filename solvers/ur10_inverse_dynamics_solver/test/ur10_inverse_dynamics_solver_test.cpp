// SPDX-License-Identifier: Apache-2.0
#include "ur10_inverse_dynamics_solver/ur10_inverse_dynamics_solver.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"
#include "inverse_dynamics_solver/installed_package.hpp"
#include "inverse_dynamics_solver/motor_currents.hpp"
#include "inverse_dynamics_solver/parameters.hpp"
#include "inverse_dynamics_solver/solver_loader.hpp"
#include "rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp"

namespace ur10_inverse_dynamics_solver::ur10_inverse_dynamics_solver_test {

using inverse_dynamics_solver::Exception;
using inverse_dynamics_solver::MotorCurrents;
using inverse_dynamics_solver::UninitializedException;
using inverse_dynamics_solver::conformance::expectEntry;
using inverse_dynamics_solver::conformance::expectReferenceValues;
using inverse_dynamics_solver::conformance::numbersOf;
using inverse_dynamics_solver::conformance::referenceStates;

const char* const kPlugin = "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10";

// N m, kg m^2, A. The same polynomial of sines and cosines, evaluated in another order; the file's
// fitted figures have a relative 1e-14.
constexpr double kTolerance = 1e-10;

Vector6d vector6(double a, double b, double c, double d, double e, double f) {
  return (Vector6d() << a, b, c, d, e, f).finished();
}

const Vector6d kQ = vector6(0.3, -1.2, 1.4, -0.8, 0.9, 2.0);
const Vector6d kQd = vector6(0.5, -0.4, 0.3, 0.9, -1.1, 1.3);
const Vector6d kQdd = vector6(2.0, 1.0, -1.0, 3.0, -2.0, 0.5);

TEST(UR10, GivesTheValuesOfTheReferenceImplementation) {
  const inverse_dynamics_solver::SolverLoader loader;
  const auto solver = loader.load(kPlugin);
  solver->initialize();
  expectReferenceValues(*solver, "ur10.json", kTolerance);
}

// base_link and tool0: lengths differ by up to 0.7 mm each.
TEST(UR10, HasTheFramesOfTheMakersDescription) {
  const std::filesystem::path robots =
      inverse_dynamics_solver::installedPackageShare("inverse_dynamics_robots");
  std::ostringstream urdf;
  urdf << std::ifstream(robots / "urdf/ur10.urdf").rdbuf();
  const inverse_dynamics_solver::Parameters ends = {{"root", "base_link"}, {"tip", "tool0"}};
  InverseDynamicsSolverUR10 identified;
  rigid_body_inverse_dynamics_solver::InverseDynamicsSolverRigidBody described;
  identified.initialize(ends, "", urdf.str());
  described.initialize(ends, "", urdf.str());
  for (const std::string& warning : identified.warnings()) {
    EXPECT_EQ(warning.find("root and tip"), std::string::npos) << warning;
  }
  const auto expected = described.getTipPose(kQ), got = identified.getTipPose(kQ);
  EXPECT_LT((got.p - expected.p).norm(), 2e-3);
  EXPECT_LT((got.R - expected.R).norm(), 1e-6);
}

TEST(UR10, GivesTheCurrentsOfTheReferenceImplementation) {
  InverseDynamicsSolverUR10 solver;
  solver.initialize();
  const Eigen::VectorXd K = solver.getDriveGainsMatrix().diagonal();
  const std::vector<YAML::Node> states = referenceStates("ur10.json");
  ASSERT_FALSE(states.empty());
  for (std::size_t k = 0; k < states.size(); ++k) {
    const YAML::Node& state = states[k];
    const std::string where = "state " + std::to_string(k);
    const Eigen::VectorXd q = numbersOf(state["q"]), qd = numbersOf(state["qd"]);
    const Eigen::VectorXd qdd = numbersOf(state["qdd"]);

    const Eigen::VectorXd friction = solver.getFrictionVector(qd).cwiseQuotient(K);
    expectEntry(state, "current_friction", friction, kTolerance, where);
    expectEntry(state, "current_rigid", solver.getCurrents(q, qd, qdd) - friction, kTolerance,
                where);
  }
}

TEST(UR10, OffersMotorCurrentsAsAPlugin) {
  const inverse_dynamics_solver::SolverLoader loader;
  const auto solver = loader.load(kPlugin);
  const auto* motors = dynamic_cast<const MotorCurrents*>(solver.get());
  ASSERT_NE(motors, nullptr);
  EXPECT_THROW(motors->getDriveGainsMatrix(), UninitializedException);
  try {
    motors->getCurrents(kQ, kQd, kQdd);
    FAIL() << "expected an error";
  } catch (const UninitializedException& e) {
    EXPECT_EQ(std::string(e.what()).rfind("getCurrents", 0), 0U) << e.what();
  }
  solver->initialize();
  const Vector6d gains = vector6(13.5841, 14.2959, 11.3716, 11.2408, 11.7681, 11.7682);
  const Matrix6d K = gains.asDiagonal();
  EXPECT_EQ(motors->getDriveGainsMatrix(), K);
  const Vector6d tau = solver->getTorques(kQ, kQd, kQdd);
  EXPECT_TRUE((K * motors->getCurrents(kQ, kQd, kQdd)).isApprox(tau, 1e-14));
}

TEST(UR10, JointsAreThoseOfTheRobot) {
  InverseDynamicsSolverUR10 solver;
  solver.initialize();
  EXPECT_EQ(solver.jointCount(), NUMBER_OF_JOINTS);
  EXPECT_EQ(solver.jointNames(),
            (std::vector<std::string>{"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                                      "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"}));
}

TEST(UR10, InertiaIsNotPhysicalAndTheWarningSaysSo) {
  InverseDynamicsSolverUR10 solver;
  solver.initialize();
  EXPECT_FALSE(solver.inertiaIsPhysical());
  const Matrix6d H = solver.getInertiaMatrix(kQ);
  EXPECT_GT((H - H.transpose()).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT(H(4, 4), 0);
  ASSERT_EQ(solver.warnings().size(), 1U);
  EXPECT_NE(solver.warnings().front().find("unfit for forward dynamics"), std::string::npos);
}

TEST(UR10, IgnoresARobotDescription) {
  InverseDynamicsSolverUR10 alone, beside;
  alone.initialize();
  beside.initialize({{"root", std::string("base")}, {"tip", std::string("hand")}}, "",
                    "<not a URDF");
  EXPECT_EQ(beside.getTorques(kQ, kQd, kQdd), alone.getTorques(kQ, kQd, kQdd));
}

/// A prefix with a package inverse_dynamics_robots of its own, first in the search path.
class Overlay {
 public:
  explicit Overlay(const std::string& model_text)
      : prefix_(std::filesystem::path(::testing::TempDir()) / "ur10_overlay"),
        before_(std::getenv("AMENT_PREFIX_PATH")) {
    const auto share = prefix_ / "share";
    std::filesystem::create_directories(share / "ament_index/resource_index/packages");
    std::ofstream(share / "ament_index/resource_index/packages/inverse_dynamics_robots") << "";
    std::filesystem::create_directories(share / "inverse_dynamics_robots/models");
    if (!model_text.empty()) {
      std::ofstream(share / "inverse_dynamics_robots/models/ur10_identified.yaml") << model_text;
    }
    setenv("AMENT_PREFIX_PATH", (prefix_.string() + ":" + before_).c_str(), 1);
  }
  ~Overlay() {
    setenv("AMENT_PREFIX_PATH", before_.c_str(), 1);
    std::filesystem::remove_all(prefix_);
  }
  Overlay(const Overlay&) = delete;
  Overlay& operator=(const Overlay&) = delete;

 private:
  std::filesystem::path prefix_;
  std::string before_;
};

std::string initializationError() {
  InverseDynamicsSolverUR10 solver;
  try {
    solver.initialize();
  } catch (const Exception& e) {
    EXPECT_FALSE(solver.isInitialized());
    return e.what();
  }
  return "no error";
}

TEST(UR10, MissingModelFileIsNamed) {
  const Overlay empty("");
  const std::string error = initializationError();
  EXPECT_NE(error.find("ur10_identified"), std::string::npos) << error;
  EXPECT_NE(error.find("not found"), std::string::npos) << error;
}

TEST(UR10, ModelOfAnotherRobotIsRefused) {
  using inverse_dynamics_solver::conformance::robotsFile;
  using inverse_dynamics_solver::conformance::textOf;
  const Overlay panda(textOf(robotsFile("models/franka_gaz2019_feasible.yaml")));
  const std::string error = initializationError();
  EXPECT_NE(error.find("not a UR10's: expected 6 joints with a drive gain each, got 7 joints, 0"),
            std::string::npos)
      << error;
}

}  // namespace ur10_inverse_dynamics_solver::ur10_inverse_dynamics_solver_test

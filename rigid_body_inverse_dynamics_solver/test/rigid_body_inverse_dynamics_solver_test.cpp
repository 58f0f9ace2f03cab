// SPDX-License-Identifier: Apache-2.0
#include "rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/solver_loader.hpp"
#include "rigid_body_inverse_dynamics_solver/model_files.hpp"

namespace rigid_body_inverse_dynamics_solver {
namespace {

using inverse_dynamics_solver::Exception;
using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::ParameterUninitializedException;
using inverse_dynamics_solver::conformance::robotsFile;
using inverse_dynamics_solver::conformance::textOf;

const std::string kFeasible = "franka_gaz2019_feasible";
const std::string kUr10 = "ur10_identified";

/// The text of the E that `call` throws; a failure if it throws nothing or something else.
template <class E, class Call>
std::string errorOf(Call call) {
  try {
    call();
  } catch (const E& e) {
    return e.what();
  } catch (const std::exception& e) {
    ADD_FAILURE() << "another exception than promised: " << e.what();
    return "";
  }
  ADD_FAILURE() << "no exception";
  return "";
}

void expectContains(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is missing in: " << text;
  }
}

/// A text with one part replaced, which must be there.
std::string replaced(std::string text, const std::string& part, const std::string& by) {
  const std::size_t at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  return at == std::string::npos ? text : text.replace(at, part.size(), by);
}

/// A file that is gone at the end of the test.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& name, const std::string& text)
      : path_(std::filesystem::path(::testing::TempDir()) / name) {
    std::ofstream(path_) << text;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

/// The environment variable AMENT_PREFIX_PATH, changed until the end of the test.
class PrefixPath {
 public:
  explicit PrefixPath(const std::string& value) : before_(std::getenv("AMENT_PREFIX_PATH")) {
    setenv("AMENT_PREFIX_PATH", value.c_str(), 1);
  }
  ~PrefixPath() { setenv("AMENT_PREFIX_PATH", before_.c_str(), 1); }
  PrefixPath(const PrefixPath&) = delete;
  PrefixPath& operator=(const PrefixPath&) = delete;

 private:
  std::string before_;
};

Eigen::VectorXd ramp(Eigen::Index n, double first, double step) {
  return Eigen::VectorXd::LinSpaced(n, first, first + step * static_cast<double>(n - 1));
}

TEST(RigidBody, IsLoadedByName) {
  const inverse_dynamics_solver::SolverLoader loader;
  const std::string name = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody";
  const auto solver = loader.load(name);
  solver->initialize({}, "", textOf(robotsFile("urdf/panda.urdf")));
  EXPECT_EQ(solver->jointCount(), 7);
  EXPECT_NE(loader.description(name).find("URDF"), std::string::npos);
}

TEST(RigidBody, ModelCanBeNamedOrGivenByItsPath) {
  InverseDynamicsSolverRigidBody by_name, by_path, by_file_name;
  by_name.initialize({{"model", kFeasible}});
  by_path.initialize({{"model", robotsFile("models/" + kFeasible + ".yaml")}});
  const std::filesystem::path here = std::filesystem::current_path();
  std::filesystem::current_path(robotsFile("models"));
  by_file_name.initialize({{"model", kFeasible + ".yaml"}});
  std::filesystem::current_path(here);
  const Eigen::VectorXd q = ramp(7, -1.0, 0.4), qd = ramp(7, 0.5, -0.2), qdd = ramp(7, 2.0, 0.1);
  EXPECT_EQ(by_name.jointNames(), by_path.jointNames());
  EXPECT_EQ(by_name.getTorques(q, qd, qdd), by_path.getTorques(q, qd, qdd));
  EXPECT_EQ(by_name.getTorques(q, qd, qdd), by_file_name.getTorques(q, qd, qdd));
}

TEST(RigidBody, ModelFileGoesBeforeTheRobotDescription) {
  InverseDynamicsSolverRigidBody alone, beside;
  alone.initialize({{"model", kUr10}});
  beside.initialize({{"ids.model", kUr10}, {"robot_description", std::string("<not a URDF")}},
                    "ids", "<neither is this");
  const Eigen::VectorXd q = ramp(6, -1.0, 0.4);
  EXPECT_EQ(beside.getGravityVector(q), alone.getGravityVector(q));
}

TEST(RigidBody, ParametersWithoutMeaningBesideAModelFileAreMentioned) {
  InverseDynamicsSolverRigidBody solver;
  solver.initialize({{"ids.model", kFeasible}, {"ids.tip", std::string("fer_link8")}}, "ids");
  ASSERT_EQ(solver.warnings().size(), 1U);
  expectContains(solver.warnings().front(), {"'ids.tip'", "isn't used"});
  solver.initialize({{"model", kFeasible}});
  EXPECT_TRUE(solver.warnings().empty());
}

TEST(RigidBody, GravityOfTheModelFileIsReplacedOnlyWhereAnotherIsGiven) {
  // Without its check rows, which hold for the gravity that it states.
  const std::string text = textOf(robotsFile("models/" + kFeasible + ".yaml"));
  const std::string upright = text.substr(0, text.find("\nchecks:") + 1);
  const TemporaryFile file("hanging.yaml",
                           replaced(upright, "gravity: [0, 0, -9.81]", "gravity: [0, 0, 9.81]"));
  InverseDynamicsSolverRigidBody hanging, standing, weightless;
  standing.initialize({{"model", kFeasible}});
  const Eigen::VectorXd q = ramp(7, -1.0, 0.4);
  const Eigen::VectorXd g = standing.getGravityVector(q);
  ASSERT_GT(g.norm(), 1.0);

  hanging.initialize({{"model", file.path()}});
  EXPECT_TRUE(hanging.getGravityVector(q).isApprox(-g, 1e-14));
  hanging.initialize({{"model", file.path()}, {"gravity", std::vector<double>{0, 0, -9.81}}});
  EXPECT_EQ(hanging.getGravityVector(q), g);
  weightless.initialize({{"model", kFeasible}, {"gravity", std::vector<double>{0, 0, 0}}});
  EXPECT_EQ(weightless.getGravityVector(q), Eigen::VectorXd::Zero(7));
}

TEST(RigidBody, FrictionIsTheModelFilesAndCanBeSwitchedOff) {
  InverseDynamicsSolverRigidBody with, without, described;
  with.initialize({{"model", kUr10}});
  without.initialize({{"model", kUr10}, {"friction", false}});
  described.initialize({}, "", textOf(robotsFile("urdf/panda.urdf")));
  const Eigen::VectorXd q = ramp(6, -1.0, 0.4), qd = ramp(6, 0.5, -0.2), qdd = ramp(6, 2.0, 0.1);
  const Eigen::VectorXd f = with.getFrictionVector(qd);
  EXPECT_GT(f.norm(), 1.0);
  EXPECT_EQ(without.getFrictionVector(qd), Eigen::VectorXd::Zero(6));
  EXPECT_TRUE((without.getTorques(q, qd, qdd) + f).isApprox(with.getTorques(q, qd, qdd), 1e-14));

  // A URDF's <dynamics damping friction> isn't a friction model.
  EXPECT_EQ(described.getFrictionVector(ramp(7, 0.5, -0.2)), Eigen::VectorXd::Zero(7));
}

TEST(RigidBody, SaysWhoseInertiaIsPhysical) {
  InverseDynamicsSolverRigidBody solver;
  solver.initialize({{"model", kFeasible}});
  EXPECT_TRUE(solver.inertiaIsPhysical());
  solver.initialize({{"model", kUr10}});
  EXPECT_FALSE(solver.inertiaIsPhysical());
  ASSERT_EQ(solver.warnings().size(), 1U);
  expectContains(solver.warnings().front(), {kUr10, "unfit for forward dynamics"});

  // fer_link4 breaks the triangle inequality: odd, but H stays positive definite.
  solver.initialize({}, "", textOf(robotsFile("urdf/panda.urdf")));
  EXPECT_TRUE(solver.inertiaIsPhysical());
  ASSERT_EQ(solver.warnings().size(), 1U);
  expectContains(solver.warnings().front(), {"joint4"});
}

TEST(RigidBody, NamesTheLinkOfADescriptionWhoseInertiaIsNotPhysical) {
  InverseDynamicsSolverRigidBody solver;
  solver.initialize({}, "", R"(<robot name="arm"><link name="base"/>
    <link name="bob"><inertial><mass value="1"/>
      <inertia ixx="0.1" iyy="-5" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="hinge" type="continuous"><parent link="base"/><child link="bob"/>
      <axis xyz="0 1 0"/></joint></robot>)");
  EXPECT_FALSE(solver.inertiaIsPhysical());
  ASSERT_EQ(solver.warnings().size(), 2U);
  expectContains(solver.warnings()[0],
                 {"URDF:2: link bob, moved by joint hinge", "[-5, 0.1, 0.1]"});
  expectContains(solver.warnings()[1], {"model arm", "unfit for forward dynamics"});
}

TEST(RigidBody, NeitherDescriptionNorModelIsAnErrorThatNamesBoth) {
  InverseDynamicsSolverRigidBody solver;
  const std::string error =
      errorOf<ParameterUninitializedException>([&] { solver.initialize({}, "ids"); });
  expectContains(error, {"robot description: missing", "'robot_description'", "'ids.model'"});
  EXPECT_FALSE(solver.isInitialized());
}

TEST(RigidBody, UnknownModelIsAnErrorThatListsTheInstalledOnes) {
  InverseDynamicsSolverRigidBody solver;
  const std::string error = errorOf<InvalidParameterValueException>([&] {
    solver.initialize({{"ids.model", std::string("ur100_identified")}}, "ids");
  });
  expectContains(error, {"parameter 'ids.model'", "ur100_identified", kUr10, kFeasible,
                         "franka_inria_identified"});
}

TEST(RigidBody, MissingModelFileIsAnErrorWithItsPath) {
  InverseDynamicsSolverRigidBody solver;
  for (const std::string path : {"no_such_folder/robot", "robot.yaml", "ur10_identified.yaml"}) {
    const std::string error = errorOf<InvalidParameterValueException>([&] {
      solver.initialize({{"model", path}});
    });
    expectContains(error, {"parameter 'model'", "'" + path + "'", "not found", kUr10});
  }
}

TEST(RigidBody, MistakeInAModelFileIsReportedWithFileAndLine) {
  const std::string text = textOf(robotsFile("models/" + kFeasible + ".yaml"));
  const TemporaryFile file("mistake.yaml",
                           replaced(text, "\ngravity:", "\ngravitation: 1\ngravity:"));
  InverseDynamicsSolverRigidBody solver;
  const std::string error = errorOf<InvalidParameterValueException>([&] {
    solver.initialize({{"model", file.path()}});
  });
  expectContains(error, {"parameter 'model'", "mistake.yaml:", "gravitation"});
}

TEST(RigidBody, ModelParameterOfAnotherTypeIsAnError) {
  InverseDynamicsSolverRigidBody solver;
  const std::string error = errorOf<InvalidParameterValueException>([&] {
    solver.initialize({{"model", 3.0}});
  });
  expectContains(error, {"model", "string", "double"});
}

TEST(RigidBody, AbsentDataPackageIsAnErrorThatSaysWhatToSource) {
  const PrefixPath nowhere("/nowhere");
  InverseDynamicsSolverRigidBody solver;
  const std::string error = errorOf<Exception>([&] { solver.initialize({{"model", kUr10}}); });
  expectContains(error, {"package inverse_dynamics_robots", "not found", "local_setup.bash"});
}

TEST(RigidBody, DescriptionMistakesKeepTheirText) {
  InverseDynamicsSolverRigidBody solver;
  const std::string error = errorOf<inverse_dynamics_solver::InvalidRobotDescriptionException>([&] {
    solver.initialize({{"tip", std::string("hand")}}, "", textOf(robotsFile("urdf/panda.urdf")));
  });
  expectContains(error, {"robot description", "hand"});
}

TEST(ModelFiles, InstalledModelsAreTheThreeOfTheProject) {
  EXPECT_EQ(installedModels(),
            (std::vector<std::string>{kFeasible, "franka_inria_identified", kUr10}));
}

}  // namespace
}  // namespace rigid_body_inverse_dynamics_solver

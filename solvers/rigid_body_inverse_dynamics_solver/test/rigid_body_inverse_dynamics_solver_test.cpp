// SPDX-License-Identifier: Apache-2.0
#include "rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/model.hpp"
#include "chain_dynamics/model_file.hpp"
#include "chain_dynamics/urdf.hpp"
#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"
#include "inverse_dynamics_solver/conformance/two_arms.hpp"
#include "inverse_dynamics_solver/exceptions.hpp"
#include "inverse_dynamics_solver/external_wrench.hpp"
#include "inverse_dynamics_solver/kinematics.hpp"
#include "inverse_dynamics_solver/parameters.hpp"
#include "inverse_dynamics_solver/payload.hpp"
#include "rigid_body_inverse_dynamics_solver/model_files.hpp"

namespace rigid_body_inverse_dynamics_solver::rigid_body_inverse_dynamics_solver_test {

using inverse_dynamics_solver::Exception;
using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::ParameterUninitializedException;
using inverse_dynamics_solver::conformance::errorOf;
using inverse_dynamics_solver::conformance::robotsFile;
using inverse_dynamics_solver::conformance::textOf;

const std::string kFeasible = "franka_gaz2019_feasible";
const std::string kUr10 = "ur10_identified";

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
  const inverse_dynamics_solver::Parameters parameters = {
      {"ids.model", kFeasible},          {"ids.tip", "fer_link8"},
      {"ids.locked_joints.finger", 0.0}, {"ids.allow_massless", true},
      {"ids.attached", "lump"},          {"ids.urdf_friction", true},
      {"ids.rotor_inertia", true},       {"ids.rotor_inertia.fer_joint1", 0.1}};
  solver.initialize(parameters.strict(), "ids");
  const std::vector<std::string> names = {
      "allow_massless", "urdf_friction",        "rotor_inertia",           "tip",
      "attached",       "locked_joints.finger", "rotor_inertia.fer_joint1"};
  ASSERT_EQ(solver.warnings().size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(solver.warnings()[i],
              "parameter 'ids." + names[i] + "' isn't used: the model states its chain itself");
  }
  solver.initialize({{"model", kFeasible}});
  EXPECT_TRUE(solver.warnings().empty());
}

/// The arm without hand is that of the model; the hand adds a body beyond its last joint.
TEST(RigidBody, BodiesThatADescriptionAttachesToAModelAreMentioned) {
  const std::string arm = textOf(robotsFile("urdf/panda.urdf"));
  const std::string with_hand =
      replaced(arm, "</robot>",
               "<link name='hand'><inertial><mass value='0.73'/><inertia ixx='0.001' iyy='0.001' "
               "izz='0.001' ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='hand_joint' "
               "type='fixed'><parent link='fer_link8'/><child link='hand'/></joint></robot>");
  InverseDynamicsSolverRigidBody solver;
  solver.initialize({{"model", kFeasible}, {"tip", "fer_link8"}}, "", arm);
  EXPECT_TRUE(solver.warnings().empty()) << solver.warnings().front();

  solver.initialize({{"model", kFeasible}}, "", with_hand);
  ASSERT_EQ(solver.warnings().size(), 1U);
  EXPECT_EQ(solver.warnings().front(),
            "the robot description attaches bodies that model franka_gaz2019_feasible doesn't "
            "include in its torques: hand (0.73 kg); set parameters 'payload.NAME.mass' and so on, "
            "or call setPayload(), to add them; if it was identified with them, set 'attached' to "
            "ignore");
  solver.initialize({{"model", kFeasible}, {"attached", "ignore"}}, "", with_hand);
  EXPECT_TRUE(solver.warnings().empty());

  // Another robot's, or a tip that there isn't.
  solver.initialize({{"model", kFeasible}}, "", textOf(robotsFile("urdf/ur10.urdf")));
  ASSERT_EQ(solver.warnings().size(), 1U);
  expectContains(solver.warnings().front(), {"can't be compared with the model", "'fer_joint1'"});
  solver.initialize({{"model", kFeasible}, {"tip", "fer_link9"}}, "", arm);
  ASSERT_EQ(solver.warnings().size(), 1U);
  expectContains(solver.warnings().front(), {"can't be compared with the model", "'fer_link9'"});
  solver.initialize({{"model", kFeasible}, {"tip", "fer_link4"}}, "", arm);
  ASSERT_EQ(solver.warnings().size(), 1U);
  expectContains(solver.warnings().front(), {"root and tip have no effect", "fer_joint4, and"});

  // The right joints, but a tip that isn't the model's: 107 mm before the flange.
  solver.initialize({{"model", kFeasible}, {"tip", "fer_link7"}}, "", arm);
  ASSERT_EQ(solver.warnings().size(), 1U);
  expectContains(solver.warnings().front(),
                 {"root and tip have no effect", "0.107 m and 0.000 rad"});
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

/// A body of 2 kg that slides up and down, so that gravity asks for 2 9.81 N: friction is
/// 3 + 0.5 |g| N at 1 m/s, far from the step.
const char* const kLift =
    "schema: 2\nname: lift\nsource: worked by hand\nvalidity: a test\nunits: SI\n"
    "geometry: placements\ngravity: [0, 0, -9.81]\nparameters: about_center_of_mass\n"
    "joints:\n"
    "  - name: lift\n"
    "    type: prismatic\n"
    "    placement: {xyz: [0, 0, 0], rpy: [0, 0, 0], axis: [0, 0, 1]}\n"
    "    friction: {law: smooth_coulomb, fv: 0, fc: 3, width: 0.001, fl: 0.5}\n"
    "    torque_deviation: 0.75\n"
    "    seen: {q: [-1, 1], qd: [-2, 2], qdd: [-3, 4]}\n"
    "    link: [2, 0, 0, 0, 0.1, 0, 0, 0.1, 0, 0.1]\n";

TEST(RigidBody, LoadFrictionCountsPayloadAndGravityButNoWrench) {
  using inverse_dynamics_solver::RigidBody;
  using inverse_dynamics_solver::WrenchInRoot;
  const TemporaryFile file("lift.yaml", kLift);
  InverseDynamicsSolverRigidBody solver;
  solver.initialize({{"model", file.path()}});
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(1), qd = Eigen::VectorXd::Ones(1);
  const auto friction = [&] { return solver.getFrictionVector(q, qd)[0]; };
  const auto torque = [&] { return solver.getTorques(q, qd, q)[0]; };
  EXPECT_TRUE(solver.frictionDependsOnPosition());
  EXPECT_NEAR(friction(), 3 + 0.5 * 2 * 9.81, 1e-12);
  EXPECT_NEAR(torque(), 2 * 9.81 + 3 + 0.5 * 2 * 9.81, 1e-12);

  solver.setPayload("part", RigidBody{5.0});
  EXPECT_NEAR(friction(), 3 + 0.5 * 7 * 9.81, 1e-12);
  EXPECT_NEAR(torque(), 7 * 9.81 + 3 + 0.5 * 7 * 9.81, 1e-12);
  EXPECT_NEAR(solver.getTorquesBatch(q, qd, q)(0, 0), torque(), 1e-12);
  EXPECT_NEAR(solver.getAccelerations(q, qd, Eigen::VectorXd::Constant(1, torque()))[0], 0, 1e-12);

  // pressing down with 100 N
  const WrenchInRoot wrench{{0, 0, -100}, {0, 0, 0}};
  EXPECT_NEAR(solver.getTorques(q, qd, q, wrench)[0], torque() - 100, 1e-12);

  solver.setGravity({0, 0, 1.5});
  EXPECT_NEAR(friction(), 3 + 0.5 * 7 * 1.5, 1e-12);
  EXPECT_NEAR(torque(), -7 * 1.5 + 3 + 0.5 * 7 * 1.5, 1e-12);

  solver.initialize({{"model", file.path()}, {"friction", false}});
  EXPECT_FALSE(solver.frictionDependsOnPosition());
  EXPECT_EQ(solver.getFrictionVector(qd)[0], 0);
}

TEST(RigidBody, LoadFrictionWithoutPositionsIsRefused) {
  const TemporaryFile file("lift.yaml", kLift);
  InverseDynamicsSolverRigidBody solver;
  solver.initialize({{"model", file.path()}});
  const Eigen::VectorXd qd = Eigen::VectorXd::Ones(1);
  using inverse_dynamics_solver::SizeMismatchException;
  expectContains(errorOf<SizeMismatchException>([&] { solver.getFrictionVector(qd); }),
                 {"getFrictionVector: argument q: missing: expected 1 numbers, as friction depends "
                  "on the position, got 0; call getFrictionVector(q, qd)",
                  "the joints are lift"});
  expectContains(errorOf<SizeMismatchException>([&] { solver.getFrictionVectorBatch(qd); }),
                 {"getFrictionVectorBatch: argument q: missing"});
}

TEST(RigidBody, TorqueDeviationIsThatOfTheModelFile) {
  const TemporaryFile file("lift.yaml", kLift);
  InverseDynamicsSolverRigidBody stated, unknown;
  stated.initialize({{"model", file.path()}});
  unknown.initialize({{"model", kFeasible}});
  ASSERT_TRUE(stated.hasTorqueDeviation());
  EXPECT_EQ(stated.getTorqueDeviation(), Eigen::VectorXd::Constant(1, 0.75));
  ASSERT_EQ(stated.seenRanges().size(), 1U);
  EXPECT_EQ(stated.seenRanges()[0].qdd.upper, 4);
  EXPECT_FALSE(unknown.hasTorqueDeviation());
  EXPECT_TRUE(unknown.seenRanges().empty());
  expectContains(errorOf<Exception>([&] { unknown.getTorqueDeviation(); }),
                 {"getTorqueDeviation: not known: expected a model that states torque_deviation"});
}

TEST(RigidBody, FrictionOfADescriptionCanBeAskedFor) {
  const std::string urdf = textOf(robotsFile("urdf/panda.urdf"));  // 0.003 N m s/rad, 0.2 N m each
  InverseDynamicsSolverRigidBody without, with, off;
  without.initialize({}, "", urdf);
  with.initialize({{"urdf_friction", true}}, "", urdf);
  off.initialize({{"urdf_friction", true}, {"friction", false}}, "", urdf);
  const Eigen::VectorXd q = ramp(7, -1.0, 0.4), qd = ramp(7, 0.5, -0.25), qdd = ramp(7, 2.0, 0.1);
  ASSERT_EQ(qd[2], 0.0);
  Eigen::VectorXd f = 0.003 * qd;
  for (const int joint : {0, 1}) f[joint] += 0.2;
  for (const int joint : {3, 4, 5, 6}) f[joint] -= 0.2;
  EXPECT_TRUE(with.getFrictionVector(qd).isApprox(f, 1e-15)) << with.getFrictionVector(qd);
  EXPECT_TRUE(with.getTorques(q, qd, qdd).isApprox(without.getTorques(q, qd, qdd) + f, 1e-14));
  EXPECT_EQ(off.getFrictionVector(qd), Eigen::VectorXd::Zero(7));

  // Said where it is left out, and only there.
  const auto mentions = [](const InverseDynamicsSolverRigidBody& solver) {
    int count = 0;
    for (const std::string& warning : solver.warnings()) {
      count += warning.find("urdf_friction") != std::string::npos ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(mentions(without), 1);
  expectContains(without.warnings().back(),
                 {"(joints fer_joint1, fer_joint2, ", "isn't used; set parameter 'urdf_friction'"});
  EXPECT_EQ(mentions(with), 0);
  EXPECT_EQ(mentions(off), 0);

  // Zero damping and friction is what the description of the UR10 states.
  InverseDynamicsSolverRigidBody ur10;
  ur10.initialize({}, "", textOf(robotsFile("urdf/ur10.urdf")));
  EXPECT_EQ(mentions(ur10), 0);
  ur10.initialize({{"urdf_friction", true}}, "", textOf(robotsFile("urdf/ur10.urdf")));
  EXPECT_EQ(mentions(ur10), 1);
}

TEST(RigidBody, ImplausiblePayloadAndGravityAreMentioned) {
  const std::string urdf = textOf(robotsFile("urdf/ur10.urdf"));
  const auto warnings = [&](const inverse_dynamics_solver::Parameters& parameters) {
    InverseDynamicsSolverRigidBody solver;
    solver.initialize(parameters, "", urdf);
    return solver.warnings();
  };
  using Numbers = std::vector<double>;
  const Numbers near = {0.0, 0.0, -0.05}, far = {0.0, 0.0, -50.0};  // m, and mm taken for m
  EXPECT_TRUE(warnings({{"payload.mass", 0.5}, {"payload.center_of_mass", near}}).empty());
  EXPECT_EQ(warnings({{"payload.mass", 0.5}, {"payload.center_of_mass", far}}),
            std::vector<std::string>{"a payload of 0.5 kg is implausible: its center of mass is 50 "
                                     "m from the tip; check the units (kg, m, kg m^2)"});
  const Numbers gram_mm2 = {1e3, 0.0, 0.0, 1e3, 0.0, 1e3};
  const auto of_tool = warnings({{"payload.tool.mass", 2.0}, {"payload.tool.inertia", gram_mm2}});
  ASSERT_EQ(of_tool.size(), 1U);
  expectContains(of_tool.front(), {"a payload of 2 kg", "radius of gyration is 27.39 m"});

  EXPECT_TRUE(warnings({{"gravity", Numbers{0.0, 0.0, 0.0}}}).empty());
  EXPECT_TRUE(warnings({{"gravity", Numbers{0.0, -1.62, 0.0}}}).empty());
  for (const double number : {981.0, 9806.65, 1.0}) {
    const auto found = warnings({{"gravity", Numbers{0.0, 0.0, -number}}});
    ASSERT_FALSE(found.empty()) << number;  // efforts below gravity are another one
    expectContains(found.back(), {"m/s^2 is implausible; check its unit"});
  }
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
  ASSERT_EQ(solver.warnings().size(), 2U);
  expectContains(solver.warnings()[0], {"joint4"});
  expectContains(solver.warnings()[1], {"<dynamics>"});
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

TEST(RigidBody, ChainOfMoreThan64JointsIsRefused) {
  const auto snake = [](int joints) {
    std::string urdf = "<robot name='snake'><link name='l0'/>";
    for (int i = 1; i <= joints; ++i) {
      const std::string child = "l" + std::to_string(i), parent = "l" + std::to_string(i - 1);
      urdf += "<link name='" + child +
              "'><inertial><mass value='0.3'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' "
              "ixz='0' iyz='0'/></inertial></link><joint name='j" +
              std::to_string(i) + "' type='continuous'><parent link='" + parent +
              "'/><child link='" + child + "'/><origin xyz='0 0 0.1'/><axis xyz='1 0 0'/></joint>";
    }
    return urdf + "</robot>";
  };
  InverseDynamicsSolverRigidBody solver;
  EXPECT_NO_THROW(solver.initialize({}, "", snake(64)));
  const std::string error = errorOf<inverse_dynamics_solver::InvalidRobotDescriptionException>(
      [&] { solver.initialize({}, "", snake(65)); });
  expectContains(error, {"joints", "64", "65", "Pinocchio"});
}

TEST(ModelFiles, InstalledModelsAreThoseOfTheProjectAndAllAreRead) {
  const std::vector<std::string> models = installedModels();
  for (const std::string& name : {kFeasible, std::string("franka_inria_identified"), kUr10}) {
    EXPECT_NE(std::find(models.begin(), models.end(), name), models.end()) << name;
  }
  for (const std::string& name : models) EXPECT_EQ(readModel(name).name, name);
}

// ---------------------------------------------------------------------------------------------
// Trees

using inverse_dynamics_solver::Kinematics;
using inverse_dynamics_solver::RigidBody;
using inverse_dynamics_solver::WrenchInTip;
using inverse_dynamics_solver::conformance::ParameterMap;
using inverse_dynamics_solver::conformance::twoArms;
using Names = std::vector<std::string>;

InverseDynamicsSolverRigidBody& initialized(InverseDynamicsSolverRigidBody& solver,
                                            const ParameterMap& parameters,
                                            const std::string& urdf = twoArms()) {
  solver.initialize(parameters, "", urdf);
  return solver;
}

std::string treeError(const ParameterMap& parameters, const std::string& urdf = twoArms()) {
  InverseDynamicsSolverRigidBody solver;
  return errorOf<Exception>([&] { solver.initialize(parameters, "", urdf); });
}

TEST(Trees, HaveTheJointsThatMimicNoOtherInTheOrderOfTheDescription) {
  InverseDynamicsSolverRigidBody solver;
  initialized(solver, {{"tip", std::string("*")}});
  EXPECT_EQ(solver.jointNames(),
            (Names{"lift_joint", "chest_joint", "left_shoulder_joint", "left_elbow_joint",
                   "left_hand_joint", "right_shoulder_joint", "right_elbow_joint",
                   "right_hand_joint", "left_finger_joint"}));
  EXPECT_EQ(solver.tipNames(), (Names{"right_tool", "left_finger", "left_other_finger"}));
  EXPECT_EQ(solver.linkCount(), 10);
  EXPECT_EQ(solver.jointTypes()[3], chain_dynamics::JointType::kContinuous);
  EXPECT_TRUE(solver.inertiaIsPhysical());
}

TEST(Trees, TakeTheirTipsFromAListOrATextWithCommas) {
  InverseDynamicsSolverRigidBody list, text;
  initialized(list, {{"tip", Names{"left_tool", "right_tool"}}});
  initialized(text, {{"tip", std::string("left_tool, right_tool")}});
  EXPECT_EQ(list.jointCount(), 8);
  EXPECT_EQ(list.tipNames(), text.tipNames());
  const Eigen::VectorXd q = ramp(8, -0.4, 0.3);
  EXPECT_EQ(list.getTorques(q, q, q), text.getTorques(q, q, q));
}

TEST(Trees, OfOneTipAreTheChainBitForBit) {
  InverseDynamicsSolverRigidBody chain, list;
  initialized(chain, {{"tip", std::string("right_tool")}});
  initialized(list, {{"tip", Names{"right_tool"}}});
  EXPECT_EQ(list.tipNames(), Names{"right_tool"});
  const Eigen::VectorXd q = ramp(5, -0.4, 0.3);
  EXPECT_EQ(chain.getTorques(q, q, q), list.getTorques(q, q, q));
  const chain_dynamics::Chain expected =
      chain_dynamics::chainFromUrdf(twoArms(), {"", "right_tool", {}, true, false, {}, {}});
  const chain_dynamics::FastModel fast{chain_dynamics::Model(expected)};
  Eigen::VectorXd tau(5);
  fast.torques(q.data(), q.data(), q.data(), tau.data());
  EXPECT_EQ(list.getTorques(q, q, q), tau);
}

TEST(Trees, ComeFromAModelFileUnderAnyGravity) {
  const chain_dynamics::Model model(
      chain_dynamics::mechanismFromUrdf(twoArms(), {"", "*", {}, true, false, {}, {}}));
  const TemporaryFile file("two_arms.yaml", chain_dynamics::modelFileText(model));
  const ParameterMap tilted = {{"tip", std::string("*")},
                               {"gravity", std::vector<double>{1, 2, -9}}};
  InverseDynamicsSolverRigidBody described, read;
  initialized(described, tilted);
  ParameterMap from_file = tilted;
  from_file["model"] = file.path();
  initialized(read, from_file);
  EXPECT_EQ(read.jointNames(), described.jointNames());
  EXPECT_EQ(read.tipNames(), described.tipNames());
  EXPECT_TRUE(read.warnings().empty()) << read.warnings().front();
  const Eigen::VectorXd q = ramp(9, -0.4, 0.3), tau = described.getTorques(q, q, q);
  EXPECT_LE((read.getTorques(q, q, q) - tau).norm(), 1e-12 * tau.norm());
}

TEST(Trees, MoveAnArmAsTheChainThatHoldsTheOther) {
  // the other arm at rest at zero, as the chain holds it
  InverseDynamicsSolverRigidBody tree, chain;
  initialized(tree, {{"tip", Names{"left_tool", "right_tool"}}});
  initialized(chain, {{"tip", std::string("right_tool")}});
  const std::vector<Eigen::Index> of_chain = {0, 1, 5, 6, 7};
  const Eigen::VectorXd q_chain = ramp(5, -0.4, 0.3);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(8);
  q(of_chain) = q_chain;
  const Eigen::VectorXd tau = tree.getTorques(q, q, q)(of_chain);
  EXPECT_LE((tau - chain.getTorques(q_chain, q_chain, q_chain)).norm(), 1e-12 * tau.norm());
  EXPECT_LE((tree.kinematicsOf("right_tool").getTipJacobian(q)(Eigen::all, of_chain) -
             chain.getTipJacobian(q_chain))
                .norm(),
            1e-12);
}

TEST(Trees, GiveKinematicsWrenchesAndPayloadsOfEachTip) {
  InverseDynamicsSolverRigidBody solver;
  initialized(solver, {{"tip", Names{"left_tool", "right_tool"}}});
  const Eigen::VectorXd q = ramp(8, -0.4, 0.3), qd = ramp(8, 0.5, -0.2), qdd = ramp(8, 1, 0.4);
  EXPECT_EQ(&solver.kinematicsOf("left_tool"), static_cast<const Kinematics*>(&solver));
  const Kinematics& right = solver.kinematicsOf("right_tool");
  const Eigen::MatrixXd J = right.getTipJacobian(q);
  EXPECT_TRUE(J.middleCols(2, 3).isZero(0));
  EXPECT_FALSE(J.middleCols(5, 3).isZero(1e-3));
  const WrenchInTip wrench{{1, 2, 3}, {0.1, 0.2, 0.3}};
  const Eigen::Matrix3d R = right.getTipPose(q).R;
  Eigen::VectorXd in_root(6);
  in_root << R * wrench.force, R * wrench.torque;
  const auto& contact = solver.externalWrenchAt("right_tool");
  EXPECT_LE((contact.getExternalTorques(q, wrench) - J.transpose() * in_root).norm(), 1e-12);
  EXPECT_LE((contact.getTorques(q, qd, qdd, wrench) - contact.getExternalTorques(q, wrench) -
             solver.getTorques(q, qd, qdd))
                .norm(),
            1e-12);

  // gravity of a point mass is its weight at the tip
  const Eigen::VectorXd bare = solver.getGravityVector(q);
  RigidBody part{2.0};
  part.tip = "right_tool";
  solver.setPayload("part", part);
  const Eigen::VectorXd weight = 2.0 * 9.81 * J.row(2).transpose();
  EXPECT_LE((solver.getGravityVector(q) - bare - weight).norm(), 1e-12 * weight.norm());
  part.tip = "tail";
  expectContains(errorOf<Exception>([&] { solver.setPayload("part", part); }),
                 {"payload 'part'", "tip", "left_tool, right_tool", "'tail'"});
  solver.clearPayloads();
  EXPECT_EQ(solver.getGravityVector(q), bare);
  expectContains(errorOf<Exception>([&] { solver.kinematicsOf("tail"); }),
                 {"kinematicsOf", "left_tool, right_tool", "'tail'"});

  InverseDynamicsSolverRigidBody with_parameters;
  initialized(with_parameters, {{"tip", Names{"left_tool", "right_tool"}},
                                {"payload.mass", 2.0},
                                {"payload.tip", std::string("right_tool")}});
  EXPECT_LE((with_parameters.getGravityVector(q) - bare - weight).norm(), 1e-12 * weight.norm());
}

TEST(Trees, NameTheirTipsAsChainsDo) {
  InverseDynamicsSolverRigidBody chain;
  initialized(chain, {{"tip", std::string("right_tool")}});
  EXPECT_EQ(&chain.kinematicsOf("right_tool"), static_cast<const Kinematics*>(&chain));
  EXPECT_EQ(&chain.externalWrenchAt("right_tool"),
            static_cast<const inverse_dynamics_solver::ExternalWrench*>(&chain));
  const Eigen::VectorXd q = ramp(5, -0.4, 0.3);
  RigidBody part{2.0};
  chain.setPayload("part", part);
  const Eigen::VectorXd carried = chain.getGravityVector(q);
  part.tip = "right_tool";
  chain.setPayload("part", part);
  EXPECT_EQ(chain.getGravityVector(q), carried);
  part.tip = "left_tool";
  expectContains(errorOf<Exception>([&] { chain.setPayload("part", part); }),
                 {"tip", "one of right_tool", "'left_tool'"});
  expectContains(errorOf<Exception>([&] { chain.kinematicsOf("left_tool"); }),
                 {"one of right_tool", "'left_tool'"});
}

TEST(Trees, AndChainsHaveTipsByTheNamesThatAreKnown) {
  InverseDynamicsSolverRigidBody solver;
  initialized(solver, {}, textOf(robotsFile("urdf/ur10.urdf")));
  EXPECT_EQ(solver.tipNames(), Names{"tool0"});
  initialized(solver, {{"model", std::string(kUr10)}, {"tip", std::string("flange")}}, "");
  EXPECT_EQ(solver.tipNames(), Names{"flange"});
  initialized(solver, {{"model", std::string(kUr10)}}, "");
  EXPECT_EQ(solver.tipNames(), Names{""});
  EXPECT_EQ(&solver.kinematicsOf(""), static_cast<const Kinematics*>(&solver));
  expectContains(errorOf<Exception>([&] { solver.kinematicsOf("tool0"); }), {"has no name"});
}

TEST(Trees, AddFrictionOfAFollowerToItsCoordinate) {
  InverseDynamicsSolverRigidBody solver;
  initialized(solver, {{"tip", std::string("*")}, {"urdf_friction", true}});
  const Eigen::VectorXd qd = Eigen::VectorXd::Constant(9, -0.5);
  const Eigen::VectorXd f = solver.getFrictionVector(qd);
  EXPECT_NEAR(f[7], -0.5 * 0.4 - 0.3, 1e-12);
  EXPECT_NEAR(f[8], -0.5 * 0.4 * (1 + 1.5 * 1.5) - 0.3 * (1 + 1.5), 1e-12);
}

TEST(Trees, AreRefusedByName) {
  const auto tips = [](const Names& names) { return ParameterMap{{"tip", names}}; };
  expectContains(treeError(tips({"left_tool", "head"})), {"tip", "'head'", "nearest names"});
  expectContains(treeError(tips({"left_tool", "left_tool"})), {"'left_tool' twice"});
  expectContains(treeError(tips({"left_tool", "base"})), {"at least one movable joint"});
  const std::string loop =
      replaced(twoArms("<mimic joint='left_finger_joint'/>"), "<child link='left_finger'/>",
               "<child link='left_finger'/><mimic joint='left_other_finger_joint'/>");
  expectContains(treeError(tips({"*"}), loop), {"left_finger_joint", "<mimic>", "follows itself"});
  expectContains(treeError(tips({"left_other_finger", "right_tool"})),
                 {"left_other_finger_joint", "<mimic>", "left_finger_joint", "add a tip"});
}

}  // namespace rigid_body_inverse_dynamics_solver::rigid_body_inverse_dynamics_solver_test

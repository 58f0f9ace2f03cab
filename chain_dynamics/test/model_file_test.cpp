// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/model_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <locale>
#include <string>

#include "chain_dynamics/urdf.hpp"
#include "reference.hpp"

namespace chain_dynamics {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// Two ways of rounding through the same few hundred operations on figures below 100.
constexpr double kRounding = 1e-12;

const std::string kRobots = CHAIN_DYNAMICS_ROBOTS_DIR;

double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

std::string replaced(std::string text, const std::string& old_part, const std::string& new_part) {
  const std::size_t at = text.find(old_part);
  EXPECT_NE(at, std::string::npos) << "no '" << old_part << "' in:\n" << text;
  return at == std::string::npos ? text : text.replace(at, old_part.size(), new_part);
}

/// The file that docs/model_file.md shows.
std::string documentedFile() {
  const std::string page = textOf(CHAIN_DYNAMICS_DOCS_DIR "/model_file.md");
  const std::string fence = "```yaml\n";
  const std::size_t begin = page.find(fence) + fence.size();
  return page.substr(begin, page.find("```", begin) - begin);
}

/// A model of one or more joints in schema 1, without check rows.
std::string file(const std::string& geometry, const std::string& joints,
                 const std::string& more = "") {
  return "schema: 1\nname: arm\nsource: made up\nvalidity: tests\nunits: SI\ngeometry: " +
         geometry + "\nparameters: about_origin\ngravity: [0, 0, -9.81]\n" + more + "joints:\n" +
         joints;
}

const char* const kLink = "[2, 0.2, 0.4, 0.6, 0.5, -0.03, -0.04, 0.6, -0.05, 0.7]";

std::string joint(const std::string& name, const std::string& content,
                  const std::string& type = "revolute") {
  return "- name: " + name + "\n  type: " + type + "\n  " + content + "\n";
}

std::string dh(const std::string& a, const std::string& alpha, const std::string& d,
               const std::string& offset) {
  return "dh: {a: " + a + ", alpha: " + alpha + ", d: " + d + ", offset: " + offset + "}\n";
}

std::string withLink(const std::string& content) { return content + "  link: " + kLink; }

Model model(const std::string& text) { return modelFromYaml(text, "arm.yaml"); }

std::string fileError(const std::string& text) {
  return errorOf([&] { modelFromYaml(text, "arm.yaml"); });
}

Eigen::VectorXd someTorques(const Model& robot) {
  const Eigen::Index n = robot.chain.jointCount();
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(n, 0.3, 1.1);
  const Eigen::VectorXd qd = Eigen::VectorXd::LinSpaced(n, -1.2, 2.0);
  const Eigen::VectorXd qdd = Eigen::VectorXd::LinSpaced(n, 3.0, -2.0);
  Eigen::VectorXd tau(n);
  torques(robot, q, qd, qdd, tau);
  return tau;
}

// --- what a file means ---

TEST(ModelFile, DocumentedFileIsReadAndItsCheckRowsHold) {
  const Model robot = model(documentedFile());
  EXPECT_EQ(robot.name, "cart_and_pendulum");
  EXPECT_EQ(robot.source, "worked by hand");
  EXPECT_THAT(robot.validity, HasSubstr("Newton"));
  EXPECT_THAT(robot.chain.jointNames(), ElementsAre("cart", "hinge"));
  EXPECT_EQ(robot.chain.joints()[0].type, JointType::kPrismatic);
  EXPECT_EQ(robot.chain.joints()[0].limits.effort, 100);
  EXPECT_EQ(robot.chain.joints()[1].type, JointType::kContinuous);
  EXPECT_EQ(robot.chain.joints()[1].limits.effort, std::numeric_limits<double>::infinity());
  EXPECT_EQ(robot.chain.joints()[1].rotor_inertia, 0.05);
  EXPECT_EQ(robot.friction.size(), 2U);
  EXPECT_EQ(robot.drive_gains.size(), 0);
  EXPECT_TRUE(robot.inertiaIsPhysical());
}

TEST(ModelFile, FailedCheckRowNamesRowAndJoint) {
  EXPECT_THAT(fileError(replaced(documentedFile(), "[10.9, 11.76]", "[10.9, 11.77]")),
              AllOf(StartsWith("arm.yaml:"),
                    HasSubstr("checks: states[1]: torque of joint hinge: expected the model's "
                              "torque, got one that is -0.01 off")));
  EXPECT_THAT(fileError(replaced(documentedFile(), "1.5, fo: 0", "1.4, fo: 0")),
              HasSubstr("torque of joint cart"));
}

// Poses of the last link by the textbook's product of four motions, one state.
Eigen::Isometry3d textbookPose(bool modified, const std::vector<std::array<double, 4>>& rows,
                               const Eigen::VectorXd& q) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto [a, alpha, d, offset] = rows[i];
    const Eigen::AngleAxisd turn_x(alpha, Eigen::Vector3d::UnitX());
    const Eigen::AngleAxisd turn_z(offset + q[static_cast<Eigen::Index>(i)],
                                   Eigen::Vector3d::UnitZ());
    const Eigen::Translation3d shift_x(a, 0, 0);
    const Eigen::Translation3d shift_z(0, 0, d);
    X = modified ? X * turn_x * shift_x * turn_z * shift_z
                 : X * turn_z * shift_z * shift_x * turn_x;
  }
  return X;
}

// A point mass on the tip weighs what the tip's Jacobian says: gravity torque is m g dz/dq.
void expectGravityOfTextbook(const std::string& geometry, bool modified) {
  const std::vector<std::array<double, 4>> rows{
      {0.3, 0.4, 0.5, 0.6}, {-0.2, -1.1, 0.7, 0.1}, {0.25, 2.2, -0.35, -0.9}};
  std::string joints;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto text = [&](std::size_t k) { return std::to_string(rows[i][k]); };
    // mass 2 at (0.1, 0.2, 0.3) of the last link's frame: I = -m [c]x [c]x
    const std::string link = i + 1 < rows.size()
                                 ? "[0, 0, 0, 0, 0, 0, 0, 0, 0, 0]"
                                 : "[2, 0.2, 0.4, 0.6, 0.26, -0.04, -0.06, 0.2, -0.12, 0.1]";
    joints +=
        joint("j" + std::to_string(i), dh(text(0), text(1), text(2), text(3)) + "  link: " + link);
  }
  const Model robot = model(file(geometry, joints));

  constexpr double kStep = 1e-6;        // the error of a central difference is of its square,
  constexpr double kDifference = 1e-8;  // beside rounding / step
  const Eigen::Vector3d q(0.2, -0.7, 1.3);
  Eigen::VectorXd g(3);
  gravityVector(robot, q, g);
  for (Eigen::Index j = 0; j < 3; ++j) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(j);
    const Eigen::Vector3d mass(0.1, 0.2, 0.3);
    const double up = (textbookPose(modified, rows, q + step) * mass).z();
    const double down = (textbookPose(modified, rows, q - step) * mass).z();
    EXPECT_NEAR(g[j], 2 * 9.81 * (up - down) / (2 * kStep), kDifference) << "joint " << j;
  }
}

TEST(ModelFile, ModifiedDenavitHartenbergIsTheTextbooks) {
  expectGravityOfTextbook("modified_dh", true);
}

TEST(ModelFile, StandardDenavitHartenbergIsTheTextbooks) {
  expectGravityOfTextbook("standard_dh", false);
}

// Modified parameters with index i-1 are standard ones whose link frames stand at the far end: the
// same robot, if each link's parameters are moved along.
TEST(ModelFile, StandardAndModifiedDescribeTheSameRobot) {
  // standard: T_i = RotZ TransZ TransX(a_i) RotX(alpha_i); modified joint i has a, alpha of i-1
  const std::string standard = joint("one", withLink(dh("0.3", "0.4", "0.5", "0.6"))) +
                               joint("two", withLink(dh("-0.2", "-1.1", "0.7", "0.1")));
  const Model in_standard = model(file("standard_dh", standard));

  const auto moved = [](double a, double alpha) {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(alpha, Eigen::Vector3d::UnitX()).toRotationMatrix();
    Vector10<double> p;
    p << 2, 0.2, 0.4, 0.6, 0.5, -0.03, -0.04, 0.6, -0.05, 0.7;
    const Transform<double> X{R, Eigen::Vector3d(a, 0, 0)};
    const Vector10<double> q = (X * LinkParameters::fromVector(p)).toVector();
    std::ostringstream text;
    text.precision(17);
    for (Eigen::Index k = 0; k < 10; ++k) {
      text << (k == 0 ? "[" : ", ") << q[k];
    }
    return "  link: " + text.str() + "]";
  };
  const Model in_modified = model(
      file("modified_dh", joint("one", dh("0", "0", "0.5", "0.6") + moved(0.3, 0.4)) +
                              joint("two", dh("0.3", "0.4", "0.7", "0.1") + moved(-0.2, -1.1))));
  EXPECT_LT(difference(someTorques(in_standard), someTorques(in_modified)), kRounding);
}

// The same for a placement: RotX(alpha) TransX(a) TransZ(d) RotZ(offset), written out.
TEST(ModelFile, PlacementAndModifiedDescribeTheSameRobot) {
  const Model in_dh =
      model(file("modified_dh", joint("one", withLink(dh("0.3", "0.5", "0", "0")))));
  const Model placed = model(
      file("placements",
           joint("one",
                 withLink("placement: {xyz: [0.3, 0, 0], rpy: [0.5, 0, 0], axis: [0, 0, 1]}\n"))));
  EXPECT_LT(difference(someTorques(in_dh), someTorques(placed)), kRounding);
}

TEST(ModelFile, PlacementsMeanWhatTheyMeanInAUrdf) {
  const Model placed = model(replaced(
      file("placements",
           joint("one",
                 "placement: {xyz: [0.1, 0.2, 0.3], rpy: [0.4, 0.5, 0.6], axis: [1, -2, -3]}"
                 "\n  link: [2, 0.1, 0.2, 0.3, 0.1, 0.01, 0.02, 0.2, 0.03, 0.25]")),
      "about_origin", "about_center_of_mass"));
  const Model in_urdf(chainFromUrdf(R"(
    <robot name="arm"><link name="base"/>
      <link name="one"><inertial><origin xyz="0.1 0.2 0.3"/><mass value="2"/>
        <inertia ixx="0.1" ixy="0.01" ixz="0.02" iyy="0.2" iyz="0.03" izz="0.25"/></inertial></link>
      <joint name="one" type="continuous"><parent link="base"/><child link="one"/>
        <origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/><axis xyz="1 -2 -3"/></joint>
    </robot>)"));
  EXPECT_LT(difference(someTorques(placed), someTorques(in_urdf)), kRounding);
}

TEST(ModelFile, AxisOfAPlacementTurnsTheLinkFrameOnlyInside) {
  // about y of frame 1: the link's z component of mc and its Iyy, about the same origin
  const Model robot = model(file(
      "placements",
      joint("one", withLink("placement: {xyz: [0, 0, 1], rpy: [0, 0, 0], axis: [0, 2, 0]}\n"))));
  Eigen::MatrixXd H(1, 1);
  Eigen::VectorXd g(1);
  inertiaMatrix(robot, Eigen::VectorXd::Zero(1), H);
  gravityVector(robot, Eigen::VectorXd::Zero(1), g);
  EXPECT_NEAR(H(0, 0), 0.6, kRounding);
  EXPECT_NEAR(g[0], -9.81 * 0.2, kRounding);  // z falls by x when turning about y
}

TEST(ModelFile, PrismaticJointMovesAlongItsAxisInBothConventions) {
  for (const std::string geometry : {"modified_dh", "standard_dh"}) {
    const Model robot =
        model(file(geometry, joint("lift", withLink(dh("0.3", "0.4", "0.5", "0.6")), "prismatic")));
    Eigen::VectorXd g(1);
    gravityVector(robot, Eigen::VectorXd::Zero(1), g);
    // modified: the axis is tilted by alpha; standard: it is z of frame 0
    EXPECT_NEAR(g[0], 2 * 9.81 * (geometry == "modified_dh" ? std::cos(0.4) : 1), kRounding);
  }
}

TEST(ModelFile, TipIsGivenInTheLastLinksFrameOfTheFile) {
  const std::string tip = "tip: {xyz: [0.1, 0.2, 0.3], rpy: [0, 0, 0]}\n";
  const Model robot =
      model(file("standard_dh", joint("one", withLink(dh("0.4", "0.5", "0.6", "0.7"))), tip));
  const Transform<double> X = robot.chain.joints()[0].placement * robot.chain.tip();
  const Eigen::Vector3d expected =
      textbookPose(false, {{0.4, 0.5, 0.6, 0.7}}, Eigen::VectorXd::Zero(1)) *
      Eigen::Vector3d(0.1, 0.2, 0.3);
  EXPECT_LT(difference(X.p, expected), kRounding);
}

TEST(ModelFile, QuarterTurnsAreExactRightAngles) {
  const auto rotation = [](const std::string& angles) {
    const std::string text = "dh: {a: 0, d: 0, " + angles + "}\n  link: " + kLink;
    return model(file("modified_dh", joint("one", text))).chain.joints()[0].placement.R;
  };
  Eigen::Matrix3d x_up, x_down, z_half;
  x_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  x_down << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  z_half << -1, 0, 0, 0, -1, 0, 0, 0, 1;
  EXPECT_EQ(rotation("alpha_quarter_turns: 1, offset: 0"), x_up);
  EXPECT_EQ(rotation("alpha_quarter_turns: -1, offset: 0"), x_down);
  EXPECT_EQ(rotation("alpha_quarter_turns: 3, offset: 0"), x_down);
  EXPECT_EQ(rotation("alpha: 0, offset_quarter_turns: 2"), z_half);
  EXPECT_LT(difference(rotation("alpha: 1.5707963267948966, offset: 0"), x_up), 1e-15);
}

TEST(ModelFile, ParametersAboutTheCenterOfMassAreMovedToTheOrigin) {
  const std::string about_origin =
      file("modified_dh", joint("one", dh("0", "0.3", "0", "0") +
                                           "  link: [2, 0.2, 0.4, 0.6, 0.36, -0.04, -0.06, 0.4, "
                                           "-0.12, 0.4]"));
  // c = (0.1, 0.2, 0.3); -m [c]x [c]x = [0.26 -0.04 -0.06; . 0.2 -0.12; . . 0.1]
  const std::string about_center = replaced(
      file("modified_dh", joint("one", dh("0", "0.3", "0", "0") +
                                           "  link: [2, 0.1, 0.2, 0.3, 0.1, 0, 0, 0.2, 0, 0.3]")),
      "about_origin", "about_center_of_mass");
  EXPECT_LT(difference(model(about_origin).chain.links()[0].toVector(),
                       model(about_center).chain.links()[0].toVector()),
            kRounding);
}

/// Two joints identified in currents, each with a row of its own.
std::string rowsFile(const std::string& levels = "{parameters: current, friction: current}") {
  const auto row = [](const std::string& gain, const std::string& first,
                      const std::string& second) {
    return dh("0.1", "0.2", "0.3", "0.4") + "  drive_gain: " + gain +
           "\n  friction: {law: viscous_coulomb_offset, fv: 2, fc: 0, fo: 1}\n  row: [" + first +
           ", " + second + "]";
  };
  const std::string other = "[1, 0.3, 0.2, 0.1, 0.3, 0, 0, 0.3, 0, 0.3]";
  return file("standard_dh",
              joint("one", row("10", kLink, other)) + joint("two", row("5", other, kLink)),
              "levels: " + levels + "\n");
}

TEST(ModelFile, RowsAreThoseOfRobotsWithOneParameterSetEach) {
  const Model robot = model(rowsFile());
  const std::string other = "[1, 0.3, 0.2, 0.1, 0.3, 0, 0, 0.3, 0, 0.3]";
  const auto single = [](const std::string& first, const std::string& second) {
    const std::string geometry = dh("0.1", "0.2", "0.3", "0.4") + "  link: ";
    return model(
        file("standard_dh", joint("one", geometry + first) + joint("two", geometry + second)));
  };
  const Eigen::VectorXd tau = someTorques(robot);
  EXPECT_NEAR(tau[0], 10 * someTorques(single(kLink, other))[0], kRounding);
  EXPECT_NEAR(tau[1], 5 * someTorques(single(other, kLink))[1], kRounding);
  EXPECT_FALSE(robot.inertiaIsPhysical());
  EXPECT_EQ(robot.drive_gains, Eigen::Vector2d(10, 5));
}

TEST(ModelFile, LevelsSayWhatTheDriveGainsMultiply) {
  const Eigen::Vector2d qd(1, -1);
  Eigen::VectorXd f(2);
  frictionVector(model(rowsFile()), qd, f);
  EXPECT_EQ(f, Eigen::Vector2d(10 * (2 + 1), 5 * (-2 + 1)));  // gain (2 qd + 1)
  const Model in_torques = model(rowsFile("{parameters: torque, friction: torque}"));
  frictionVector(in_torques, qd, f);
  EXPECT_EQ(f, Eigen::Vector2d(3, -1));
  EXPECT_NEAR(someTorques(in_torques)[0], someTorques(model(rowsFile()))[0] / 10, kRounding);
}

// In a convention whose link frame isn't the chain's, so that moments must be moved.
TEST(ModelFile, GravityFirstMomentsReplaceThoseOfTheLinksInGravityOnly) {
  const std::string plain = joint("one", withLink(dh("0.3", "0.5", "0", "0")));
  const auto robot = [](const std::string& joints) {
    return model(replaced(file("standard_dh", joints), "[0, 0, -9.81]", "[0, -9.81, 0]"));
  };
  const Model with_own = robot(plain + "  gravity_first_moment: [0.5, 0.6, 0.7]\n");
  const Model without = robot(plain);
  const Model as_link = robot(replaced(plain, "0.2, 0.4, 0.6", "0.5, 0.6, 0.7"));
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.3);
  Eigen::VectorXd own(1), expected(1), other(1);
  gravityVector(with_own, q, own);
  gravityVector(as_link, q, expected);
  gravityVector(without, q, other);
  EXPECT_NEAR(own[0], expected[0], kRounding);
  EXPECT_GT(std::abs(own[0] - other[0]), 0.1);
  Eigen::MatrixXd H(1, 1), H_without(1, 1);
  inertiaMatrix(with_own, q, H);
  inertiaMatrix(without, q, H_without);
  EXPECT_EQ(H, H_without);
}

TEST(ModelFile, NumbersDoNotDependOnTheLocale) {
  struct DecimalComma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const Eigen::VectorXd plain = someTorques(model(documentedFile()));
  const std::locale before =
      std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  const std::string error = fileError(documentedFile());
  std::locale::global(before);
  EXPECT_EQ(error, "no error");
}

// --- other people's values ---

void expectReference(const std::string& model_file, const std::string& reference) {
  constexpr double kReference = 1e-10;  // greatest difference, in kg m^2, N m
  const Model robot = modelFromFile(kRobots + "/models/" + model_file);
  const Eigen::Index n = robot.chain.jointCount();
  const auto states = referenceStates(reference);
  ASSERT_EQ(states.size(), 25U);
  for (const ReferenceState& state : states) {
    Eigen::MatrixXd H(n, n);
    Eigen::VectorXd c(n), g(n), f(n), tau(n);
    dynamicComponents(robot, state.q, state.qd, H, c, g);
    frictionVector(robot, state.qd, f);
    torques(robot, state.q, state.qd, state.qdd, tau);
    EXPECT_LT(difference(H, state.H), kReference) << state.label;
    EXPECT_LT(difference(c, state.coriolis), kReference) << state.label;
    EXPECT_LT(difference(g, state.gravity), kReference) << state.label;
    EXPECT_LT(difference(f, state.friction), kReference) << state.label;
    EXPECT_LT(difference(tau + f, state.torques), kReference) << state.label;
  }
}

TEST(ModelFileReference, UR10IdentifiedIsTheSourcesModel) {
  expectReference("ur10_identified.yaml", "ur10.json");
}

TEST(ModelFileReference, FrankaInriaIdentifiedIsTheSourcesModel) {
  expectReference("franka_inria_identified.yaml", "franka_inria.json");
}

TEST(ModelFileReference, OnlyTheFeasibleModelIsPhysical) {
  EXPECT_FALSE(modelFromFile(kRobots + "/models/ur10_identified.yaml").inertiaIsPhysical());
  EXPECT_FALSE(modelFromFile(kRobots + "/models/franka_inria_identified.yaml").inertiaIsPhysical());
  const Model feasible = modelFromFile(kRobots + "/models/franka_gaz2019_feasible.yaml");
  EXPECT_TRUE(feasible.inertiaIsPhysical());
  EXPECT_TRUE(feasible.chain.warnings().empty());
}

// The file's figures must be those of the source, digit by digit.
TEST(ModelFileReference, FiguresAreThoseOfTheSource) {
  if (dataFolder().empty()) {
    GTEST_SKIP() << "IDS_DATA_DIR isn't set: it names the folder with models/*.yaml";
  }
  for (const std::string name : {"franka_gaz2019_feasible", "franka_inria_identified"}) {
    const YAML::Node source = YAML::LoadFile(dataFolder() + "/models/" + name + ".yaml");
    const Model robot = modelFromFile(kRobots + "/models/" + name + ".yaml");
    for (std::size_t i = 0; i < 7; ++i) {
      EXPECT_EQ(robot.chain.links()[i].toVector(), vectorOf(source["links"][i])) << name << i;
      EXPECT_EQ(robot.chain.joints()[i].limits.lower,
                source["limits"]["position_lower"][i].as<double>());
      EXPECT_EQ(robot.chain.joints()[i].limits.effort, source["limits"]["effort"][i].as<double>());
    }
  }
  const YAML::Node ur10 = YAML::LoadFile(dataFolder() + "/models/ur10_identified.yaml");
  const Model robot = modelFromFile(kRobots + "/models/ur10_identified.yaml");
  EXPECT_EQ(robot.drive_gains, vectorOf(ur10["drive_gains"]));
  for (std::size_t j = 0; j < 6; ++j) {
    for (std::size_t i = 0; i < 6; ++i) {
      const Eigen::VectorXd links = vectorOf(ur10["rows"][j]["links"][i]);
      EXPECT_LT(difference(robot.row_parameters[j][i].toVector(),
                           robot.drive_gains[static_cast<Eigen::Index>(j)] * links),
                1e-15)
          << j << " " << i;
    }
  }
}

// --- bad input ---

TEST(ModelFileError, FileThatCannotBeRead) {
  EXPECT_THAT(errorOf([] { modelFromFile("/no/such/model.yaml"); }),
              AllOf(HasSubstr("/no/such/model.yaml"), HasSubstr("a file that can be read")));
  EXPECT_THAT(errorOf([] { modelFromFile(kRobots); }), HasSubstr("got a directory"));
}

TEST(ModelFileError, TextThatIsNotOneYamlDocument) {
  EXPECT_THAT(fileError(""), HasSubstr("expected one YAML document, got an empty file"));
  EXPECT_THAT(fileError("# nothing\n"), HasSubstr("expected one YAML document, got an empty file"));
  EXPECT_THAT(fileError("a: 1\n---\nb: 2\n"), HasSubstr("expected one YAML document, got 2"));
  EXPECT_THAT(fileError("schema: 1\njoints: [1, 2\n"),
              AllOf(HasSubstr("arm.yaml:"), HasSubstr("expected well-formed YAML")));
  EXPECT_EQ(fileError("- 1\n- 2\n"),
            "arm.yaml:1: file: expected a map of keys and values, got a list of 2");
}

// yaml-cpp makes empty documents of these, without end.
TEST(ModelFileError, TablesAndOtherTextsAreNotReadForEver) {
  for (const std::string table : {",a\n", ",", "\"time\",\"q\"\n1,2\n", "'time','q'\n",
                                  "# heading\n\"time\", 1\n", "--- ,\n"}) {
    EXPECT_THAT(fileError(table), AllOf(StartsWith("arm.yaml:"), HasSubstr("expected one YAML "
                                                                           "document, got a text "
                                                                           "that isn't YAML")))
        << table;
  }
  EXPECT_THAT(fileError("# heading\n\"time\", 1\n"), StartsWith("arm.yaml:2: file: "));
}

TEST(ModelFileError, HostileYaml) {
  for (const std::string part : {"[", "{", "- ", "? ", "a: [", "[a: ", "{a: "}) {
    std::string nested;
    for (int i = 0; i < 100000; ++i) {
      nested += part;
    }
    EXPECT_THAT(fileError(nested),
                AllOf(StartsWith("arm.yaml:"), HasSubstr("inside of each other")))
        << part;
  }
  std::string bomb = "a0: &a0 [x]\n";
  for (int i = 1; i < 100; ++i) {
    const std::string last = "*a" + std::to_string(i - 1);
    bomb +=
        "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + last + ", " + last + "]\n";
  }
  EXPECT_THAT(fileError(bomb), HasSubstr("schema: expected this key, got none"));
  EXPECT_THAT(fileError("&a [*a]"), HasSubstr("expected a map of keys and values"));
  EXPECT_THAT(fileError("schema: 1\nname: &n {name: *n}\n"), HasSubstr("name: expected a text"));
}

TEST(ModelFileError, FileWithoutEndIsNotReadToItsEnd) {
  EXPECT_THAT(errorOf([] { modelFromFile("/dev/zero"); }),
              HasSubstr("/dev/zero: file: expected at most 16 MiB, got more"));
}

TEST(ModelFileError, TextThatIsNoModelIsNotQuoted) {
  EXPECT_EQ(fileError("root:x:0:0:root:/root:/bin/bash\ndaemon:x:1:1\n"),
            "arm.yaml:1: file: expected a map of keys and values, got a text");
}

TEST(ModelFileError, NamesWithControlCharacters) {
  EXPECT_THAT(fileError(replaced(documentedFile(), "- name: cart", "- name: \"cart\\e[31m\"")),
              HasSubstr("expected UTF-8 text without control characters, got 'cart\\x1b[31m'"));
  EXPECT_THAT(
      fileError(replaced(file("modified_dh", joint("one", withLink("dh: {a: 0, alpha: 0, d: "
                                                                   "0, offset: 0}\n"))),
                         "name: arm", "name: \"a\\rm\"")),
      HasSubstr("name: expected UTF-8 text without control characters, got 'a\\rm'"));
}

// YAML cut off between two lines is YAML still: what is missing must be noticed, or was optional.
TEST(ModelFileError, TruncatedFileIsNeverReadAsAnotherRobot) {
  const std::string whole = documentedFile();
  const std::size_t optional_rest = whole.find("  - name: hinge");
  for (std::size_t size = 0; size < optional_rest; ++size) {
    const std::string error = fileError(whole.substr(0, size));
    // the first joint is a robot, too, once it is complete
    if (size < whole.find("link: [3") + 30) {
      EXPECT_THAT(error, StartsWith("arm.yaml")) << whole.substr(0, size);
    }
  }
}

TEST(ModelFileError, UnknownKeysNameLineAndKnownKeys) {
  EXPECT_THAT(fileError(documentedFile() + "mass: 3\n"),
              AllOf(HasSubstr("mass: expected a known key"), HasSubstr("known here: checks, ")));
  EXPECT_EQ(
      fileError(file("modified_dh",
                     joint("one", withLink("dh: {a: 0, alpha: 0, d: 0, offset: 0, e: 1}\n")))),
      "arm.yaml:12: joint one: dh: e: expected a known key, got an unknown one; known here: "
      "a, alpha, alpha_quarter_turns, d, offset, offset_quarter_turns");
  EXPECT_THAT(fileError(replaced(documentedFile(), "fo: 0", "fo: 0, alpha: 1")),
              HasSubstr("joint cart: friction: alpha: expected a known key"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "    rotor_inertia", "    rotor_inertai")),
              HasSubstr("joint hinge: rotor_inertai: expected a known key"));
}

TEST(ModelFileError, MissingKeysNameLineAndKey) {
  for (const std::string key : {"schema", "name", "source", "validity", "units", "geometry",
                                "gravity", "parameters", "joints"}) {
    YAML::Node node = YAML::Load(documentedFile());
    node.remove(key);
    EXPECT_THAT(fileError(YAML::Dump(node)),
                HasSubstr("arm.yaml:1: " + key + ": expected this key, got none; add it"));
  }
  for (const std::string key : {"name", "type", "placement", "link"}) {
    YAML::Node node = YAML::Load(documentedFile());
    node["joints"][1].remove(key);
    EXPECT_THAT(fileError(YAML::Dump(node)),
                AllOf(HasSubstr("joint "), HasSubstr(key + ": expected this key, got none")));
  }
  EXPECT_THAT(fileError(replaced(documentedFile(), ", fo: 0", "")),
              HasSubstr("joint cart: friction: fo: expected this key, got none"));
  EXPECT_THAT(fileError(replaced(documentedFile(), ", axis: [1, 0, 0]", "")),
              HasSubstr("joint cart: placement: axis: expected this key, got none"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "  tolerance: 1e-12\n", "")),
              HasSubstr("checks: tolerance: expected this key, got none"));
}

TEST(ModelFileError, RepeatedKey) {
  EXPECT_THAT(fileError(documentedFile() + "units: SI\n"),
              AllOf(HasSubstr("units: expected each key once"), HasSubstr("after line 5")));
  EXPECT_THAT(fileError(replaced(documentedFile(), "fv: 4,", "fv: 4, fv: 5,")),
              HasSubstr("joint cart: friction: fv: expected each key once"));
}

TEST(ModelFileError, WrongLength) {
  EXPECT_EQ(fileError(file("modified_dh", joint("one", dh("0", "0", "0", "0") + "  link: [1, 2]"))),
            "arm.yaml:13: joint one: link: expected 10 numbers, got a list of 2");
  EXPECT_THAT(fileError(replaced(documentedFile(), "[0, 0, -9.81]", "[0, -9.81]")),
              HasSubstr("arm.yaml:8: gravity: expected 3 numbers, got a list of 2"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "[0, 0, -9.81]", "[0, 0, 0, -9.81]")),
              HasSubstr("arm.yaml:8: gravity: expected 3 numbers, got a list of 4"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "q: [0.2, 0]", "q: [0.2]")),
              HasSubstr("checks: states[0]: q: expected 2 numbers, got a list of 1"));
  EXPECT_THAT(fileError(replaced(rowsFile(), std::string("[") + kLink + ", ", "[")),
              HasSubstr("joint one: row: expected a list of 2, got a list of 1"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "joints:", "joints: []\nold:")),
              HasSubstr("joints: expected at least one joint, got a list of 0"));
}

TEST(ModelFileError, NumbersMustBeFiniteNumbers) {
  for (const std::string bad : {".nan", ".inf", "-.inf", "nan", "1e999", "heavy", "'3'", "1,5", "~",
                                "1:30", "-9_81", "0x10", "0o17", "1e400", "!!str 3", "!mass 3"}) {
    EXPECT_THAT(
        fileError(replaced(documentedFile(), "rotor_inertia: 0.05", "rotor_inertia: " + bad)),
        HasSubstr("joint hinge: rotor_inertia: expected a finite number, got"))
        << bad;
  }
  EXPECT_THAT(fileError(replaced(documentedFile(), "link: [3,", "link: [.nan,")),
              HasSubstr("joint cart: link[0]: expected a finite number, got '.nan'"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "fv: 4", "fv: [4]")),
              HasSubstr("joint cart: friction: fv: expected a finite number, got a list of 1"));
}

TEST(ModelFileError, WrongTypesAndWords) {
  EXPECT_THAT(fileError(replaced(documentedFile(), "schema: 1", "schema: 2")),
              HasSubstr("arm.yaml:1: schema: expected 1, got '2'"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "schema: 1", "schema: 1.5")),
              HasSubstr("schema: expected a small whole number, got '1.5'"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "units: SI", "units: imperial")),
              HasSubstr("units: expected one of SI, got 'imperial'"));
  EXPECT_THAT(
      fileError(replaced(documentedFile(), "placements ", "screws ")),
      HasSubstr("geometry: expected one of modified_dh, standard_dh, placements, got 'scr"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "type: continuous", "type: planar")),
              HasSubstr("joint hinge: type: expected one of revolute, continuous, prismatic"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "law: none", "law: stribeck")),
              AllOf(HasSubstr("joint hinge: friction: law: expected one of none, "),
                    HasSubstr("got 'stribeck'")));
  EXPECT_THAT(fileError(replaced(documentedFile(), "source: worked by hand", "source: [a]")),
              HasSubstr("source: expected a text, got a list of 1"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "source: worked by hand", "source: ")),
              HasSubstr("source: expected a text, got nothing"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "[0, 1, 0]}", "[0, 0, 0]}")),
              HasSubstr("joint hinge: placement: axis: expected a direction"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "friction: {law: none}", "friction: none")),
              HasSubstr("joint hinge: friction: expected a map of keys and values, got 'none'"));
}

TEST(ModelFileError, WhatOneJointHasAllMustHave) {
  EXPECT_THAT(fileError(replaced(documentedFile(), "    friction: {law: none}\n", "")),
              AllOf(HasSubstr("joint hinge: friction: expected this key, as in the first joint"),
                    HasSubstr("{law: none}")));
  EXPECT_THAT(
      fileError(replaced(documentedFile(), "    friction: {law: none}\n",
                         "    friction: {law: none}\n    gravity_first_moment: [1, 2, 3]\n")),
      HasSubstr("joint hinge: gravity_first_moment: expected no such key"));
  EXPECT_THAT(fileError(replaced(rowsFile(), "  drive_gain: 5\n", "")),
              HasSubstr("joint two: drive_gain: expected this key, got none"));
}

TEST(ModelFileError, KeysThatExcludeEachOther) {
  EXPECT_THAT(fileError(rowsFile() + "  link: " + kLink + "\n"),
              HasSubstr("joint two: link: expected either this key or row"));
  EXPECT_THAT(fileError(rowsFile() + "  gravity_first_moment: [1, 2, 3]\n"),
              HasSubstr("gravity_first_moment"));
  EXPECT_THAT(fileError(file("modified_dh",
                             joint("one", withLink("dh: {a: 0, alpha: 0, alpha_quarter_turns: 0, "
                                                   "d: 0, offset: 0}\n")))),
              HasSubstr("alpha: expected either this key or alpha_quarter_turns"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "    rotor_inertia",
                                 "    drive_gain: 3\n    rotor_inertia")),
              HasSubstr("joint hinge: drive_gain: expected no such key without levels"));
  EXPECT_THAT(fileError(file("modified_dh",
                             joint("one", withLink(dh("0", "0", "0", "0") + "  drive_gain: 3\n")),
                             "levels: {parameters: current, friction: torque}\n")),
              HasSubstr("joint one: link: expected a row of links, as parameters are in currents"));
  EXPECT_THAT(fileError(replaced(documentedFile(), "    rotor_inertia",
                                 "    limits: {lower: 1}\n    rotor_inertia")),
              HasSubstr("joint hinge: limits: lower: expected a known key"));
}

TEST(ModelFileError, WhatCannotBeARobotNamesFileAndJoint) {
  EXPECT_THAT(fileError(replaced(documentedFile(), "link: [2,", "link: [-2,")),
              AllOf(StartsWith("arm.yaml: "), HasSubstr("joint hinge"), HasSubstr("mass")));
  EXPECT_THAT(fileError(replaced(documentedFile(), "name: hinge", "name: cart")),
              AllOf(StartsWith("arm.yaml: "), HasSubstr("'cart' twice")));
  EXPECT_THAT(fileError(replaced(documentedFile(), "lower: -2", "lower: 5")),
              AllOf(StartsWith("arm.yaml: "), HasSubstr("joint cart: position limits")));
  EXPECT_THAT(fileError(replaced(rowsFile(), "drive_gain: 5", "drive_gain: 0")),
              AllOf(StartsWith("arm.yaml: "), HasSubstr("drive gain of joint two")));
  EXPECT_THAT(fileError(replaced(documentedFile(), "tolerance: 1e-12", "tolerance: 0")),
              HasSubstr("checks: tolerance: expected a number > 0"));
}

}  // namespace
}  // namespace chain_dynamics

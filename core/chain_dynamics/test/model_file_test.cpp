// SPDX-License-Identifier: Apache-2.0

// What a model file means.

#include "chain_dynamics/model_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "chain_dynamics/urdf.hpp"
#include "model_file_texts.hpp"

namespace chain_dynamics::model_file_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(ModelFile, DocumentedFileIsReadAndItsCheckRowsHold) {
  const Model robot = model(documentedFile());
  EXPECT_EQ(robot.name, "cart_and_pendulum");
  EXPECT_EQ(robot.source, "worked by hand");
  EXPECT_THAT(robot.validity, HasSubstr("Newton"));
  EXPECT_THAT(robot.chain.jointNames(), ElementsAre("cart", "hinge"));
  EXPECT_EQ(robot.chain.joints()[0].type, JointType::kPrismatic);
  EXPECT_EQ(robot.chain.joints()[0].limits.effort, 100);
  EXPECT_EQ(robot.chain.joints()[0].limits.acceleration, 5);
  EXPECT_EQ(robot.chain.joints()[0].limits.jerk, 50);
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
                    HasSubstr("checks.states[1]: torque of joint hinge: expected the model's "
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
  frictionVector(model(rowsFile()), qd, qd, f);
  EXPECT_EQ(f, Eigen::Vector2d(10 * (2 + 1), 5 * (-2 + 1)));  // gain (2 qd + 1)
  const Model in_torques = model(rowsFile("{parameters: torque, friction: torque}"));
  frictionVector(in_torques, qd, qd, f);
  EXPECT_EQ(f, Eigen::Vector2d(3, -1));
  EXPECT_NEAR(someTorques(in_torques)[0], someTorques(model(rowsFile()))[0] / 10, kRounding);
}

TEST(ModelFile, SmoothCoulombIsRead) {
  const Model whole =
      model(smoothFile("fv: 1, fc: 2, width: 0.1, shift: 0.02, fo: -0.5, fl: 0.25, "
                       "fs: 3, vs: 0.125"));
  const auto& law = std::get<SmoothCoulomb>(whole.friction.at(0));
  EXPECT_EQ(law.fv, 1);
  EXPECT_EQ(law.fc, 2);
  EXPECT_EQ(law.width, 0.1);
  EXPECT_EQ(law.shift, 0.02);
  EXPECT_EQ(law.fo, -0.5);
  EXPECT_EQ(law.fl, 0.25);
  EXPECT_EQ(law.fs, 3);
  EXPECT_EQ(law.vs, 0.125);
  EXPECT_TRUE(frictionDependsOnLoad(whole));

  const Model least = model(smoothFile("fv: 0, fc: 2, width: 0.1"));
  const auto& given = std::get<SmoothCoulomb>(least.friction.at(0));
  for (const double figure : {given.fv, given.shift, given.fo, given.fl, given.fs}) {
    EXPECT_EQ(figure, 0);
  }
  EXPECT_FALSE(frictionDependsOnLoad(least));
}

// Without fs, vs has no meaning.
TEST(ModelFile, AStribeckVelocityWithoutStribeckFrictionMayBeZero) {
  const std::string figures = "fv: 1, fc: 2, width: 0.1, ";
  const Model plain = model(smoothFile("fv: 1, fc: 2, width: 0.1"));
  const Eigen::VectorXd qd = Eigen::VectorXd::Constant(plain.chain.jointCount(), 0.05);
  Eigen::VectorXd expected(qd.size()), f(qd.size());
  frictionVector(plain, qd, qd, expected);
  for (const std::string none : {"fs: 0, vs: 0", "vs: 0"}) {
    frictionVector(model(smoothFile(figures + none)), qd, qd, f);
    EXPECT_EQ(f, expected) << none;
  }
}

// K (fv qd + (fc + fl |g| / K) tanh(...)): the load coefficient is a number in either unit.
TEST(ModelFile, FrictionInCurrentsHasLoadInCurrents) {
  std::string text =
      replaced(rowsFile("{parameters: torque, friction: current}"), "schema: 1", "schema: 2");
  for (int joint = 0; joint < 2; ++joint) {
    text = replaced(text, "law: viscous_coulomb_offset, fv: 2, fc: 0, fo: 1",
                    "law: smooth_coulomb, fv: 2, fc: 3, width: 0.001, fl: 0.5");
  }
  const Model robot = model(replaced(text, "[0, 0, -9.81]", "[0, -9.81, 0]"));
  const Eigen::Vector2d q(0.3, -0.7), qd(1, -1);
  Eigen::VectorXd f(2), g(2);
  frictionVector(robot, q, qd, f);
  gravityVector(robot, q, g);
  ASSERT_GT(g.cwiseAbs().minCoeff(), 0.1);
  EXPECT_NEAR(f[0], 10 * (2 + 3) + 0.5 * std::abs(g[0]), kRounding);
  EXPECT_NEAR(f[1], -5 * (2 + 3) - 0.5 * std::abs(g[1]), kRounding);
}

TEST(ModelFile, ExperienceOfIdentificationIsRead) {
  const Model robot = model(smoothFile("fv: 0, fc: 2, width: 0.1",
                                       "  torque_deviation: 1.9\n"
                                       "  seen: {q: [-1, 2], qd: [-0.5, 0.75], qdd: [-3, 4]}\n"));
  ASSERT_EQ(robot.torque_deviation.size(), 1);
  EXPECT_EQ(robot.torque_deviation[0], 1.9);
  ASSERT_EQ(robot.seen.size(), 1U);
  EXPECT_EQ(robot.seen[0].q.lower, -1);
  EXPECT_EQ(robot.seen[0].q.upper, 2);
  EXPECT_EQ(robot.seen[0].qd.lower, -0.5);
  EXPECT_EQ(robot.seen[0].qd.upper, 0.75);
  EXPECT_EQ(robot.seen[0].qdd.lower, -3);
  EXPECT_EQ(robot.seen[0].qdd.upper, 4);
  const Model unknown = model(documentedFile());
  EXPECT_EQ(unknown.torque_deviation.size(), 0);
  EXPECT_TRUE(unknown.seen.empty());
}

// Schema 2 only adds to schema 1.
TEST(ModelFile, FileOfSchemaOneIsOneOfSchemaTwo) {
  const Model one = model(documentedFile());
  const Model two = model(replaced(documentedFile(), "schema: 1", "schema: 2"));
  EXPECT_EQ(someTorques(two), someTorques(one));
  EXPECT_EQ(two.friction.size(), one.friction.size());
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

}  // namespace chain_dynamics::model_file_test

// SPDX-License-Identifier: Apache-2.0

// What modelFileText() writes is read as the same model.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "chain_dynamics/friction.hpp"
#include "chain_dynamics/joint_frame.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/robot_description.hpp"
#include "chain_dynamics/urdf.hpp"
#include "example_models.hpp"
#include "model_file_texts.hpp"
#include "urdf_texts.hpp"

namespace chain_dynamics::model_file_writer_test {

using ::testing::HasSubstr;

Eigen::VectorXd statedTorques(const Model& robot) {
  Eigen::VectorXd f(robot.chain.jointCount());
  frictionVector(robot, Eigen::VectorXd::LinSpaced(f.size(), 0.3, 1.1),
                 Eigen::VectorXd::LinSpaced(f.size(), -1.2, 2.0), f);
  return f + someTorques(robot);
}

void expectSame(const Model& written, const Model& read) {
  EXPECT_EQ(read.name, written.name);
  EXPECT_EQ(read.source, written.source);
  EXPECT_EQ(read.validity, written.validity);
  EXPECT_EQ(read.chain.jointNames(), written.chain.jointNames());
  EXPECT_EQ(read.chain.jointTypes(), written.chain.jointTypes());
  EXPECT_EQ(read.drive_gains, written.drive_gains);
  EXPECT_EQ(read.torque_deviation, written.torque_deviation);
  EXPECT_EQ(read.stiffness, written.stiffness);
  EXPECT_EQ(read.rest, written.rest);
  EXPECT_EQ(read.levers, written.levers);
  EXPECT_EQ(read.row_parameters.size(), written.row_parameters.size());
  EXPECT_EQ(read.gravity_parameters.size(), written.gravity_parameters.size());
  EXPECT_LT(difference(read.chain.tip().p, written.chain.tip().p), kRounding);
  EXPECT_LT(difference(read.chain.tip().R, written.chain.tip().R), kRounding);
  const Eigen::VectorXd expected = statedTorques(written);
  EXPECT_LT(difference(statedTorques(read), expected),
            kRounding * (1 + expected.cwiseAbs().maxCoeff()));
  for (std::size_t j = 0; j < written.chain.joints().size(); ++j) {
    const Joint &one = written.chain.joints()[j], &other = read.chain.joints()[j];
    EXPECT_EQ(other.rotor_inertia, one.rotor_inertia);
    EXPECT_EQ(other.limits.lower, one.limits.lower);
    EXPECT_EQ(other.limits.upper, one.limits.upper);
    EXPECT_EQ(other.limits.velocity, one.limits.velocity);
    EXPECT_EQ(other.limits.effort, one.limits.effort);
    EXPECT_EQ(other.limits.acceleration, one.limits.acceleration);
    EXPECT_EQ(other.limits.deceleration, one.limits.deceleration);
    EXPECT_EQ(other.limits.jerk, one.limits.jerk);
    if (written.row_parameters.empty()) {
      EXPECT_EQ(read.chain.links()[j].toVector(), written.chain.links()[j].toVector());
    }
    if (written.seen.empty()) continue;
    EXPECT_EQ(read.seen[j].qdd.lower, written.seen[j].qdd.lower);
    EXPECT_EQ(read.seen[j].q.upper, written.seen[j].q.upper);
  }
}

TEST(ModelFileWriter, ModelsOfThisProjectComeBack) {
  for (const std::string name :
       {"franka_gaz2019_feasible", "franka_inria_identified", "ur10_identified"}) {
    SCOPED_TRACE(name);
    const Model robot = modelFromFile(kRobots + "/models/" + name + ".yaml");
    expectSame(robot, model(modelFileText(robot)));
  }
  const Model documented = model(documentedFile());
  expectSame(documented, model(modelFileText(documented)));
}

TEST(ModelFileWriter, WhatIdentificationFindsComesBackDigitByDigit) {
  Model robot = test::withChangingSteps(Model(test::randomChain(7)), 3);
  robot.source = "two \"lines\",\nwith \\ and ü";
  robot.torque_deviation = Eigen::VectorXd::LinSpaced(7, 0.1, 1.0 / 3);
  robot.seen.assign(7, {{-1.0 / 3, 2}, {-1e-7, 1.5}, {-9, 12.125}});
  robot.stiffness = Eigen::VectorXd::LinSpaced(7, 1.0 / 3, 0);
  robot.rest = Eigen::VectorXd::LinSpaced(7, -1.0 / 7, 0);
  robot.levers = Eigen::MatrixXd::Zero(2, 7);
  robot.levers(1, 3) = 1.0 / 3;
  robot.levers(0, 6) = -2.5;
  expectSame(robot, model(modelFileText(robot)));
}

/// A waist with two arms, of which the left one follows the other and has a wrist.
Model tree() {
  const std::string place = "<origin xyz='0.1 0.2 0.3' rpy='1 0.5 -0.3'/><axis xyz='0.6 0 0.8'/>";
  const std::string follows = "<mimic joint='right_arm' multiplier='-0.7' offset='0.4'/>";
  return Model(mechanismFromRobot(
      robotFromUrdf(robot(link("base") + link("chest") + link("left") + link("right") +
                          link("hand") +
                          joint("right_arm", "revolute", "chest", "right", place + kLimit) +
                          joint("left_arm", "revolute", "chest", "left", place + follows + kLimit) +
                          joint("waist", "revolute", "base", "chest", place + kLimit) +
                          joint("wrist", "prismatic", "left", "hand", place + kLimit))),
      {}, {"*"}));
}

TEST(ModelFileWriter, TreesComeBack) {
  const Model described = tree();
  const Mechanism parts{described.chain, described.branches};
  Model written(withLinks(parts, linksOf(parts), Eigen::Vector3d(0.1, 0.2, 0.3)));
  for (const double fc : {1.0, 2.0, 3.0})
    written.friction.emplace_back(SmoothCoulomb{0.5, fc, 0.1});
  written.torque_deviation = Eigen::Vector3d(1, 2, 3);
  written.seen.assign(3, {{-1, 2}, {-1, 1.5}, {-9, 12}});
  const Model read = model(modelFileText(written));
  EXPECT_EQ(read.chain.jointNames(), written.chain.jointNames());
  EXPECT_EQ(read.chain.joints()[0].rotor_inertia, 0.1);
  ASSERT_EQ(read.branches.size(), 2);
  EXPECT_EQ(read.branches[1].tip, written.branches[1].tip);
  EXPECT_EQ(read.branches[1].link, written.branches[1].link);
  EXPECT_EQ(read.branches[1].chain.links()[0].mass, 0);
  EXPECT_EQ(linksOf({read.chain, read.branches})[1].toVector(), linksOf(parts)[1].toVector());
  EXPECT_EQ(read.seen[2].qdd.upper, 12);
  const Eigen::Vector3d q(0.3, -0.2, 0.5), qd(1, -2, 0.4), qdd(3, 0.1, -1);
  Eigen::Vector3d of_written, of_read;
  torques(written, q, qd, qdd, of_written);
  torques(read, q, qd, qdd, of_read);
  EXPECT_LT((of_read - of_written).norm(), kRounding * (1 + of_written.norm()));
  // joints that follow several coordinates
  written.branches[1].S.push_back({1, 2, 0.25});
  const Model mixed = model(modelFileText(written));
  torques(written, q, qd, qdd, of_written);
  torques(mixed, q, qd, qdd, of_read);
  EXPECT_LT((of_read - of_written).norm(), kRounding * (1 + of_written.norm()));
}

TEST(ModelFileWriter, MotorsThatAreJointsComeBackAsRotors) {
  const Model described = tree();
  const Mechanism driven = withMotors({described.chain, described.branches},
                                      {Eigen::MatrixXd::Identity(3, 3), {}, {}, {0.1, 0.2, 0.3}});
  const Model read = model(modelFileText(Model(driven)));
  EXPECT_EQ(read.chain.joints()[2].rotor_inertia, 0.3);
}

TEST(ModelFileWriter, MotorsThatMoveSeveralJointsComeBack) {
  const Model described = tree();
  Eigen::Matrix3d M = Eigen::Matrix3d::Identity();
  M(2, 1) = 0.5;  // the wrist follows the right arm's motor, too, besides its own
  const std::vector<std::string> names = {"right_arm", "waist", "wire"};
  Model written(withMotors({described.chain, described.branches}, {M, {}, names, {0, 0, 0.3}}));
  for (const double fc : {1.0, 2.0, 3.0})
    written.friction.emplace_back(SmoothCoulomb{0.5, fc, 0.1});
  const std::string text = modelFileText(written);
  const Model read = model(text);
  EXPECT_EQ(read.chain.jointNames(), names);
  EXPECT_EQ(read.branches[1].link, written.branches[1].link);
  const Eigen::Vector3d q(0.3, -0.2, 0.5), qd(1, -2, 0.4), qdd(3, 0.1, -1);
  Eigen::Vector3d of_written, of_read;
  torques(written, q, qd, qdd, of_written);
  torques(read, q, qd, qdd, of_read);
  EXPECT_LT((of_read - of_written).norm(), kRounding * (1 + of_written.norm()));
  const Mechanism rotor =
      withLinks({read.chain, read.branches}, linksOf({read.chain, read.branches}),
                Eigen::Vector3d(0, 0, 0.7));
  EXPECT_EQ(rotor.motor_inertia, (std::vector<double>{0, 0, 0.7}));
  EXPECT_THAT(
      errorOf([&] { model(replaced(text, "joint: \"right_arm\", xyz", "joint: wire, xyz")); }),
      HasSubstr("expected a joint that moves a link, got the motor wire"));
}

/// A continuous left arm that a right one follows.
Model twoArms(const std::string& type, const std::string& limit) {
  return Model(mechanismFromRobot(
      robotFromUrdf(
          robot(link("base") + link("left") + link("right") +
                joint("left_arm", "continuous", "base", "left", "") +
                joint("right_arm", type, "base", "right", "<mimic joint='left_arm'/>" + limit))),
      {}, {"*"}));
}

TEST(ModelFileWriter, JointsThatTurnAsFarAsTheirFollowersComeBack) {
  const Model written = twoArms("revolute", kLimit);
  const Joint read = model(modelFileText(written)).chain.joints()[0];
  EXPECT_EQ(read.type, JointType::kRevolute);
  EXPECT_EQ(read.limits.upper, written.chain.joints()[0].limits.upper);

  const std::string endless = modelFileText(twoArms("continuous", ""));
  EXPECT_EQ(model(endless).chain.joints()[0].type, JointType::kContinuous);
  const std::string unchecked = endless.substr(0, endless.find("checks:"));
  EXPECT_EQ(model(replaced(unchecked, "multiplier: 1", "multiplier: 0.5")).chain.joints()[0].type,
            JointType::kRevolute);
}

TEST(ModelFileWriter, RefusesCoordinatesThatAreNoJoints) {
  Model robot = tree();
  for (Branch& branch : robot.branches) {
    for (Follow& entry : branch.S) entry.factor *= 2;
  }
  EXPECT_THAT(errorOf([&] { modelFileText(robot); }),
              HasSubstr("coordinate right_arm: expected a joint, in the order"));
}

TEST(ModelFileWriter, RefusesWhatNoFileStates) {
  Model robot(test::randomChain(3));
  robot.gravity_parameters = robot.chain.links();
  robot.gravity_parameters[1].mass += 1;
  EXPECT_THAT(errorOf([&] { modelFileText(robot); }),
              HasSubstr("gravity_parameters of joint 2: expected the masses of the links"));
}

TEST(ModelFileWriter, RollPitchYawGivesTheRotationBack) {
  constexpr double kRightAngle = 1.5707963267948966;
  for (const Eigen::Vector3d& rpy :
       {Eigen::Vector3d(0.3, -1.1, 2.9), Eigen::Vector3d(-3, 0.2, -2),
        Eigen::Vector3d(0.3, kRightAngle, 0.7), Eigen::Vector3d(1, -kRightAngle, 2)}) {
    const Eigen::Matrix3d R = rotationFromRollPitchYaw(rpy);
    EXPECT_LT(difference(rotationFromRollPitchYaw(rollPitchYaw(R)), R), 2e-15) << rpy.transpose();
  }
}

}  // namespace chain_dynamics::model_file_writer_test

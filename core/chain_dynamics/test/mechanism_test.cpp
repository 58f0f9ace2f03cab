// SPDX-License-Identifier: Apache-2.0

// Which mechanism a robot description is, and what a mechanism can't be. Its numbers are compared with
// Pinocchio's in the package of that solver.

#include "chain_dynamics/mechanism.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/model.hpp"
#include "chain_dynamics/robot_description.hpp"
#include "urdf_texts.hpp"

namespace chain_dynamics {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Names = std::vector<std::string>;

std::string mimic(const std::string& joint, double multiplier, double offset) {
  return "<mimic joint='" + joint + "' multiplier='" + std::to_string(multiplier) + "' offset='" +
         std::to_string(offset) + "'/>" + kLimit;  // of -1 to 2
}

/// A waist with a left and a right arm of one joint, a camera on the waist, and tools on the left arm.
std::string torso(const std::string& right = kLimit, const std::string& more = "") {
  return robot(
      link("base") + link("chest") + link("left") + link("left_tool", "") + link("left_frame", "") +
      link("right") + link("camera", "") + joint("right_arm", "revolute", "chest", "right", right) +
      joint("waist", "revolute", "base", "chest") + joint("left_arm", "revolute", "chest", "left") +
      joint("left_frame_mount", "fixed", "left", "left_frame", "") +
      joint("left_flange", "fixed", "left_frame", "left_tool", "") +
      joint("camera_mount", "fixed", "chest", "camera", "") + more);
}

Mechanism mechanism(const std::string& urdf, const Names& tips = {"*"},
                    const UrdfOptions& options = {}) {
  return mechanismFromRobot(robotFromUrdf(urdf), options, tips);
}

Names tipsOf(const Mechanism& mechanism) {
  Names tips;
  for (const Branch& branch : mechanism.branches) tips.push_back(branch.tip);
  return tips;
}

std::string errorOf(const std::string& urdf, const Names& tips, const UrdfOptions& options = {}) {
  try {
    mechanism(urdf, tips, options);
  } catch (const ModelError& e) {
    return e.what();
  }
  return "";
}

std::string errorOf(const Mechanism& mechanism) {
  try {
    checkModel(Model(mechanism));
  } catch (const ModelError& e) {
    return e.what();
  }
  return "";
}

TEST(Mechanism, HasItsCoordinatesInTheOrderOfTheDescription) {
  EXPECT_THAT(mechanism(torso()).coordinates.jointNames(),
              ElementsAre("right_arm", "waist", "left_arm"));
  EXPECT_THAT(mechanism(torso(), {"left", "camera"}).coordinates.jointNames(),
              ElementsAre("waist", "left_arm"));
}

TEST(Mechanism, TakesForAStarTheFarthestLeafThatEachLastJointMoves) {
  // the camera is moved by the waist, which leads to both arms
  EXPECT_THAT(tipsOf(mechanism(torso())), ElementsAre("left_tool", "right"));
  UrdfOptions held;
  held.locked_position = [](const std::string& joint) {
    return joint == "left_arm" ? std::optional<double>(0.3) : std::nullopt;
  };
  EXPECT_TRUE(mechanism(torso(), {"*"}, held).branches.empty());  // a chain: to the right
  EXPECT_THAT(mechanism(torso(), {"*"}, held).coordinates.jointNames(),
              ElementsAre("waist", "right_arm"));
  // what follows a joint that is held moves no leaf either
  const std::string both_held = torso(mimic("left_arm", 1, 0));
  EXPECT_EQ(mechanism(both_held, {"*"}, held).coordinates.jointNames(), Names{"waist"});
  EXPECT_TRUE(mechanism(both_held, {"*"}, held).branches.empty());
}

TEST(Mechanism, CountsEachBodyOnce) {
  const Mechanism both = mechanism(torso());
  double mass = 0;
  for (const Branch& branch : both.branches) {
    for (const LinkParameters& link : branch.chain.links()) mass += link.mass;
  }
  EXPECT_EQ(mass, 3 * 2.0);
  EXPECT_EQ(linkCount(both.branches), 3);
  EXPECT_EQ(both.branches[1].chain.links()[0].mass, 0);
}

TEST(Mechanism, ReplacesLinksAndRotors) {
  UrdfOptions held;  // the right arm, which is fixed to the chest then
  held.locked_position = [](const std::string& joint) {
    return joint == "right_arm" ? std::optional<double>(0.3) : std::nullopt;
  };
  const Mechanism described = mechanism(torso(), {"left", "right"}, held);
  ASSERT_EQ(described.branches.size(), 2);
  std::vector<LinkParameters> links = linksOf(described);
  ASSERT_EQ(links.size(), 2);
  EXPECT_EQ(links[0].mass, 2 * 2.0);
  links[1].mass = 7;
  const Mechanism changed = withLinks(described, links, Eigen::Vector2d(0.25, 0.5));
  EXPECT_EQ(changed.branches[0].chain.links()[0].mass, 4);
  EXPECT_EQ(changed.branches[1].chain.links()[0].mass, 0);
  EXPECT_EQ(linksOf(changed)[1].mass, 7);
  EXPECT_EQ(changed.branches[0].chain.joints()[0].rotor_inertia, 0.25);
  EXPECT_EQ(changed.branches[1].chain.joints()[0].rotor_inertia, 0);
  EXPECT_EQ(changed.coordinates.joints()[1].rotor_inertia, 0.5);
  EXPECT_THROW(withLinks(described, {links[0]}, Eigen::Vector2d(0, 0)), ModelError);
}

TEST(Mechanism, FollowsChainsOfMimics) {
  const std::string urdf = torso(
      mimic("left_arm", -2, 0.5),
      link("hand") + joint("wrist", "revolute", "right", "hand", mimic("right_arm", 0.5, 0.1)));
  const Mechanism follows = mechanism(urdf);
  EXPECT_THAT(follows.coordinates.jointNames(), ElementsAre("waist", "left_arm"));
  const Branch& right = follows.branches[1];
  ASSERT_EQ(right.tip, "hand");
  EXPECT_THAT(right.chain.jointNames(), ElementsAre("waist", "right_arm", "wrist"));
  EXPECT_EQ(right.S[2].coordinate, 1);
  EXPECT_EQ(right.S[2].factor, 0.5 * -2);
  EXPECT_DOUBLE_EQ(right.s[2], 0.5 * 0.5 + 0.1);
  EXPECT_EQ(linkCount(follows.branches), 4);

  // -1 <= -2 q + 0.5 <= 2, and -1 <= -q + 0.35 <= 2
  const JointLimits& limits = follows.coordinates.joints()[1].limits;
  EXPECT_DOUBLE_EQ(limits.lower, -0.75);
  EXPECT_DOUBLE_EQ(limits.upper, 0.75);
  EXPECT_DOUBLE_EQ(limits.velocity, 4.0 / 2);
  EXPECT_EQ(limits.effort, 3);
}

TEST(Mechanism, WarnsWhereLimitsOfAFollowerExcludeAllPositions) {
  const Mechanism odd = mechanism(torso(mimic("left_arm", 1, 9)));
  EXPECT_EQ(odd.coordinates.joints()[1].limits.upper, 2);
  EXPECT_THAT(odd.coordinates.warnings(),
              ::testing::Contains(
                  AllOf(HasSubstr("left_arm"), HasSubstr("right_arm"), HasSubstr("aren't used"))));
}

TEST(Mechanism, RefusesWhatItCannotBe) {
  EXPECT_THAT(errorOf(torso(), {"left", "head"}), HasSubstr("'head'"));
  EXPECT_THAT(errorOf(torso(), {"left", "left"}), HasSubstr("'left' twice"));
  EXPECT_THAT(errorOf(torso(), {"left", "base"}), HasSubstr("the same link"));
  EXPECT_THAT(errorOf(torso(mimic("left_arm", 1, 0)), {"right"}),
              AllOf(HasSubstr("right_arm"), HasSubstr("left_arm"), HasSubstr("add a tip")));
  UrdfOptions held;
  held.locked_position = [](const std::string& joint) {
    return joint == "right_arm" ? std::optional<double>(0.3) : std::nullopt;
  };
  EXPECT_THAT(errorOf(torso(mimic("left_arm", 1, 0)), {"left", "right"}, held),
              AllOf(HasSubstr("joint right_arm: <mimic>"), HasSubstr("moves with"),
                    HasSubstr("hold joint left_arm at a position instead")));
  const std::string loop =
      torso(mimic("wrist", 1, 0),
            link("hand") + joint("wrist", "revolute", "right", "hand", mimic("right_arm", 1, 0)));
  EXPECT_THAT(errorOf(loop, {"*"}),
              AllOf(HasSubstr("<mimic>"), HasSubstr("follows itself through joint")));
}

TEST(Mechanism, RefusesCoordinatesThatMoveNothingOfTheirOwn) {
  const Mechanism sound = mechanism(torso());
  EXPECT_EQ(errorOf(sound), "");
  Mechanism odd = sound;
  for (Branch& branch : odd.branches) {
    for (Follow& entry : branch.S) {
      if (entry.coordinate == 2) entry.coordinate = 0;  // the left arm goes with the right one
    }
  }
  EXPECT_THAT(errorOf(odd), AllOf(HasSubstr("coordinate left_arm"), HasSubstr("full column rank")));
  odd = sound;
  odd.branches[0].S.push_back(odd.branches[0].S[0]);
  EXPECT_THAT(errorOf(odd), HasSubstr("each entry once"));
  odd = sound;
  odd.branches[1].s[0] = NAN;
  EXPECT_THAT(errorOf(odd), HasSubstr("branch to right"));
  odd = sound;
  odd.branches[1].link[1] = 7;
  EXPECT_THAT(errorOf(odd), HasSubstr("without a gap"));
  odd = sound;
  odd.motor_inertia = {1};
  EXPECT_THAT(errorOf(odd), HasSubstr("motor_inertia: expected 3, got 1"));
  odd.motor_inertia = {1, -1, 0};
  EXPECT_THAT(errorOf(odd), HasSubstr("motor_inertia of coordinate waist"));
}

Motors motors(const Eigen::MatrixXd& M, const Names& names = {}) { return {M, {}, names, {}}; }

std::string errorOf(const Mechanism& mechanism, const Motors& motors) {
  try {
    withMotors(mechanism, motors);
  } catch (const ModelError& e) {
    return e.what();
  }
  return "";
}

TEST(Motors, AreCoordinatesThatMoveJoints) {
  const Mechanism joints = mechanism(torso());  // right_arm, waist, left_arm
  Eigen::MatrixXd M(3, 2);
  M << 0, -0.5,  //
      1, 0,      //
      1, 2;
  const Mechanism arms = withMotors(joints, motors(M));
  EXPECT_THAT(arms.coordinates.jointNames(), ElementsAre("waist", "motor_2"));
  const Branch& left = arms.branches[0];
  ASSERT_THAT(left.chain.jointNames(), ElementsAre("waist", "left_arm"));
  ASSERT_EQ(left.S.size(), 3U);
  EXPECT_EQ(left.S[2].joint, 1);
  EXPECT_EQ(left.S[2].coordinate, 1);
  EXPECT_EQ(left.S[2].factor, 2);
  // -1 <= -q / 2 <= 2 of the right arm, which the motor moves alone
  const JointLimits& limits = arms.coordinates.joints()[1].limits;
  EXPECT_DOUBLE_EQ(limits.lower, -4);
  EXPECT_DOUBLE_EQ(limits.upper, 2);
  EXPECT_DOUBLE_EQ(limits.velocity, 4 * 2);
  EXPECT_EQ(limits.effort, INFINITY);  // it moves two joints
  EXPECT_EQ(arms.coordinates.joints()[0].limits.effort, 3);
  EXPECT_THAT(withMotors(joints, motors(M, {"a", "b"})).coordinates.jointNames(),
              ElementsAre("a", "b"));
  const Mechanism geared = withMotors(joints, motors(Eigen::MatrixXd::Identity(3, 3) / -100));
  EXPECT_DOUBLE_EQ(geared.coordinates.joints()[2].limits.effort, 0.03);
}

TEST(Motors, HaveRotorInertiaOfTheirOwn) {
  Motors shared = motors(Eigen::Matrix3d::Identity() + Eigen::Matrix3d::Ones());
  const Mechanism joints = mechanism(torso());
  const Model without(withMotors(joints, shared));
  shared.rotor_inertia = {1, 0, 3};
  const Model with(withMotors(joints, shared));
  EXPECT_EQ(with.chain.joints()[2].rotor_inertia, 3);
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(3, 0.2, 0.9), added{{1 * q[0], 0, 3 * q[2]}};
  Eigen::VectorXd tau(3), tau_without(3);
  torques(with, q, q, q, tau);
  torques(without, q, q, q, tau_without);
  EXPECT_LE((tau - tau_without - added).norm(), 1e-12);
  EXPECT_NEAR(kineticEnergy(with, q, q) - kineticEnergy(without, q, q), 0.5 * added.dot(q), 1e-12);
  FastModel(with).torques(q.data(), q.data(), q.data(), tau.data());
  EXPECT_LE((tau - tau_without - added).norm(), 1e-12);
}

TEST(Motors, AreRefusedByName) {
  const Mechanism joints = mechanism(torso());
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_THAT(errorOf(joints, motors(M.topRows(2))), HasSubstr("right_arm, waist, left_arm"));
  EXPECT_THAT(errorOf(joints, motors(M, {"a", "b"})), HasSubstr("2 names"));
  EXPECT_THAT(errorOf(joints, motors(M, {"a", "b", "a"})), HasSubstr("a"));
  EXPECT_THAT(errorOf(mechanism(torso(), {"camera"}), motors(M)), HasSubstr("branches_of_chains"));
  M(1, 2) = NAN;
  EXPECT_THAT(errorOf(joints, motors(M)), HasSubstr("row of joint waist: expected finite"));
  M.setOnes();
  EXPECT_THAT(errorOf(joints, motors(M)), HasSubstr("full column rank"));
}

const char* const kPlugin = "<plugin>transmission_interface/";

std::string end(const std::string& kind, int number, const std::string& name,
                const std::string& content) {
  return "<" + kind + " name='" + name + "' role='" + kind + std::to_string(number) + "'>" +
         content + "</" + kind + ">";
}

std::string control(const std::string& content) {
  return "<ros2_control name='arms' type='system'>" + content + "</ros2_control>";
}

std::string transmission(const std::string& plugin, const std::string& ends) {
  return "<transmission name='wrist'>" + (kPlugin + plugin) + "</plugin>" + ends +
         "</transmission>";
}

std::string reduction(double n, double offset = 0) {
  return "<mechanical_reduction>" + std::to_string(n) + "</mechanical_reduction><offset>" +
         std::to_string(offset) + "</offset>";
}

const std::string kPair = end("actuator", 1, "left_motor", reduction(50)) +
                          end("actuator", 2, "right_motor", reduction(-40)) +
                          end("joint", 1, "left_arm", reduction(2, 0.1)) +
                          end("joint", 2, "right_arm", reduction(4, -0.3));

Motors described(const std::string& more) {
  const RobotDescription robot = robotFromUrdf(torso(kLimit, more));
  return motorsFromRobot(robot, {"right_arm", "waist", "left_arm"});
}

// Formulas of the documentation of ros2_control's transmission_interface, at one motion of the motors.
TEST(Transmissions, GiveMotors) {
  const double a = 0.7, b = -1.1;
  const Eigen::VectorXd q = Eigen::Vector3d(a, b, 5);  // the waist comes after the right arm
  const Motors simple = described(control(transmission(
      "SimpleTransmission",
      end("actuator", 1, "motor", "") + end("joint", 1, "right_arm", reduction(-50, 0.2)))));
  EXPECT_THAT(simple.names, ElementsAre("motor", "waist", "left_arm"));
  EXPECT_LE((simple.M * q + simple.offset - Eigen::Vector3d(a / -50 + 0.2, b, 5)).norm(), 1e-15);

  const Motors differential = described(control(transmission("DifferentialTransmission", kPair)));
  EXPECT_THAT(differential.names, ElementsAre("left_motor", "right_motor", "waist"));
  const double left = (a / 50 + b / -40) / (2 * 2) + 0.1,
               right = (a / 50 - b / -40) / (2 * 4) - 0.3;
  EXPECT_LE((differential.M * q + differential.offset - Eigen::Vector3d(right, 5, left)).norm(),
            1e-15);

  const Motors four_bar = described(control(transmission("FourBarLinkageTransmission", kPair)));
  const double first = a / (2 * 50), second = (b / -40 - a / (2 * 50)) / 4;
  EXPECT_LE(
      (four_bar.M * q + four_bar.offset - Eigen::Vector3d(second - 0.3, 5, first + 0.1)).norm(),
      1e-15);
}

TEST(Transmissions, AreRefusedWhereTheyAreAskedForOnly) {
  const auto error = [](const std::string& more) {
    try {
      described(control(more));
    } catch (const ModelError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const std::string simple = end("actuator", 1, "motor", "") + end("joint", 1, "waist", "");
  EXPECT_EQ(error(transmission("SimpleTransmission", simple)), "");
  EXPECT_THAT(error(transmission("SpringTransmission", simple)),
              AllOf(HasSubstr("transmission wrist: <plugin>"), HasSubstr("SpringTransmission")));
  EXPECT_THAT(error(transmission("SimpleTransmission", end("joint", 1, "waist", ""))),
              HasSubstr("<actuator>: expected 1, got 0"));
  EXPECT_THAT(error(transmission("DifferentialTransmission", simple)),
              HasSubstr("<joint>: expected 2, got 1"));
  EXPECT_THAT(error(transmission("SimpleTransmission", end("actuator", 1, "motor", "") +
                                                           end("joint", 1, "waist", reduction(0)))),
              HasSubstr("<mechanical_reduction>: expected a number other than 0"));
  EXPECT_THAT(
      error(transmission("FourBarLinkageTransmission",
                         end("actuator", 1, "a", "") + end("actuator", 2, "b", "") +
                             end("joint", 2, "waist", "") + end("joint", 1, "left_arm", ""))),
      AllOf(HasSubstr("<joint> role"), HasSubstr("joint1")));
  EXPECT_THAT(error(transmission("SimpleTransmission", simple) +
                    transmission("SimpleTransmission", simple)),
              HasSubstr("joint waist: expected one of no other transmission"));
  EXPECT_THAT(error(transmission("DifferentialTransmission",
                                 end("joint", 1, "waist", "") + end("joint", 2, "waist", ""))),
              HasSubstr("<joint> name: expected each once, got 'waist' twice"));
  const std::string pair = transmission("DifferentialTransmission", kPair);
  EXPECT_EQ(error(pair), "");
  const RobotDescription robot = robotFromUrdf(torso(kLimit, control(pair)));
  EXPECT_THROW(motorsFromRobot(robot, {"waist", "left_arm"}), ModelError);  // right_arm is held
}

TEST(Mechanism, HasNoFollowerWhereRos2ControlSaysSo) {
  const std::string follows = mimic("left_arm", -2, 0.5);
  const auto names = [&](const std::string& joint) {
    return mechanism(torso(follows, control(joint))).coordinates.jointNames();
  };
  EXPECT_THAT(names("<joint name='right_arm' mimic='true'/>"), ElementsAre("waist", "left_arm"));
  EXPECT_THAT(names("<joint name='right_arm'/>"), ElementsAre("waist", "left_arm"));
  EXPECT_THAT(names("<joint name='right_arm' mimic='False'/>"),
              ElementsAre("right_arm", "waist", "left_arm"));
  EXPECT_THAT(robotFromUrdf(torso(follows, control("<joint name='waist' mimic='no'/>"))).warnings,
              ::testing::Contains(HasSubstr("expected true or false, got 'no'")));
}

TEST(Mechanism, HasDefiniteInertiaOnlyWhereEachBranchHas) {
  EXPECT_TRUE(Model(mechanism(torso())).inertiaIsPhysical());
  Mechanism light = mechanism(torso());
  const Chain& right = light.branches[1].chain;
  light.branches[1].chain = Chain(
      right.name(), right.joints(),
      std::vector<LinkParameters>(right.links().size(), LinkParameters::zero()), right.gravity());
  EXPECT_FALSE(Model(light).inertiaIsPhysical());
}

TEST(Mechanism, MakesAFastModelOfChangedParametersFromAnother) {
  const Model model(mechanism(torso()));
  const FastModel original(model);
  const Model changed = withGravity(
      withBodyAtTip(model,
                    LinkParameters::fromCenterOfMass(1, {0.1, 0, 0}, Eigen::Matrix3d::Zero()), 1),
      {1, 2, 3});
  Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(3, 0.2, 0.9), found(3), expected(3);
  FastModel(changed, original).torques(q.data(), q.data(), q.data(), found.data());
  torques(changed, q, q, q, expected);
  EXPECT_LE((found - expected).norm(), 1e-12 * expected.norm());
  EXPECT_THROW(FastModel(Model(mechanism(torso(), {"left"})), original), ModelError);
}

}  // namespace
}  // namespace chain_dynamics

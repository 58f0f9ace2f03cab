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

std::string errorOf(const std::string& urdf, const Names& tips) {
  try {
    mechanism(urdf, tips);
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

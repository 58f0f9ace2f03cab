// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/urdf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/tip_kinematics.hpp"
#include "chain_dynamics/torques.hpp"
#include "reference.hpp"
#include "urdf_texts.hpp"

namespace chain_dynamics::urdf_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::string urdfError(const std::string& urdf, const UrdfOptions& options = {}) {
  return errorOf([&] { chainFromUrdf(urdf, options); });
}

UrdfOptions between(const std::string& root, const std::string& tip) {
  UrdfOptions options;
  options.root = root;
  options.tip = tip;
  return options;
}

// --- what a chain is made of ---

TEST(Urdf, PendulumWorkedByHand) {
  const auto chain = chainFromUrdf(
      robot(link("base", "") +
            link("bob",
                 "<inertial><origin xyz='0 0 -0.5'/><mass value='2'/><inertia ixx='0.1' ixy='0' "
                 "ixz='0' iyy='0.2' iyz='0' izz='0.3'/></inertial>") +
            joint("hinge", "continuous", "base", "bob", "<axis xyz='0 1 0'/>")));
  const double q = 0.7, qdd = 3.0;
  Eigen::VectorXd tau(1);
  torques(chain, Eigen::VectorXd::Constant(1, q), Eigen::VectorXd::Zero(1),
          Eigen::VectorXd::Constant(1, qdd), tau);
  // (Iyy + m l^2) qdd + m g l sin q
  EXPECT_NEAR(tau[0], (0.2 + 2 * 0.25) * qdd + 2 * 9.81 * 0.5 * std::sin(q), kRounding);
}

TEST(Urdf, JointsCarryNamesTypesAndLimits) {
  const auto chain = chainFromUrdf(
      robot(link("base", "") + link("a") + link("b") + link("c") +
            joint("slide", "prismatic", "base", "a") + joint("turn", "revolute", "a", "b") +
            joint("spin", "continuous", "b", "c", "<limit effort='30' velocity='40'/>")));
  EXPECT_EQ(chain.name(), "arm");
  EXPECT_THAT(chain.jointNames(), ElementsAre("slide", "turn", "spin"));
  EXPECT_EQ(chain.joints()[0].type, JointType::kPrismatic);
  EXPECT_EQ(chain.joints()[1].type, JointType::kRevolute);
  EXPECT_EQ(chain.joints()[2].type, JointType::kContinuous);

  const JointLimits& limits = chain.joints()[1].limits;
  EXPECT_EQ(limits.lower, -1);
  EXPECT_EQ(limits.upper, 2);
  EXPECT_EQ(limits.effort, 3);
  EXPECT_EQ(limits.velocity, 4);

  const JointLimits& continuous = chain.joints()[2].limits;
  EXPECT_EQ(continuous.lower, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(continuous.upper, std::numeric_limits<double>::infinity());
  EXPECT_EQ(continuous.effort, 30);
  EXPECT_EQ(continuous.velocity, 40);
}

TEST(Urdf, JointsCarryTheDampingAndFrictionOfDynamics) {
  const auto chain = chainFromUrdf(
      robot(link("base", "") + link("a") + link("b") + link("c") +
            joint("both", "continuous", "base", "a", "<dynamics damping='0.5' friction='1.5'/>") +
            joint("one", "continuous", "a", "b", "<dynamics friction='2.5'/>") +
            joint("empty", "continuous", "b", "c", "<dynamics/>")));
  EXPECT_EQ(chain.joints()[0].damping, 0.5);
  EXPECT_EQ(chain.joints()[0].friction, 1.5);
  EXPECT_EQ(chain.joints()[1].damping, 0);
  EXPECT_EQ(chain.joints()[1].friction, 2.5);
  EXPECT_EQ(chain.joints()[2].damping, 0);
  EXPECT_EQ(chain.joints()[2].friction, 0);
}

TEST(Urdf, WhatMayBeLeftOutHasUrdfsMeaning) {
  // no origin: identity; no axis: x; no limit of a continuous joint: none
  const auto chain = chainFromUrdf(
      robot(link("base", "") + link("a") + joint("j", "continuous", "base", "a", "")));
  const Joint& made = chain.joints()[0];
  EXPECT_EQ(made.placement.p, Eigen::Vector3d::Zero());
  EXPECT_EQ(made.placement.R * Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX());
  EXPECT_EQ(made.limits.effort, std::numeric_limits<double>::infinity());
  EXPECT_EQ(made.limits.velocity, std::numeric_limits<double>::infinity());
}

TEST(Urdf, AxisAlongZLeavesTheFrameAlone) {
  const auto chain = chainFromUrdf(
      robot(link("base", "") + link("a") +
            joint("j", "continuous", "base", "a", "<origin xyz='1 2 3'/><axis xyz='0 0 2'/>")));
  EXPECT_EQ(chain.joints()[0].placement.R, Eigen::Matrix3d::Identity());
  EXPECT_EQ(chain.joints()[0].placement.p, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(chain.links()[0].first_moment, 2 * Eigen::Vector3d(0.1, 0.2, 0.3));
}

// The same robot with the same axis, written in a link frame turned by any rotation.
TEST(Urdf, TorquesDoNotDependOnTheDirectionOfAnAxisInItsFrame) {
  const auto turned = [](const std::string& axis, const std::string& rpy,
                         const Eigen::Vector3d& c) {
    const std::string center =
        std::to_string(c.x()) + " " + std::to_string(c.y()) + " " + std::to_string(c.z());
    return chainFromUrdf(robot(
        link("base", "") +
        link("a", "<inertial><origin xyz='" + center +
                      "'/><mass value='2'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' "
                      "izz='0.1'/></inertial>") +
        joint("j", "continuous", "base", "a",
              "<origin xyz='0.1 0.2 0.3' rpy='" + rpy + "'/><axis xyz='" + axis + "'/>")));
  };
  // axis x of the base throughout, center of mass 0.25 m along y of the base
  const std::string right = "1.5707963267948966";
  const auto plain = turned("1 0 0", "0 0 0", {0, 0.25, 0});
  const auto on_z = turned("0 0 1", "0 " + right + " 0", {0, 0.25, 0});
  const auto on_minus_z = turned("0 0 -1", "0 -" + right + " 0", {0, 0.25, 0});
  const auto on_minus_y = turned("0 -1 0", "0 0 " + right, {0.25, 0, 0});
  EXPECT_LT(difference(someTorques(plain), someTorques(on_z)), kRounding);
  EXPECT_LT(difference(someTorques(plain), someTorques(on_minus_z)), kRounding);
  EXPECT_LT(difference(someTorques(plain), someTorques(on_minus_y)), kRounding);
}

TEST(Urdf, LengthOfAnAxisHasNoInfluence) {
  const auto plain = chainFromUrdf(arm("<axis xyz='0.6 0 -0.8'/>"));
  for (const std::string axis : {"3 0 -4", "3e-200 0 -4e-200", "3e300 0 -4e300"}) {
    const auto other = chainFromUrdf(arm("<axis xyz='" + axis + "'/>"));
    EXPECT_LT(difference(someTorques(plain), someTorques(other)), kRounding) << axis;
  }
}

// Adds the torques of two ways to weld one body: as a link of its own, or into its parent.
TEST(Urdf, FixedLinksAreLumpedWhereTheyAre) {
  const std::string first = joint("j", "continuous", "base", "a", "<axis xyz='1 1 0'/>");
  const auto welded = chainFromUrdf(
      robot(link("base", "") + link("a", "") +
            link("b", inertial("2", "0.1", "<origin xyz='0.1 0.2 0.3' rpy='0.3 0.2 0.1'/>")) +
            first + joint("weld", "fixed", "a", "b", "<origin xyz='0 0 0.5'/>")));
  const auto one = chainFromUrdf(robot(
      link("base", "") +
      link("a", inertial("2", "0.1", "<origin xyz='0.1 0.2 0.8' rpy='0.3 0.2 0.1'/>")) + first));
  EXPECT_LT(difference(someTorques(welded), someTorques(one)), kRounding);
  EXPECT_LT(difference(welded.links()[0].toVector(), one.links()[0].toVector()), kRounding);
}

TEST(Urdf, InertiaBeforeTheFirstMovableJointHasNoInfluence) {
  const std::string rest = link("a") + joint("root", "fixed", "ground", "base", "") +
                           joint("j", "continuous", "base", "a", "");
  const auto light = chainFromUrdf(robot(link("ground", "") + link("base", "") + rest));
  const auto heavy =
      chainFromUrdf(robot(link("ground", inertial("50")) + link("base", inertial("70")) + rest));
  EXPECT_EQ(someTorques(light), someTorques(heavy));
}

TEST(Urdf, GravityIsInTheRootLinksFrame) {
  const std::string urdf =
      robot(link("world", "") + link("base", "") + link("a") +
            joint("mount", "fixed", "world", "base", "<origin rpy='1.5707963267948966 0 0'/>") +
            joint("j", "continuous", "base", "a", "<axis xyz='0 0 1'/>"));
  UrdfOptions from_base = between("base", "a");
  from_base.gravity = {0, -9.81, 0};  // z of world is y of base
  EXPECT_LT(
      difference(someTorques(chainFromUrdf(urdf)), someTorques(chainFromUrdf(urdf, from_base))),
      kRounding);
  const auto by_default = chainFromUrdf(urdf, between("base", "a"));
  EXPECT_GT(difference(someTorques(chainFromUrdf(urdf)), someTorques(by_default)), 0.1);
  EXPECT_THAT(by_default.warnings(),
              ElementsAre("URDF:4: link base: gravity isn't given, so it is [0, 0, -9.81] in the "
                          "frame of this root link; down the z axis of link world (joints between "
                          "them at zero) it would be [0, -9.81, 0]: give the one that is right"));
  EXPECT_THAT(chainFromUrdf(urdf, from_base).warnings(), IsEmpty());
  EXPECT_THAT(chainFromUrdf(urdf).warnings(), IsEmpty());
}

TEST(Urdf, ARootThatStandsUprightNeedsNoGravity) {
  // turned about the vertical, and by what 3.14 leaves of half a turn
  for (const char* const rpy : {"0 0 2", "-3.14 3.1416 1"}) {
    const std::string origin = "<origin rpy='" + std::string(rpy) + "'/>";
    const auto chain = chainFromUrdf(robot(link("world", "") + link("base", "") + link("a") +
                                           joint("mount", "fixed", "world", "base", origin) +
                                           joint("j", "continuous", "base", "a", "")),
                                     between("base", "a"));
    EXPECT_THAT(chain.warnings(), IsEmpty()) << rpy;
  }
}

TEST(Urdf, TipFrameIsKept) {
  const auto chain = chainFromUrdf(
      robot(link("base", "") + link("a") + link("tool", "") +
            joint("j", "continuous", "base", "a", "<axis xyz='1 0 0'/>") +
            joint("flange", "fixed", "a", "tool", "<origin xyz='0.1 0.2 0.3' rpy='0 0 1.5'/>")));
  const Transform<double> X = chain.joints()[0].placement * chain.tip();
  EXPECT_LT(difference(X.p, Eigen::Vector3d(0.1, 0.2, 0.3)), kRounding);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_LT(difference(X.R, R), kRounding);
}

TEST(Urdf, TextAfterAByteOrderMarkIsRead) {
  EXPECT_EQ(someTorques(chainFromUrdf("\xEF\xBB\xBF" + arm())), someTorques(chainFromUrdf(arm())));
}

// --- bodies attached to the chain ---

const char* const kFocusOrigin = "<origin xyz='0.2 0 0' rpy='0.3 0.7 0'/>";

/// arm() with a camera and its lens beside the chain, on a slider, and a finger beyond the tip.
std::string armWithAttachments(const std::string& finger = "") {
  return arm("", link("camera", inertial("1")) + link("lens", inertial("0.7")) +
                     link("finger", inertial("0.3")) +
                     joint("focus", "prismatic", "upper", "camera",
                           kFocusOrigin + std::string("<axis xyz='0 0 1'/>") + kLimit) +
                     joint("thread", "fixed", "camera", "lens", "<origin xyz='0 0.1 0'/>") +
                     joint("grip", "revolute", "tool", "finger",
                           "<axis xyz='0 1 0'/>" + std::string(kLimit) + finger));
}

/// What holds joints, by name.
std::function<std::optional<double>(const std::string&)> positions(
    const std::map<std::string, double>& held) {
  return [held](const std::string& name) {
    const auto found = held.find(name);
    return found == held.end() ? std::nullopt : std::optional<double>(found->second);
  };
}

/// The same, all of it welded on: with the camera moved along its slider, and the finger turned.
std::string armWithWeldedAttachments(const std::string& focus, const std::string& grip) {
  return arm("",
             link("slider", "") + link("camera", inertial("1")) + link("lens", inertial("0.7")) +
                 link("finger", inertial("0.3")) +
                 joint("rail", "fixed", "upper", "slider", kFocusOrigin) +
                 joint("focus", "fixed", "slider", "camera", "<origin xyz='0 0 " + focus + "'/>") +
                 joint("thread", "fixed", "camera", "lens", "<origin xyz='0 0.1 0'/>") +
                 joint("grip", "fixed", "tool", "finger", "<origin rpy='0 " + grip + " 0'/>"));
}

TEST(Urdf, AttachedBodiesAreLumpedWithTheirJointsAtZero) {
  const auto lumped = chainFromUrdf(armWithAttachments(), between("base", "tool"));
  const auto welded = chainFromUrdf(armWithWeldedAttachments("0", "0"), between("base", "tool"));
  EXPECT_LT(difference(someTorques(lumped), someTorques(welded)), kRounding);

  // all masses that move: upper and lower 2 each, tool 0.5, camera 1, lens 0.7, finger 0.3
  EXPECT_NEAR(lumped.links()[0].mass, 2 + 1 + 0.7, kRounding);
  EXPECT_NEAR(lumped.links()[1].mass, 2 + 0.5 + 0.3, kRounding);
}

TEST(Urdf, AttachedBodiesAreHeldAtTheirLockedPositions) {
  UrdfOptions options = between("base", "tool");
  options.locked_position = positions({{"focus", 0.15}, {"grip", 0.4}});
  const auto locked = chainFromUrdf(armWithAttachments(), options);
  const auto welded =
      chainFromUrdf(armWithWeldedAttachments("0.15", "0.4"), between("base", "tool"));
  EXPECT_LT(difference(someTorques(locked), someTorques(welded)), kRounding);
  const auto at_zero = chainFromUrdf(armWithAttachments(), between("base", "tool"));
  EXPECT_GT(difference(someTorques(locked), someTorques(at_zero)), 0.01);
}

TEST(Urdf, AttachedBodiesCanBeIgnored) {
  UrdfOptions options = between("base", "tool");
  options.lump_attached = false;
  const auto ignored = chainFromUrdf(armWithAttachments(), options);
  EXPECT_EQ(someTorques(ignored), someTorques(chainFromUrdf(arm(""))));

  // on a shorter chain the tool beyond the tip is attached, too
  options.tip = "lower";
  EXPECT_GT(
      difference(someTorques(chainFromUrdf(armWithAttachments(), options)), someTorques(ignored)),
      0.1);
}

TEST(Urdf, AttachedMimicJointFollowsTheJointItMimics) {
  const std::string mimic = "<mimic joint='focus' multiplier='2' offset='0.1'/>";
  UrdfOptions options = between("base", "tool");
  options.locked_position = positions({{"focus", 0.15}, {"grip", 99}});
  const auto following = chainFromUrdf(armWithAttachments(mimic), options);
  options.locked_position = positions({{"focus", 0.15}, {"grip", 0.4}});
  const auto locked = chainFromUrdf(armWithAttachments(), options);
  EXPECT_LT(difference(someTorques(following), someTorques(locked)), kRounding);
}

TEST(Urdf, AttachedMimicOfAChainJointIsAnError) {
  const std::string urdf = armWithAttachments("<mimic joint='elbow'/>");
  EXPECT_THAT(urdfError(urdf, between("base", "tool")),
              AllOf(HasSubstr("joint grip"), HasSubstr("elbow"), HasSubstr("ignore attached")));
  UrdfOptions ignoring = between("base", "tool");
  ignoring.lump_attached = false;
  EXPECT_EQ(urdfError(urdf, ignoring), "no error");
}

TEST(Urdf, AttachedMimicOfItselfIsAnError) {
  EXPECT_THAT(urdfError(armWithAttachments("<mimic joint='grip'/>"), between("base", "tool")),
              AllOf(HasSubstr("joint grip"), HasSubstr("follows itself"), HasSubstr("loop")));
}

TEST(Urdf, AttachedFloatingJointIsAnError) {
  const std::string urdf =
      arm("", link("balloon") + joint("string", "floating", "upper", "balloon", ""));
  EXPECT_THAT(urdfError(urdf, between("base", "tool")),
              AllOf(HasSubstr("joint string"), HasSubstr("got floating")));
}

TEST(Urdf, LockedPositionThatIsNotFiniteIsAnError) {
  UrdfOptions options = between("base", "tool");
  options.locked_position = [](const std::string&) { return std::nan(""); };
  EXPECT_THAT(urdfError(armWithAttachments(), options),
              AllOf(HasSubstr("joint shoulder: locked position"), HasSubstr("got nan")));
}

TEST(Urdf, JointsOfThePathWithALockedPositionAreHeldThere) {
  // from the base, and held by the tool
  for (const auto& [root, tip] : {std::pair("base", "tool"), std::pair("tool", "base")}) {
    UrdfOptions options = between(root, tip);
    options.gravity = Eigen::Vector3d(1, -2, -9.81);
    const Chain whole = chainFromUrdf(armWithAttachments(), options);
    for (const std::string held : {"shoulder", "elbow"}) {
      options.locked_position = positions({{held, 0.7}});
      const Chain chain = chainFromUrdf(armWithAttachments(), options);
      const auto n = static_cast<Eigen::Index>(whole.jointCount());
      ASSERT_EQ(chain.jointCount(), n - 1);

      Eigen::VectorXd q(n), qd(n), qdd(n), tau(n), left(n - 1);
      Eigen::MatrixXd state(3, n - 1);
      for (Eigen::Index i = 0, k = 0; i < n; ++i) {
        const bool moves = whole.jointNames()[static_cast<std::size_t>(i)] != held;
        q[i] = moves ? 0.3 : 0.7, qd[i] = moves ? -1.2 : 0, qdd[i] = moves ? 2 : 0;
        if (moves) state.col(k++) << q[i], qd[i], qdd[i];
      }
      torques(whole, q, qd, qdd, tau);
      torques(chain, state.row(0), state.row(1), state.row(2), left);
      for (Eigen::Index i = 0, k = 0; i < n; ++i) {
        if (whole.jointNames()[static_cast<std::size_t>(i)] == held) continue;
        EXPECT_NEAR(left[k++], tau[i], kRounding) << held << " of " << root;
      }
    }
  }
}

TEST(Urdf, LockedPositionsThatHaveNoInfluenceAreAWarning) {
  const auto warnings = [](const std::string& urdf, UrdfOptions options, const std::string& joint) {
    options.locked_position = positions({{joint, 0.3}});
    std::vector<std::string> found = chainFromUrdf(urdf, options).warnings();
    const auto others = [](const std::string& text) {
      return text.find("locked position") == std::string::npos;
    };
    found.erase(std::remove_if(found.begin(), found.end(), others), found.end());
    return found;
  };
  const std::string urdf = armWithAttachments("<mimic joint='focus'/>");
  UrdfOptions options = between("base", "tool");
  EXPECT_THAT(warnings(urdf, options, "focus"), IsEmpty());
  EXPECT_THAT(warnings(urdf, options, "weld"), ElementsAre(HasSubstr("the joint is fixed")));
  EXPECT_THAT(warnings(urdf, options, "grip"),
              ElementsAre(HasSubstr("the joint follows joint focus")));
  options.root = "upper";
  options.gravity = Eigen::Vector3d(0, 0, -9.81);
  EXPECT_THAT(warnings(urdf, options, "shoulder"),
              ElementsAre(HasSubstr("no moving link carries the joint")));
  options.lump_attached = false;
  EXPECT_THAT(warnings(urdf, options, "focus"),
              ElementsAre(HasSubstr("attached bodies are ignored")));
}

// --- root and tip ---

TEST(Urdf, EmptyTipIsTheLeafFarthestOut) {
  // a second leaf on a fixed joint, and one before any movable joint, however far, leave no doubt
  const std::string urdf = arm(
      "", link("label") + link("letter") + link("dot") + link("ink") + link("sensor", "") +
              joint("plate", "fixed", "base", "label", "") +
              joint("print", "fixed", "label", "letter", "") +
              joint("over", "fixed", "letter", "dot", "") + joint("in", "fixed", "dot", "ink", "") +
              joint("mount", "fixed", "lower", "sensor", ""));
  EXPECT_THAT(chainFromUrdf(urdf).jointNames(), ElementsAre("shoulder", "elbow"));
  EXPECT_LT(difference(someTorques(chainFromUrdf(urdf)),
                       someTorques(chainFromUrdf(urdf, between("base", "tool")))),
            kRounding);
}

TEST(Urdf, RootMayBeAnyLinkOnTheWay) {
  const auto part = chainFromUrdf(arm(), between("upper", ""));
  EXPECT_THAT(part.jointNames(), ElementsAre("elbow"));
}

TEST(Urdf, LeavesThatDifferInMovableJointsAreListed) {
  const std::string urdf =
      arm("", link("left") + link("right") + joint("left_joint", "prismatic", "tool", "left") +
                  joint("right_joint", "prismatic", "tool", "right"));
  EXPECT_THAT(urdfError(urdf), AllOf(HasSubstr("tip: expected one leaf below 'base'"),
                                     HasSubstr("left (moved by left_joint)"),
                                     HasSubstr("right (moved by right_joint)"),
                                     HasSubstr("name 'tool' as tip, where they part, or")));
  EXPECT_EQ(urdfError(urdf, between("", "left")), "no error");
  EXPECT_THAT(urdfError(urdf, between("tool", "")), HasSubstr("; name one of them as tip"));
}

TEST(Urdf, UnknownRootOrTipIsAnsweredByTheNearestNames) {
  EXPECT_EQ(urdfError(arm(), between("bsae", "")),
            "URDF: robot arm: root: expected a link of the robot, got 'bsae'; links: base, lower, "
            "tool, upper");
  EXPECT_THAT(
      urdfError(arm(), between("", "tol")),
      AllOf(HasSubstr("tip: expected a link of the robot, got 'tol'"), HasSubstr("links: tool, ")));
}

/// A lift on the floor, an arm on the lift, a camera on the arm's slider.
std::string lift() {
  return robot(
      link("floor", inertial("9")) + link("base", inertial("7")) + link("upper") +
      link("lower", inertial("3")) + link("camera", inertial("1")) +
      joint("up", "prismatic", "floor", "base",
            "<origin xyz='0 0 0.2'/><axis xyz='0 0 1'/>" + std::string(kLimit)) +
      joint("turn", "revolute", "base", "upper",
            "<origin xyz='0 0.1 0.4'/><axis xyz='0 0.6 0.8'/>" + std::string(kLimit)) +
      joint("slide", "prismatic", "upper", "lower",
            "<origin xyz='0 0.2 0.5' rpy='0 0 1.5707963267948966'/><axis xyz='0.6 0 0.8'/>" +
                std::string(kLimit)) +
      joint("pan", "fixed", "upper", "camera", "<origin xyz='0.1 0 0'/>"));
}

/// The same, held at `lower`, with the lift 0.3 m high: every origin inverted by hand.
std::string liftWrittenFromItsTip() {
  return robot(link("lower", inertial("3")) + link("at_slide", "") + link("upper") +
               link("at_turn", "") + link("base", inertial("7")) + link("floor", inertial("9")) +
               link("camera", inertial("1")) +
               joint("slide", "prismatic", "lower", "at_slide",
                     "<axis xyz='-0.6 0 -0.8'/>" + std::string(kLimit)) +
               joint("from_slide", "fixed", "at_slide", "upper",
                     "<origin xyz='-0.2 0 -0.5' rpy='0 0 -1.5707963267948966'/>") +
               joint("pan", "fixed", "upper", "camera", "<origin xyz='0.1 0 0'/>") +
               joint("turn", "revolute", "upper", "at_turn",
                     "<axis xyz='0 -0.6 -0.8'/>" + std::string(kLimit)) +
               joint("from_turn", "fixed", "at_turn", "base", "<origin xyz='0 -0.1 -0.4'/>") +
               joint("up", "fixed", "base", "floor", "<origin xyz='0 0 -0.5'/>"));
}

TEST(Urdf, ChainsUpTheTreeAreThoseOfTheRobotHeldAtTheirRoot) {
  UrdfOptions options = between("lower", "base");
  options.locked_position = [](const std::string& name) {
    return name == "up" ? std::optional(0.3) : std::nullopt;
  };
  const auto chain = chainFromUrdf(lift(), options);
  const auto expected = chainFromUrdf(liftWrittenFromItsTip(), between("lower", "base"));
  EXPECT_THAT(chain.jointNames(), ElementsAre("slide", "turn"));
  EXPECT_THAT(
      chain.warnings(),
      testing::Contains("URDF:6: link lower: as the root of the chain it is held, and tip base "
                        "moves, which is above it; swap root and tip if the robot stands on its "
                        "base"));
  EXPECT_LT(difference(someTorques(chain), someTorques(expected)), kRounding);
  EXPECT_NEAR(chain.links()[0].mass, 2 + 1, kRounding);  // upper and camera
  EXPECT_NEAR(chain.links()[1].mass, 7 + 9, kRounding);  // base and, held by the lift, floor

  const Eigen::Vector2d q(0.4, -0.7);
  EXPECT_LT(difference(tipPose(chain, q).p, tipPose(expected, q).p), kRounding);
  EXPECT_LT(difference(tipPose(chain, q).R, tipPose(expected, q).R), kRounding);

  options.lump_attached = false;
  EXPECT_NEAR(chainFromUrdf(lift(), options).links()[1].mass, 7, kRounding);
}

TEST(Urdf, RootAndTipMayBeOnTwoBranches) {
  const std::string urdf = armWithAttachments();
  const auto chain = chainFromUrdf(urdf, between("lens", "finger"));
  EXPECT_THAT(chain.jointNames(), ElementsAre("focus", "elbow", "grip"));

  // X_RT = X_BR^-1 X_BT
  const Eigen::Vector3d q(0.15, 0.9, -0.4);
  const double shoulder = 0.6;
  const auto to_root =
      tipPose(chainFromUrdf(urdf, between("base", "lens")), Eigen::Vector2d(shoulder, q[0]));
  const auto to_tip = tipPose(chainFromUrdf(urdf, between("base", "finger")),
                              Eigen::Vector3d(shoulder, q[1], q[2]));
  const auto expected = to_root.inverse() * to_tip;
  EXPECT_LT(difference(tipPose(chain, q).p, expected.p), kRounding);
  EXPECT_LT(difference(tipPose(chain, q).R, expected.R), kRounding);

  // the shoulder, and the base beyond it, are held where the path turns
  EXPECT_NEAR(chain.links()[0].mass, 2 + 2, kRounding);
}

TEST(Urdf, TheWorldIsNotAttachedToARobotThatFloatsInIt) {
  const std::string urdf = robot(link("world", inertial("9")) + link("torso") + link("left") +
                                 link("right") + joint("float", "floating", "world", "torso", "") +
                                 joint("l", "continuous", "torso", "left", "") +
                                 joint("r", "continuous", "torso", "right", ""));
  const auto chain = chainFromUrdf(urdf, between("left", "right"));
  EXPECT_THAT(chain.jointNames(), ElementsAre("l", "r"));
  EXPECT_NEAR(chain.links()[0].mass, 2, kRounding);  // torso
}

TEST(Urdf, ASecondBaseIsARootLikeTheFirst) {
  const std::string urdf =
      arm("", link("plate") + joint("print", "fixed", "base", "plate", "<origin xyz='0 0 0.7'/>"));
  EXPECT_LT(difference(someTorques(chainFromUrdf(urdf, between("plate", "tool"))),
                       someTorques(chainFromUrdf(urdf, between("base", "tool")))),
            kRounding);
}

TEST(Urdf, ChainWithoutMovableJointIsAnError) {
  EXPECT_THAT(urdfError(arm(), between("tool", "tool")),
              AllOf(HasSubstr("chain: expected at least one movable joint"),
                    HasSubstr("root and tip are the same link")));
  EXPECT_THAT(urdfError(arm(), between("tool", "")), HasSubstr("at least one movable joint"));
  EXPECT_THAT(urdfError(arm(), between("lower", "tool")),
              HasSubstr("only fixed joints from lower to tool"));
}

// --- bad input ---

TEST(UrdfError, MovableBodyWithoutMassNamesJointAndLink) {
  const std::string urdf = robot(link("base") + link("a", "") + link("b") +
                                 joint("first", "continuous", "base", "a", "") +
                                 joint("second", "continuous", "a", "b", ""));
  EXPECT_EQ(urdfError(urdf),
            "URDF: joint first: the body it moves: expected a mass, or an inertia matrix that is "
            "positive definite at every position, got no mass and no inertia; "
            "give link a an <inertial>, or set allow_massless to true");
  UrdfOptions options;
  options.allow_massless = true;
  EXPECT_EQ(urdfError(urdf, options), "no error");
}

TEST(Urdf, MasslessBodiesWithinAJointOfTwoAxesAreAccepted) {
  // the axes cross: wherever the body is, it can't be moved without energy
  const std::string links = robot(link("base") + link("a", "") + link("b") +
                                  joint("first", "continuous", "base", "a", "<axis xyz='0 0 1'/>") +
                                  joint("second", "continuous", "a", "b", "<axis xyz='0 1 0'/>"));
  EXPECT_EQ(urdfError(links), "no error");
}

TEST(UrdfError, MasslessBodiesWithinAWristOfThreeAxesAreRefused) {
  const std::string links = robot(link("base") + link("a", "") + link("b", "") + link("c") +
                                  joint("first", "continuous", "base", "a", "<axis xyz='0 0 1'/>") +
                                  joint("second", "continuous", "a", "b", "<axis xyz='0 1 0'/>") +
                                  joint("third", "continuous", "b", "c", "<axis xyz='0 0 1'/>"));
  EXPECT_THAT(urdfError(links), HasSubstr("joint first: the body it moves"));
}

TEST(UrdfError, UnsupportedJointsAreNamed) {
  const auto with = [](const std::string& type, const std::string& content) {
    return urdfError(robot(link("base") + link("a") + link("b") +
                           joint("first", "continuous", "base", "a", "") +
                           joint("odd", type, "a", "b", content)));
  };
  EXPECT_THAT(with("planar", ""), HasSubstr("joint odd: type: expected revolute, continuous, "
                                            "prismatic or fixed, got planar"));
  EXPECT_THAT(with("floating", ""), HasSubstr("joint odd: type: expected revolute, continuous, "
                                              "prismatic or fixed, got floating"));
  EXPECT_THAT(with("screw", ""), AllOf(HasSubstr("URDF:7: joint odd"), HasSubstr("'screw'")));
  EXPECT_THAT(with("continuous", "<mimic joint='first'/>"),
              AllOf(HasSubstr("joint odd: <mimic>"), HasSubstr("follows joint first")));
  EXPECT_THAT(with("continuous", "<mimic joint='x'/>"),
              HasSubstr("joint odd: <mimic> joint: expected a joint of the robot, got 'x'"));
}

TEST(UrdfError, GravityMustBeFinite) {
  UrdfOptions options;
  options.gravity = Eigen::Vector3d(0, 0, std::numeric_limits<double>::infinity());
  EXPECT_THAT(urdfError(arm(), options), HasSubstr("gravity: expected three finite numbers"));
}

TEST(UrdfError, NothingIsPrinted) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  urdfError("");
  urdfError(arm().substr(0, 400));
  urdfError(arm("<axis xyz='0 0 0'/>"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

TEST(Urdf, LinksThatNoRigidBodyCanBeAreNamed) {
  // the defect is the tool's, which is welded to the moved link
  const auto with = [](const std::string& tool) {
    return chainFromUrdf(robot(link("base", inertial("1", "-5")) + link("a") + link("tool", tool) +
                               joint("j", "continuous", "base", "a", "") +
                               joint("weld", "fixed", "a", "tool", "")))
        .warnings();
  };
  EXPECT_THAT(with(inertial("1", "-5")),
              ElementsAre(AllOf(HasSubstr("URDF:5: link tool, moved by joint j: "),
                                HasSubstr("aren't positive"))));
  EXPECT_THAT(with(inertial()), IsEmpty());
}

TEST(Urdf, TriangleInequalityBrokenIsAWarning) {
  const auto chain = chainFromUrdf(robot(link("base") + link("a", inertial("1", "5")) +
                                         joint("j", "continuous", "base", "a", "")));
  ASSERT_EQ(chain.warnings().size(), 1U);
  EXPECT_THAT(chain.warnings()[0], AllOf(HasSubstr("joint j"), HasSubstr("triangle inequality")));
  EXPECT_TRUE(chainFromUrdf(arm()).warnings().empty());
}

// --- what can be, but is hardly meant ---

/// Warnings of a chain of two links, the second of 7.3 kg, its inertia in kg m^2.
std::vector<std::string> warningsOfForearm(const std::string& ixx, const std::string& iyy,
                                           const std::string& izz) {
  const std::string forearm =
      "<inertial><origin xyz='0.02 0 -0.13'/><mass value='7.3'/>"
      "<inertia ixy='0' ixz='0' iyz='0' ixx='" +
      ixx + "' iyy='" + iyy + "' izz='" + izz + "'/></inertial>";
  return chainFromUrdf(robot(link("base", "") + link("upper") + link("forearm", forearm) +
                             joint("yaw", "revolute", "base", "upper",
                                   "<origin xyz='0 0 0.15'/>" + std::string(kLimit)) +
                             joint("pitch", "revolute", "upper", "forearm",
                                   "<origin xyz='0 0.3 0'/>" + std::string(kLimit))))
      .warnings();
}

TEST(UrdfDoubts, InertiaOfABodyLargerThanTheArmIsAWarning) {
  EXPECT_THAT(warningsOfForearm("0.3", "0.3", "0.1"), IsEmpty());
  // as long as the arm is
  EXPECT_THAT(warningsOfForearm("0.014", "2.95", "2.955"),
              ElementsAre(AllOf(HasSubstr("URDF:5: link forearm, moved by joint pitch: "),
                                HasSubstr("radius of gyration of 0.636 m in a chain of"))));
  // g mm^2
  EXPECT_THAT(warningsOfForearm("313692", "320080", "465064"),
              ElementsAre(HasSubstr("4.65e+05 kg m^2 for 7.3 kg is implausible")));
}

/// Warnings of a chain of two links of that mass, at that distance.
std::vector<std::string> warningsOfUnits(const std::string& mass, const std::string& length,
                                         const std::string& limit) {
  const std::string body =
      "<inertial><origin xyz='" + length + " 0 0'/><mass value='" + mass +
      "'/><inertia ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'/></inertial>";
  const std::string origin = "<axis xyz='0 1 0'/><origin xyz='" + length + " 0 0'/>";
  return chainFromUrdf(robot(link("base", "") + link("upper", body) + link("forearm", body) +
                             joint("shoulder", "revolute", "base", "upper", origin + limit) +
                             joint("elbow", "revolute", "upper", "forearm", origin + limit)))
      .warnings();
}

TEST(UrdfDoubts, UnitsOfMassLengthAndLimitsThatNoArmHasAreAWarning) {
  const std::string radians = "<limit lower='-2' upper='2' velocity='3' effort='50'/>";
  EXPECT_THAT(warningsOfUnits("2", "0.2", radians), IsEmpty());
  const auto gravity = ElementsAre(AllOf(HasSubstr("gravity takes"), HasSubstr("is 50 N m; ")));
  EXPECT_THAT(warningsOfUnits("2000", "0.2", radians), gravity);
  EXPECT_THAT(warningsOfUnits("2", "200", radians), gravity);
  EXPECT_THAT(
      warningsOfUnits("2", "0.2", "<limit lower='-120' upper='120' velocity='180' effort='50'/>"),
      ElementsAre(HasSubstr("joint shoulder: limits of -120 to 120 rad and 180 rad/s"),
                  HasSubstr("joint elbow")));
}

TEST(UrdfDoubts, InertiaThatHardlyCountsMayBeARoundNumber) {
  const std::string camera =
      "<inertial><mass value='0.001'/><inertia ixy='0' ixz='0' iyz='0' "
      "ixx='0.001' iyy='0.001' izz='0.001'/></inertial>";
  const std::string urdf =
      arm("<axis xyz='0 1 0'/>", link("camera", camera) + joint("eye", "fixed", "tool", "camera"));
  EXPECT_THAT(chainFromUrdf(urdf).warnings(), IsEmpty());
}

TEST(UrdfDoubts, AWheelMayHaveAnyRadius) {
  const auto chain = chainFromUrdf(robot(link("base") + link("wheel", inertial("1", "0.3", "")) +
                                         joint("axle", "continuous", "base", "wheel", "")));
  EXPECT_THAT(chain.warnings(), IsEmpty());
}

TEST(UrdfDoubts, MovingLinkWithoutInertialBeforeLinksWithMassIsAWarning) {
  UrdfOptions options;
  options.allow_massless = true;
  const auto warnings = [&](const std::string& middle, const std::string& last,
                            const std::string& x = "1") {
    return chainFromUrdf(robot(link("base", "") + link("a", middle) + link("b", last) +
                               joint("first", "continuous", "base", "a", "<axis xyz='0 0 1'/>") +
                               joint("second", "continuous", "a", "b",
                                     "<origin xyz='" + x + " 0 0'/><axis xyz='0 1 0'/>")),
                         options)
        .warnings();
  };
  EXPECT_THAT(warnings("", inertial("4")),
              ElementsAre("URDF:4: link a, moved by joint first: has no <inertial>, but links "
                          "beyond it have mass: it counts as massless"));
  EXPECT_THAT(warnings("<inertial><mass value='0'/><inertia ixx='0' ixy='0' ixz='0' iyy='0' "
                       "iyz='0' izz='0'/></inertial>",
                       inertial("4")),
              IsEmpty());
  EXPECT_THAT(warnings(inertial("4"), ""), IsEmpty());
  EXPECT_THAT(warnings("", inertial("4"), "0"), IsEmpty());  // two axes of one joint
}

TEST(UrdfDoubts, AWideBodyOnAShortChainIsNone) {
  const auto torso = chainFromUrdf(robot(
      link("base", "") + link("hip", inertial("4", "0.1", "")) +
      link("chest", inertial("5", "0.3", "")) + joint("yaw", "continuous", "base", "hip", "") +
      joint("pitch", "continuous", "hip", "chest", "<origin xyz='0 0 0.1'/>")));
  EXPECT_THAT(torso.warnings(), IsEmpty());
}

TEST(UrdfDoubts, PositionFarBeyondTheLimitsOfALockedJointIsAWarning) {
  const auto warnings = [](double position) {
    UrdfOptions options = between("base", "tool");
    options.locked_position = [position](const std::string& name) {
      return name == "grip" ? std::optional<double>(position) : std::nullopt;
    };
    return chainFromUrdf(arm("<axis xyz='0 1 0'/>",
                             link("finger") + joint("grip", "prismatic", "tool", "finger",
                                                    "<limit lower='0' upper='0.04' effort='1' "
                                                    "velocity='1'/>")),
                         options)
        .warnings();
  };
  EXPECT_THAT(warnings(-0.002), IsEmpty());  // a gripper that closes a little too far
  EXPECT_THAT(warnings(30.0), testing::Contains(AllOf(
                                  HasSubstr("joint grip: held at 30 m"),
                                  HasSubstr("beyond its limits of 0 to 0.04; check the unit"))));
}

}  // namespace chain_dynamics::urdf_test

// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "example_robots.hpp"
#include "random_chains.hpp"
#include "reference.hpp"

namespace chain_dynamics {
namespace {

const Eigen::Vector3d kGravity(0, 0, -9.81);
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A sound arm of three joints, to be spoilt by one change at a time.
struct Parts {
  std::vector<Joint> joints;
  std::vector<LinkParameters> links;
  Eigen::Vector3d gravity = kGravity;
  Transform<double> tip = Transform<double>::identity();
};

Parts soundParts() {
  const Chain chain = test::randomChain(3);
  return {chain.joints(), chain.links()};
}

// The text of the error that a chain with one change gives.
std::string errorAfter(const std::function<void(Parts&)>& change) {
  Parts parts = soundParts();
  change(parts);
  return errorOf([&] { Chain("arm", parts.joints, parts.links, parts.gravity, parts.tip); });
}

TEST(ModelError, SaysWhereWhatExpectedGotAndRemedy) {
  EXPECT_STREQ(ModelError("arm.yaml:31: joint elbow", "friction", "5 numbers", "4 numbers",
                          "give fv, fo, fc, alpha, nu")
                   .what(),
               "arm.yaml:31: joint elbow: friction: expected 5 numbers, got 4 numbers; give fv, "
               "fo, fc, alpha, nu");
  EXPECT_STREQ(ModelError("arm", "mass", "a number", "none", "").what(),
               "arm: mass: expected a number, got none");
}

TEST(Chain, KeepsWhatItWasGiven) {
  const Parts parts = soundParts();
  const Transform<double> tip = test::shiftedBy({0, 0, 0.1});
  const Chain chain("arm", parts.joints, parts.links, kGravity, tip);
  EXPECT_EQ(chain.name(), "arm");
  EXPECT_EQ(chain.jointCount(), 3);
  EXPECT_EQ(chain.jointNames(), (std::vector<std::string>{"joint1", "joint2", "joint3"}));
  EXPECT_EQ(chain.joints()[1].placement.R, parts.joints[1].placement.R);
  EXPECT_EQ(chain.links()[2].toVector(), parts.links[2].toVector());
  EXPECT_EQ(chain.gravity(), kGravity);
  EXPECT_EQ(chain.tip().p, tip.p);
  EXPECT_TRUE(chain.warnings().empty());
}

TEST(Chain, WithOtherGravityIsTheSameChainOtherwise) {
  const Chain chain = test::randomChain(3);
  const Chain floating = chain.withGravity({0, 0, 0});
  EXPECT_EQ(floating.gravity(), Eigen::Vector3d(0, 0, 0));
  EXPECT_NE(chain.gravity(), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(floating.jointNames(), chain.jointNames());
  EXPECT_EQ(floating.links()[0].toVector(), chain.links()[0].toVector());
}

TEST(Chain, RefusesPartsThatMakeNoRobot) {
  using Change = std::function<void(Parts&)>;
  const std::vector<std::pair<Change, std::string>> mistakes = {
      {[](Parts& parts) { parts.joints.clear(), parts.links.clear(); },
       "joints: expected at least one movable joint, got none; a chain without joints has no "
       "torques"},
      {[](Parts& parts) { parts.links.pop_back(); }, "links: expected one per joint (3), got 2"},
      {[](Parts& parts) { parts.joints[1].name = ""; },
       "name of joint 2: expected a name, got none"},
      {[](Parts& parts) { parts.joints[2].name = "joint1"; },
       "joint names: expected each once, got 'joint1' twice"},
      {[](Parts& parts) { parts.gravity.x() = kNan; },
       "gravity: expected three finite numbers up to 1e6 [m/s^2], got [nan, 0, -9.81]; for example "
       "[0, 0, -9.81]"},
      {[](Parts& parts) { parts.joints[1].placement.p.y() = kInfinity; },
       "joint joint2: placement: expected finite numbers, got a NaN or an infinity"},
      {[](Parts& parts) { parts.tip.p.y() = kNan; },
       "tip: expected finite numbers, got a NaN or an infinity"},
      {[](Parts& parts) { parts.links[2].inertia(0, 0) = kNan; },
       "link moved by joint joint3: inertial parameters: expected ten finite numbers, got a NaN or "
       "an "
       "infinity"},
      {[](Parts& parts) { parts.joints[0].placement.R = Eigen::Vector3d(1, 1, 2).asDiagonal(); },
       "joint joint1: placement: expected a rotation matrix, got columns off orthonormal by 3, "
       "determinant 2; make it from angles or a unit quaternion"},
      {[](Parts& parts) { parts.joints[0].placement.R = Eigen::Vector3d(1, 1, -1).asDiagonal(); },
       "joint joint1: placement: expected a rotation matrix, got columns off orthonormal by 0, "
       "determinant -1; make it from angles or a unit quaternion"},
      {[](Parts& parts) { parts.joints[2].limits.lower = 1, parts.joints[2].limits.upper = -1; },
       "joint joint3: position limits: expected lower <= upper, got 1 and -1; leave out what is "
       "unknown"},
      {[](Parts& parts) { parts.joints[2].limits.velocity = -3; },
       "joint joint3: velocity limit: expected a number >= 0, got -3; leave out what is unknown"},
      {[](Parts& parts) { parts.joints[2].limits.jerk = -5; },
       "joint joint3: jerk limit: expected a number >= 0, got -5; leave out what is unknown"},
      {[](Parts& parts) { parts.links[1].mass = -0.5; },
       "link moved by joint joint2: mass: expected a number >= 0 [kg], got -0.5"},
      {[](Parts& parts) { parts.joints[1].rotor_inertia = -1e-3; },
       "joint joint2: rotor inertia: expected a finite number >= 0, got -0.001"},
      {[](Parts& parts) {
         parts.links[1].inertia = Eigen::Matrix3d::Identity();
         parts.links[1].inertia(0, 1) = 0.25;
       },
       "link moved by joint joint2: moment of inertia: expected a symmetric matrix, got entries "
       "that "
       "differ by 0.25"}};
  for (const auto& [change, text] : mistakes) EXPECT_EQ(errorAfter(change), "chain arm: " + text);
  EXPECT_EQ(errorAfter([](Parts&) {}), "no error");
  EXPECT_NE(errorAfter([](Parts& parts) { parts.joints[2].limits.upper = kNan; }), "no error");
  for (const double too_much : {-1.1e6, 1e50, 1e308, kInfinity}) {
    EXPECT_NE(errorAfter([&](Parts& parts) { parts.gravity.y() = too_much; }), "no error");
  }
  EXPECT_THROW(test::randomChain(2).withGravity({0, kInfinity, 0}), ModelError);
}

// 1, 1 and 3 kg m^2: no body is that flat.
TEST(Chain, WarnsOfABrokenTriangleInequality) {
  Parts parts = soundParts();
  parts.links[1] =
      LinkParameters::fromCenterOfMass(1, {0, 0, 0}, Eigen::Vector3d(1, 3, 1).asDiagonal());
  const Chain chain("arm", parts.joints, parts.links, kGravity);
  ASSERT_EQ(chain.warnings().size(), 1U);
  EXPECT_EQ(chain.warnings()[0],
            "chain arm: link moved by joint joint2: principal moments of inertia [1, 1, 3] about "
            "the center of mass break the triangle inequality");
}

TEST(Unwrapped, IsTheShortWayOfAContinuousJointAlone) {
  constexpr double kPi = 3.141592653589793;
  constexpr double kTolerance = 1e-12;  // rounding of a few hundred turns
  const auto difference = [](JointType type, double from, double to) {
    return unwrapped(type, to, from) - from;
  };
  EXPECT_NEAR(difference(JointType::kContinuous, 3.141, -3.141), 2 * kPi - 6.282, kTolerance);
  EXPECT_NEAR(difference(JointType::kContinuous, -3.141, 3.141), 6.282 - 2 * kPi, kTolerance);
  EXPECT_NEAR(difference(JointType::kContinuous, 0.1, 0.2 + 600 * kPi), 0.1, kTolerance);
  EXPECT_EQ(difference(JointType::kRevolute, -3.141, 3.141), 6.282);
  EXPECT_EQ(difference(JointType::kPrismatic, -7.0, 7.0), 14.0);
  EXPECT_EQ(unwrapped(JointType::kContinuous, 0.1, 3.2), 0.1);  // bit for bit within half a turn
  for (const double bad : {kNan, kInfinity}) {
    EXPECT_FALSE(std::isfinite(unwrapped(JointType::kContinuous, bad, 0.0)));
    EXPECT_FALSE(std::isfinite(unwrapped(JointType::kContinuous, 0.0, bad)));
  }
}

TEST(Unwrapped, OfAChainFollowsTheTypesOfItsJoints) {
  Parts parts = soundParts();
  parts.joints[0].type = JointType::kContinuous;
  parts.joints[1].type = JointType::kRevolute;
  parts.joints[2].type = JointType::kPrismatic;
  const Chain chain("arm", parts.joints, parts.links, kGravity);
  Eigen::Vector3d q(-3.0, -3.0, -3.0);
  unwrap(chain.jointTypes(), Eigen::Vector3d(9.0, 9.0, 9.0), q);
  EXPECT_NEAR(q[0], 9.566370614359172, 1e-12);  // -3 + 4 pi
  EXPECT_EQ(q[1], -3.0);
  EXPECT_EQ(q[2], -3.0);
}

TEST(InertiaDefect, IsNoneForAnyBody) {
  test::Random random(1);
  for (int trial = 0; trial < 100; ++trial) {
    EXPECT_EQ(inertiaDefect(test::randomLink(random)), "");
  }
}

// A point and a thin rod lie on the edge of what is possible: rounding must not push them off.
TEST(InertiaDefect, IsNoneForAPointAndARodFarFromTheOrigin) {
  EXPECT_EQ(inertiaDefect(test::pointMass(0.3, {0.7, -1.1, 12.3})), "");
  EXPECT_EQ(inertiaDefect(test::pointMass(0.3, {0.7, -1.1, 2.3}) +
                          test::pointMass(0.1, {-0.7, 1.1, 0.3})),
            "");
}

TEST(InertiaDefect, IsNoneForNothingAtAll) { EXPECT_EQ(inertiaDefect(LinkParameters::zero()), ""); }

TEST(InertiaDefect, SeesWhatNoBodyHas) {
  EXPECT_EQ(inertiaDefect(LinkParameters::fromCenterOfMass(
                1, {0, 0, 0}, Eigen::Vector3d(1, 1, -0.5).asDiagonal())),
            "principal moments of inertia [-0.5, 1, 1] about the center of mass aren't positive");
  EXPECT_EQ(inertiaDefect({0, {0.1, 0, 0}, Eigen::Matrix3d::Zero()}), "inertia without mass");
  EXPECT_EQ(inertiaDefect({-2, {0, 0, 0}, Eigen::Matrix3d::Zero()}), "negative mass -2");
}

}  // namespace
}  // namespace chain_dynamics

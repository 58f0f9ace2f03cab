// SPDX-License-Identifier: Apache-2.0

// inertiaIsPhysical() is a proof: where it says yes, no position has a singular inertia matrix.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "chain_dynamics/inertia_matrix.hpp"
#include "chain_dynamics/model.hpp"
#include "example_robots.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using Eigen::Index;
using Eigen::VectorXd;

const double kQuarter = std::acos(0.0);

bool isPhysical(const Chain& chain) { return Model(chain).inertiaIsPhysical(); }

/// A solid ball, or one that is off the axes.
LinkParameters ball(const Eigen::Vector3d& at = Eigen::Vector3d::Zero()) {
  return LinkParameters::fromCenterOfMass(2.0, at, 0.01 * Eigen::Matrix3d::Identity());
}

/// A joint whose axis is turned by an angle about x and moved by p against the one before.
Joint turned(const std::string& name, double angle, const Eigen::Vector3d& p = {0, 0, 0}) {
  Joint joint;
  joint.name = name;
  joint.placement = {Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()).matrix(), p};
  return joint;
}

Joint sliding(Joint joint) {
  joint.type = JointType::kPrismatic;
  return joint;
}

Chain chainOf(const std::vector<Joint>& joints, const std::vector<LinkParameters>& links) {
  return Chain("chain", joints, links, {0, 0, -9.81});
}

const LinkParameters kNothing = LinkParameters::zero();

/// Three axes in one point, each perpendicular to the next.
std::vector<Joint> wrist() {
  return {turned("roll", 0), turned("pitch", kQuarter), turned("yaw", kQuarter)};
}

// --- cases worked by hand ---

TEST(DefiniteInertia, WristWhoseFirstLinksAreMassesOnTheAxesIsSingularStraight) {
  const LinkParameters on_axes = pointMass(1, {0, 0, 0});
  const Chain chain = chainOf(wrist(), {on_axes, on_axes, ball({0, 0, 0.1})});
  Eigen::MatrixXd H(3, 3);
  inertiaMatrix(chain, VectorXd::Zero(3), H);
  ASSERT_LT(std::abs(H.determinant()), 1e-15);  // roll and yaw turn about one line
  EXPECT_FALSE(isPhysical(chain));
}

TEST(DefiniteInertia, MasslessWristOfThreeAxesIsSingularWhateverItsAngles) {
  for (const double angle : {0.4, 1.0, kQuarter}) {
    const std::vector<Joint> joints = {turned("a", 0), turned("b", angle), turned("c", 0.9)};
    EXPECT_FALSE(isPhysical(chainOf(joints, {kNothing, kNothing, ball()}))) << angle;
  }
}

TEST(DefiniteInertia, TwoCrossingAxesCarryABody) {
  for (const double angle : {0.05, 0.4, kQuarter, 3.0}) {
    const std::vector<Joint> joints = {turned("a", 0), turned("b", angle)};
    EXPECT_TRUE(isPhysical(chainOf(joints, {kNothing, ball()}))) << angle;
    EXPECT_TRUE(isPhysical(chainOf(joints, {kNothing, ball({0.3, -0.1, 0.5})}))) << angle;
  }
}

TEST(DefiniteInertia, TwoJointsAboutOneAxisAreSingular) {
  EXPECT_FALSE(isPhysical(
      chainOf({turned("a", 0), turned("b", 0, {0, 0, 0.3})}, {kNothing, ball({0.1, 0, 0})})));
}

TEST(DefiniteInertia, TwoParallelAxesAreSingularOnlyIfTheBodyIsAPoint) {
  const std::vector<Joint> joints = {turned("a", 0), turned("b", 0, {0.3, 0, 0})};
  EXPECT_TRUE(isPhysical(chainOf(joints, {kNothing, ball({0.2, 0, 0})})));
  // stretched out, a point mass moves across the arm only
  EXPECT_FALSE(isPhysical(chainOf(joints, {kNothing, pointMass(1, {0.2, 0, 0})})));
}

TEST(DefiniteInertia, ThreeAxesOfWhichNoThreeMeetMayBeMassless) {
  // as at a hip: the third axis is beside the point where the first two meet
  const std::vector<Joint> joints = {turned("a", 0), turned("b", kQuarter),
                                     turned("c", kQuarter, {0.2, 0.1, 0})};
  EXPECT_TRUE(isPhysical(chainOf(joints, {kNothing, kNothing, ball()})));
}

TEST(DefiniteInertia, EveryGroupOfALongChainCounts) {
  std::vector<Joint> joints = wrist();
  joints.push_back(turned("a", 0.7, {0.3, 0, 0}));
  joints.push_back(turned("b", kQuarter));
  EXPECT_TRUE(isPhysical(chainOf(joints, {kNothing, ball(), ball(), kNothing, ball()})));
  EXPECT_FALSE(isPhysical(chainOf(joints, {kNothing, ball(), ball(), ball(), kNothing})));
}

TEST(DefiniteInertia, RotorsCount) {
  std::vector<Joint> joints = wrist();
  const std::vector<LinkParameters> links = {kNothing, kNothing, ball()};
  joints[0].rotor_inertia = 1e-3;
  EXPECT_TRUE(isPhysical(chainOf(joints, links)));
  joints[0].rotor_inertia = 0;
  joints[2].rotor_inertia = 1e-3;
  EXPECT_TRUE(isPhysical(chainOf(joints, links)));
}

TEST(DefiniteInertia, SlidesMayBeOfAnyLength) {
  // a gantry; an arm that turns and extends; the same with a point mass, which may come to the axis
  const std::vector<Joint> gantry = {sliding(turned("x", 0)), sliding(turned("y", kQuarter)),
                                     sliding(turned("z", 0.3))};
  EXPECT_FALSE(isPhysical(chainOf(gantry, {kNothing, kNothing, ball()})));  // three in a plane
  EXPECT_TRUE(isPhysical(chainOf({gantry[0], gantry[1]}, {kNothing, pointMass(1, {0, 0, 0})})));
  const std::vector<Joint> polar = {turned("turn", 0), sliding(turned("slide", kQuarter))};
  EXPECT_TRUE(isPhysical(chainOf(polar, {kNothing, ball()})));
  EXPECT_FALSE(isPhysical(chainOf(polar, {kNothing, pointMass(1, {0, 0, 0})})));
  EXPECT_FALSE(isPhysical(turntable(2)));
}

TEST(DefiniteInertia, ChainOfSmallOrLargeBodiesIsTheSame) {
  for (const double size : {1e-6, 1e-3, 1e3, 1e6}) {
    for (const double mass : {1e-9, 1e9}) {
      const auto body =
          LinkParameters::fromCenterOfMass(mass, size * Eigen::Vector3d(0.1, 0, 0),
                                           0.01 * mass * size * size * Eigen::Matrix3d::Identity());
      const std::vector<Joint> joints = {turned("a", 0),
                                         turned("b", 1, size * Eigen::Vector3d::UnitX())};
      EXPECT_TRUE(isPhysical(chainOf(joints, {kNothing, body}))) << size << " m " << mass << " kg";
    }
  }
}

// --- random chains against a search for singular positions ---

/// Bodies of all kinds that a chain may have: none, points, rods, solid ones; on the axis or off.
LinkParameters randomBody(Random& random) {
  const double which = random();
  if (which < -0.2) return LinkParameters::zero();
  Eigen::Vector3d at = 0.3 * random.vector3();
  if (random() < 0) at.head(2).setZero();
  if (random() < -0.5) at.setZero();
  if (which < 0.1) return pointMass(1.5 + random(), at);
  const Eigen::Vector3d along = random.vector3();
  if (which < 0.4) return pointMass(1, at + 0.2 * along) + pointMass(1, at - 0.2 * along);
  return randomLink(random);
}

/// Axes at any angle and at right ones, through one point and not; slides; some rotors.
Chain randomSparseChain(Index n, std::uint32_t seed) {
  Random random(seed);
  std::vector<Joint> joints;
  std::vector<LinkParameters> links;
  for (Index i = 0; i < n; ++i) {
    Joint joint = turned("joint" + std::to_string(i), random() < 0 ? kQuarter : 3 * random());
    if (random() < -0.4) joint.placement.R = random.rotation();
    if (random() < -0.2) joint.placement.p = 0.3 * random.vector3();
    if (random() < -0.6) joint.type = JointType::kPrismatic;
    if (random() < -0.7) joint.rotor_inertia = 0.05;
    joints.push_back(joint);
    links.push_back(randomBody(random));
  }
  return chainOf(joints, links);
}

/// Least eigenvalue of H, joints scaled so that its diagonal is one.
double leastEigenvalue(const Chain& chain, const VectorXd& q) {
  const Index n = chain.jointCount();
  Eigen::MatrixXd H(n, n);
  inertiaMatrix(chain, q, H);
  const VectorXd diagonal = H.diagonal();
  if (!(diagonal.minCoeff() > 0)) return 0;
  const VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd G = scale.asDiagonal() * H * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(G, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

/// The least that a search from many positions finds: joint by joint, in ever smaller steps.
double leastFound(const Chain& chain, int starts) {
  Random random(5);
  double least = std::numeric_limits<double>::infinity();
  for (int start = 0; start < starts; ++start) {
    VectorXd q = 3.2 * random.vector(chain.jointCount());
    if (start % 3 == 0) q = kQuarter * q.array().round();
    double value = leastEigenvalue(chain, q);
    for (double step = 1; step > 1e-7; step /= 2) {
      for (Index j = 0; j < q.size(); ++j) {
        for (const double move : {step, -step}) {
          VectorXd other = q;
          other[j] += move;
          const double there = leastEigenvalue(chain, other);
          if (there < value) {
            value = there;
            q = other;
          }
        }
      }
    }
    least = std::min(least, value);
  }
  return least;
}

TEST(DefiniteInertia, NoPositionOfARandomChainIsSingularWhereItIsProved) {
  int proved = 0;
  int proved_with_massless = 0;
  int refuted = 0;
  int undecided = 0;
  for (std::uint32_t seed = 0; seed < 150; ++seed) {
    const Chain chain = randomSparseChain(1 + seed % 5, seed);
    const double least = leastFound(chain, 12);
    if (isPhysical(chain)) {
      ++proved;
      const auto& links = chain.links();
      const bool massless = std::any_of(links.begin(), links.end(),
                                        [](const auto& link) { return link.toVector().isZero(0); });
      proved_with_massless += massless ? 1 : 0;
      EXPECT_GT(least, 1e-10) << "seed " << seed;
    } else {
      (least < 1e-9 ? refuted : undecided) += 1;
    }
  }
  // The test sees something, and a proof is found nearly everywhere where there is one.
  EXPECT_GT(proved, 25);
  EXPECT_GT(proved_with_massless, 5);
  EXPECT_GT(refuted, 25);
  EXPECT_LT(undecided, 8);
}

}  // namespace
}  // namespace chain_dynamics

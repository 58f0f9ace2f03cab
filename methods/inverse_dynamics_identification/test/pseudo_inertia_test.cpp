// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/pseudo_inertia.hpp"

#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/error.hpp>
#include <chain_dynamics/spatial.hpp>
#include <limits>
#include <random>

#include "arms.hpp"

namespace inverse_dynamics_identification::pseudo_inertia_test {

using ::testing::HasSubstr;
constexpr double kRounding = 1e-14;

TEST(PseudoInertia, OfTwoPointMassesByHand) {
  // 2 kg at (1, 0, 0) and 1 kg at (0, 2, 0): Ixx = 4, Iyy = 2, Izz = 6
  LinkParameters link = LinkParameters::zero();
  link.mass = 3;
  link.first_moment = {2, 2, 0};
  link.inertia = Eigen::Vector3d(4, 2, 6).asDiagonal();
  Eigen::Matrix4d expected;
  expected << 2, 0, 0, 2, 0, 4, 0, 2, 0, 0, 0, 0, 2, 2, 0, 3;
  EXPECT_EQ(pseudoInertia(link), expected);
  EXPECT_EQ(fromPseudoInertia(expected).toVector(), link.toVector());
}

TEST(PseudoInertia, MovesWithTheFrame) {
  const LinkParameters link = rod(2, 0.5);
  const chain_dynamics::Transform<double> X{rotation(0.4, -1.1, 2), {0.3, -0.2, 0.7}};
  Eigen::Matrix4d homogeneous = Eigen::Matrix4d::Identity();
  homogeneous.topLeftCorner<3, 3>() = X.R;
  homogeneous.topRightCorner<3, 1>() = X.p;
  const Eigen::Matrix4d expected = homogeneous * pseudoInertia(link) * homogeneous.transpose();
  EXPECT_LT((pseudoInertia(X * link) - expected).cwiseAbs().maxCoeff(), kRounding);
}

TEST(PseudoInertia, ParameterGradientIsThatOfALinearFunction) {
  std::mt19937 random(1);
  const Eigen::Matrix4d half = uniform(4, 4, 1, random);
  const Eigen::Matrix4d M = half + half.transpose();
  for (Eigen::Index k = 0; k < 10; ++k) {
    Eigen::Matrix<double, 10, 1> unit = Eigen::Matrix<double, 10, 1>::Zero();
    unit[k] = 1;
    const double change = (M * pseudoInertia(LinkParameters::fromVector(unit))).trace();
    EXPECT_NEAR(parameterGradient(M)[k], change, kRounding) << k;
  }
}

TEST(LinkPrior, LeavesABodyAlone) {
  const LinkParameters link = rod(2, 0.5);
  const LinkPrior prior = linkPrior(link);
  EXPECT_EQ(prior.changes, "");
  EXPECT_LT((prior.link.toVector() - link.toVector()).cwiseAbs().maxCoeff(), kRounding);
}

// A rod without thickness, whose inertia about its axis is zero, off the origin.
LinkParameters thinRod() {
  return LinkParameters::fromCenterOfMass(3, {0.2, 0.1, 0},
                                          Eigen::Vector3d(0, 0.1, 0.1).asDiagonal());
}

TEST(LinkPrior, GivesThicknessAboutTheCenterOfMassInPrincipalAxes) {
  LinkFloor floor;
  floor.radius = 0.02;
  const LinkPrior prior = linkPrior(thinRod(), floor);
  EXPECT_THAT(prior.changes, HasSubstr("at least 0.0012 kg m^2 instead of"));
  EXPECT_DOUBLE_EQ(prior.link.mass, 3);
  EXPECT_LT((prior.link.first_moment - Eigen::Vector3d(0.6, 0.3, 0)).norm(), kRounding);
  const Eigen::Matrix3d about_center = chain_dynamics::inertiaAboutCenter(prior.link);
  const Eigen::Matrix3d expected = Eigen::Vector3d(0.0024, 0.1012, 0.1012).asDiagonal();
  EXPECT_LT((about_center - expected).cwiseAbs().maxCoeff(), kRounding);
}

TEST(LinkPrior, DoesNotDependOnTheFrame) {
  const chain_dynamics::Transform<double> X{rotation(0.4, -1.1, 2), {0.3, -0.2, 0.7}};
  const LinkParameters here = linkPrior(thinRod()).link;
  const LinkParameters there = linkPrior(X * thinRod()).link;
  EXPECT_LT(((X * here).toVector() - there.toVector()).cwiseAbs().maxCoeff(), kRounding);
}

TEST(LinkPrior, IsABodyWhateverIsDescribed) {
  std::mt19937 random(2);
  for (int k = 0; k < 1000; ++k) {
    const Eigen::Matrix<double, 10, 1> numbers = uniform(10, 1, 2, random);
    const LinkPrior prior = linkPrior(LinkParameters::fromVector(numbers));
    EXPECT_EQ(pseudoInertia(prior.link).llt().info(), Eigen::Success) << numbers.transpose();
    EXPECT_EQ(chain_dynamics::inertiaDefect(prior.link), "") << numbers.transpose();
  }
  EXPECT_THAT(linkPrior(LinkParameters::zero()).changes, HasSubstr("0.05 kg instead of 0 kg"));
}

TEST(LinkPrior, RefusesNumbersThatAreNotFinite) {
  LinkParameters link = rod(1, 1);
  link.inertia(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(linkPrior(link), chain_dynamics::ModelError);
}

}  // namespace inverse_dynamics_identification::pseudo_inertia_test

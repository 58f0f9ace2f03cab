// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/spatial.hpp"

#include <gtest/gtest.h>

#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using test::Random;

// Products and sums of a few numbers of size one: some units in the last place.
constexpr double kSpatialRounding = 1e-14;

constexpr int kTrials = 20;

Transform<double> randomTransform(Random& random) { return {random.rotation(), random.vector3()}; }
Motion<double> randomMotion(Random& random) { return {random.vector3(), random.vector3()}; }
Force<double> randomForce(Random& random) { return {random.vector3(), random.vector3()}; }

double distance(const Motion<double>& a, const Motion<double>& b) {
  return (a.angular - b.angular).norm() + (a.linear - b.linear).norm();
}
double distance(const Force<double>& a, const Force<double>& b) {
  return (a.moment - b.moment).norm() + (a.force - b.force).norm();
}
double distance(const LinkParameters& a, const LinkParameters& b) {
  return (a.toVector() - b.toVector()).norm();
}
double distance(const Transform<double>& a, const Transform<double>& b) {
  return (a.R - b.R).norm() + (a.p - b.p).norm();
}

TEST(Skew, IsTheCrossProduct) {
  Random random(1);
  const Eigen::Vector3d a = random.vector3();
  const Eigen::Vector3d b = random.vector3();
  EXPECT_LE((skew<double>(a) * b - a.cross(b)).norm(), kSpatialRounding);
}

// 5 N along y, at the end of a lever of 2 m along x: 10 N m about z, seen from the lever's start.
TEST(Force, OnALeverHasAMoment) {
  const Transform<double> X_AB{Eigen::Matrix3d::Identity(), {2, 0, 0}};
  const Force<double> F_A = X_AB * Force<double>{{0, 0, 0}, {0, 5, 0}};
  EXPECT_EQ(F_A.moment, Eigen::Vector3d(0, 0, 10));
  EXPECT_EQ(F_A.force, Eigen::Vector3d(0, 5, 0));
}

// Turning at 3 rad/s about z, a point 2 m along x moves at 6 m/s along y. In a frame there whose x
// axis points along that y, it moves along x.
TEST(Motion, OfATurningBodyIsFasterFartherOut) {
  Transform<double> X_AB = Transform<double>::identity();
  X_AB.R << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // columns: x_B = y_A, y_B = -x_A, z_B = z_A
  X_AB.p << 2, 0, 0;
  const Motion<double> V_B = X_AB.inverseTimes(Motion<double>{{0, 0, 3}, {0, 0, 0}});
  EXPECT_EQ(V_B.angular, Eigen::Vector3d(0, 0, 3));
  EXPECT_EQ(V_B.linear, Eigen::Vector3d(6, 0, 0));
}

TEST(Transform, ComposedActsLikeOneAfterTheOther) {
  Random random(2);
  for (int trial = 0; trial < kTrials; ++trial) {
    const Transform<double> X_AB = randomTransform(random);
    const Transform<double> X_BC = randomTransform(random);
    const Motion<double> V = randomMotion(random);
    const Force<double> F = randomForce(random);
    const LinkParameters I = test::randomIdentifiedLink(random);
    EXPECT_LE(distance((X_AB * X_BC) * V, X_AB * (X_BC * V)), kSpatialRounding);
    EXPECT_LE(distance((X_AB * X_BC) * F, X_AB * (X_BC * F)), kSpatialRounding);
    EXPECT_LE(distance((X_AB * X_BC) * I, X_AB * (X_BC * I)), 10 * kSpatialRounding);
  }
}

TEST(Transform, IsUndoneByItsInverse) {
  Random random(3);
  for (int trial = 0; trial < kTrials; ++trial) {
    const Transform<double> X = randomTransform(random);
    const Motion<double> V = randomMotion(random);
    EXPECT_LE(distance(X * X.inverse(), Transform<double>::identity()), kSpatialRounding);
    EXPECT_LE(distance(X.inverse() * X, Transform<double>::identity()), kSpatialRounding);
    EXPECT_LE(distance(X.inverseTimes(V), X.inverse() * V), kSpatialRounding);
    EXPECT_LE(distance(X.inverseTimes(X * V), V), kSpatialRounding);
  }
}

TEST(Power, IsTheSameInEveryFrame) {
  Random random(4);
  for (int trial = 0; trial < kTrials; ++trial) {
    const Transform<double> X_AB = randomTransform(random);
    const Motion<double> V_B = randomMotion(random);
    const Force<double> F_B = randomForce(random);
    EXPECT_NEAR(dot(X_AB * V_B, X_AB * F_B), dot(V_B, F_B), kSpatialRounding);
  }
}

// A force that turns with the body keeps its power on a motion that turns too: the rate of
// dot(M, F) is zero, dot(V x M, F) + dot(M, V x* F) = 0.
TEST(Cross, OfForceIsMinusTheTransposeOfThatOfMotion) {
  Random random(5);
  for (int trial = 0; trial < kTrials; ++trial) {
    const Motion<double> V = randomMotion(random);
    const Motion<double> M = randomMotion(random);
    const Force<double> F = randomForce(random);
    EXPECT_NEAR(dot(cross(V, M), F) + dot(M, cross(V, F)), 0, kSpatialRounding);
  }
}

// 2 kg at 3 m along y: m c^2 = 18 kg m^2 about x and z, nothing about y.
TEST(SpatialInertia, OfAPointIsAboutTheOrigin) {
  const LinkParameters I = LinkParameters::fromCenterOfMass(2, {0, 3, 0}, Eigen::Matrix3d::Zero());
  EXPECT_EQ(I.first_moment, Eigen::Vector3d(0, 6, 0));
  EXPECT_EQ(I.inertia, Eigen::Matrix3d(Eigen::Vector3d(18, 0, 18).asDiagonal()));
}

// 1 kg at (1, 1, 0): Ixy = -integral of x y dm = -1.
TEST(SpatialInertia, HasTheTensorsSignOffTheDiagonal) {
  const LinkParameters I = LinkParameters::fromCenterOfMass(1, {1, 1, 0}, Eigen::Matrix3d::Zero());
  EXPECT_EQ(I.inertia(0, 1), -1);
}

TEST(SpatialInertia, MovedIsThatOfTheMovedBody) {
  Random random(7);
  for (int trial = 0; trial < kTrials; ++trial) {
    const Transform<double> X = randomTransform(random);
    const Eigen::Vector3d center = random.vector3();
    const Eigen::Matrix3d R = random.rotation();
    const Eigen::Matrix3d about_center =
        R * Eigen::Vector3d(1, 2, 2.5).asDiagonal() * R.transpose();
    const LinkParameters moved = X * LinkParameters::fromCenterOfMass(1.5, center, about_center);
    const LinkParameters expected = LinkParameters::fromCenterOfMass(
        1.5, X.R * center + X.p, X.R * about_center * X.R.transpose());
    EXPECT_LE(distance(moved, expected), 10 * kSpatialRounding);
  }
}

TEST(SpatialInertia, IsTenNumbersInTheOrderOfFiles) {
  Vector10<double> p;
  p << 1, 2, 3, 4, 5, 6, 7, 8, 9, 10;  // m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz
  const LinkParameters I = LinkParameters::fromVector(p);
  EXPECT_EQ(I.mass, 1);
  EXPECT_EQ(I.first_moment, Eigen::Vector3d(2, 3, 4));
  EXPECT_EQ(I.inertia(0, 2), 7);
  EXPECT_EQ(I.inertia(2, 1), 9);
  EXPECT_EQ(I.toVector(), p);
}

TEST(Cast, KeepsEveryEntry) {
  Random random(10);
  const Motion<double> V = randomMotion(random).cast<float>().cast<double>();
  EXPECT_EQ(distance(V.cast<float>().cast<double>(), V), 0);
  const Force<double> F = randomForce(random).cast<float>().cast<double>();
  EXPECT_EQ(distance(F.cast<float>().cast<double>(), F), 0);
  const Transform<double> X = randomTransform(random).cast<float>().cast<double>();
  EXPECT_EQ(distance(X.cast<float>().cast<double>(), X), 0);
  const LinkParameters I = test::randomIdentifiedLink(random).cast<float>().cast<double>();
  EXPECT_EQ(distance(I.cast<float>().cast<double>(), I), 0);
}

}  // namespace
}  // namespace chain_dynamics

// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/tip_kinematics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <vector>

#include "chain_dynamics/dual.hpp"
#include "example_robots.hpp"
#include "lagrange.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

template <typename Scalar>
using Jacobian = Eigen::Matrix<Scalar, 6, Eigen::Dynamic>;

template <typename Scalar>
Jacobian<Scalar> jacobianOf(const Chain& chain, const VectorX<Scalar>& q) {
  Jacobian<Scalar> J(6, chain.jointCount());
  J.setConstant(std::numeric_limits<Scalar>::quiet_NaN());
  tipJacobian(chain, q, J);
  return J;
}

template <typename Scalar>
Jacobian<Scalar> jacobianDerivativeOf(const Chain& chain, const VectorX<Scalar>& q,
                                      const VectorX<Scalar>& qd) {
  Jacobian<Scalar> dJ(6, chain.jointCount());
  dJ.setConstant(std::numeric_limits<Scalar>::quiet_NaN());
  tipJacobianDerivative(chain, q, qd, dJ);
  return dJ;
}

// The same chain with a tip that lies and points anywhere.
Chain withTip(const Chain& chain) {
  Random random(5);
  const Transform<double> tip = {random.rotation(), 0.3 * random.vector3()};
  return Chain(chain.name(), chain.joints(), chain.links(), chain.gravity(), tip);
}

// How far a rounded length may be off: the arm has been added up from all placements.
double lengthOf(const Chain& chain, const State<double>& state) {
  double length = 1 + chain.tip().p.norm() + state.q.cwiseAbs().sum();
  for (const Joint& joint : chain.joints()) length += joint.placement.p.norm();
  return length;
}

// Velocity of the tip when the joints move with qd, as the derivative of its pose.
Eigen::Matrix<double, 6, 1> velocityOfTip(const Chain& chain, const VectorX<double>& q,
                                          const VectorX<double>& qd) {
  const Transform<Dual<double, 1>> X = tipPose(chain, moving<double>(q, qd));
  const Matrix3<double> R = X.R.unaryExpr([](const auto& x) { return x.value; });
  const Matrix3<double> dR = X.R.unaryExpr([](const auto& x) { return x.derivative[0]; });
  const Matrix3<double> w = dR * R.transpose();  // [w]x
  Eigen::Matrix<double, 6, 1> velocity;
  velocity << X.p.unaryExpr([](const auto& x) { return x.derivative[0]; }), w(2, 1), w(0, 2),
      w(1, 0);
  return velocity;
}

// Two rods in a plane: the tip at the end of the second, turned by q1 + q2 and by its own turn.
TEST(TipKinematics, OfADoublePendulumByHand) {
  const Chain like = doublePendulum(1, 0.6, 1, 0.4, 9.81);
  const Transform<double> tip = {Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).matrix(),
                                 {0.4, 0, 0}};
  const Chain chain("arm", like.joints(), like.links(), like.gravity(), tip);
  const Eigen::Vector2d q(0.5, -1.2);
  const Eigen::Vector2d qd(1.3, 0.7);
  const double w = 1.3 + 0.7;
  const double c1 = std::cos(0.5), s1 = std::sin(0.5);
  const double c12 = std::cos(-0.7), s12 = std::sin(-0.7);

  const Transform<double> X = tipPose(chain, q);
  EXPECT_TRUE(
      agree(X.p, Eigen::Vector3d(0.6 * c1 + 0.4 * c12, 0.6 * s1 + 0.4 * s12, 0), 1, kByHand));
  EXPECT_TRUE(agree(X.R, Eigen::AngleAxisd(-0.4, Eigen::Vector3d::UnitZ()).matrix(), 1, kByHand));

  Jacobian<double> J(6, 2), dJ(6, 2);
  J << -0.6 * s1 - 0.4 * s12, -0.4 * s12, 0.6 * c1 + 0.4 * c12, 0.4 * c12, 0, 0, 0, 0, 0, 0, 1, 1;
  dJ << -0.6 * c1 * 1.3 - 0.4 * c12 * w, -0.4 * c12 * w, -0.6 * s1 * 1.3 - 0.4 * s12 * w,
      -0.4 * s12 * w, 0, 0, 0, 0, 0, 0, 0, 0;
  EXPECT_TRUE(agree(jacobianOf<double>(chain, q), J, 1, kByHand));
  EXPECT_TRUE(agree(jacobianDerivativeOf<double>(chain, q, qd), dJ, 1, kByHand));
}

// Polar coordinates: the radius turns with the table.
TEST(TipKinematics, OfATurntableWithASlideByHand) {
  const Chain chain = turntable(3);
  const Eigen::Vector2d q(0.3, 0.4);
  const Eigen::Vector2d qd(2, -0.7);
  const double c = std::cos(0.3), s = std::sin(0.3);
  EXPECT_TRUE(agree(tipPose(chain, q).p, Eigen::Vector3d(0.4 * c, 0.4 * s, 0), 1, kByHand));

  Jacobian<double> J(6, 2), dJ(6, 2);
  J << -0.4 * s, c, 0.4 * c, s, 0, 0, 0, 0, 0, 0, 1, 0;
  dJ << 0.7 * s - 0.8 * c, -2 * s, -0.7 * c - 0.8 * s, 2 * c, 0, 0, 0, 0, 0, 0, 0, 0;
  EXPECT_TRUE(agree(jacobianOf<double>(chain, q), J, 1, kByHand));
  EXPECT_TRUE(agree(jacobianDerivativeOf<double>(chain, q, qd), dJ, 1, kByHand));
}

TEST(TipKinematics, JacobianIsTheDerivativeOfThePose) {
  forEachState([](const Chain& without, const State<double>& state) {
    const Chain chain = withTip(without);
    const Jacobian<double> J = jacobianOf(chain, state.q);
    const double scale = lengthOf(chain, state);
    for (Eigen::Index i = 0; i < chain.jointCount(); ++i) {
      const VectorX<double> alone = VectorX<double>::Unit(chain.jointCount(), i);
      EXPECT_TRUE(agree(J.col(i), velocityOfTip(chain, state.q, alone), scale, rounding(chain)));
    }
  });
}

// A robot that stands far away has the same Jacobian to the last bit.
TEST(TipKinematics, TheJacobianDoesNotDependOnTheFirstJointsPlace) {
  const Chain chain = withTip(randomChain(7));
  std::vector<Joint> joints = chain.joints();
  joints[0].placement.p = {1e14, -3e13, 7e12};
  const Chain away("away", joints, chain.links(), chain.gravity(), chain.tip());
  const State<double> state = randomState(chain, 3);
  EXPECT_EQ(jacobianOf(away, state.q), jacobianOf(chain, state.q));
  EXPECT_EQ(jacobianDerivativeOf(away, state.q, state.qd),
            jacobianDerivativeOf(chain, state.q, state.qd));
}

TEST(TipKinematics, TheJacobianGoesIntoABlockOfAMatrix) {
  const Chain chain = withTip(randomChain(4));
  const State<double> state = randomState(chain, 2);
  MatrixX<double> batch = MatrixX<double>::Zero(8, 12);
  tipJacobian(chain, state.q, batch.block(1, 4, 6, 4));
  EXPECT_EQ(batch.block(1, 4, 6, 4), jacobianOf(chain, state.q));
  EXPECT_EQ(batch.leftCols(4).norm() + batch.rightCols(4).norm(), 0);
}

}  // namespace
}  // namespace chain_dynamics

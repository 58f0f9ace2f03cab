// SPDX-License-Identifier: Apache-2.0

// FastModel::forwardDynamics().

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "chain_dynamics/dual.hpp"
#include "chain_dynamics/dynamic_components.hpp"
#include "chain_dynamics/energy.hpp"
#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/torques.hpp"
#include "example_robots.hpp"
#include "lagrange.hpp"
#include "random_chains.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

VectorX<double> accelerationsOf(const Chain& chain, const VectorX<double>& q,
                                const VectorX<double>& qd, const VectorX<double>& tau) {
  const FastModel fast(Model(chain), FastModel::instructionSets().back());
  VectorX<double> qdd(chain.jointCount());
  fast.forwardDynamics(q.data(), qd.data(), tau.data(), qdd.data());
  return qdd;
}

// Each state of a chain that isn't too long for FastModel.
template <class Check>
void forEachFastState(const Check& check) {
  forEachState([&](const Chain& chain, const State<double>& state) {
    if (chain.jointCount() <= FastModel::kMaxJoints) check(chain, state);
  });
}

VectorX<double> torquesThatCause(const Chain& chain, const State<double>& state) {
  VectorX<double> tau(chain.jointCount());
  torques(chain, state.q, state.qd, state.qdd, tau);
  return tau;
}

// Greatest by smallest eigenvalue of H: what rounding grows by when H is inverted.
double conditionOf(const Chain& chain, const VectorX<double>& q) {
  MatrixX<double> H(chain.jointCount(), chain.jointCount());
  inertiaMatrix(chain, q.cast<double>().eval(), H);
  const Eigen::SelfAdjointEigenSolver<MatrixX<double>> solver(H, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().tail(1)[0] / solver.eigenvalues()[0];
}

// (m l^2 + J) qdd = tau - m g l cos q
TEST(ForwardDynamics, OfAPendulumByHand) {
  const Chain chain = pendulum(2, 0.5, 9.81, 0.25);
  const VectorX<double> qdd =
      accelerationsOf(chain, VectorX<double>::Constant(1, 0.7), VectorX<double>::Constant(1, 3),
                      VectorX<double>::Constant(1, 4));
  EXPECT_NEAR(qdd[0], (4 - 2 * 9.81 * 0.5 * std::cos(0.7)) / 0.75, 10 * kByHand);
}

// A free particle in polar coordinates: m r^2 phi'' = -2 m r r' phi', r'' = r phi'^2. The table
// itself has no inertia, nor needs any as long as r isn't zero.
TEST(ForwardDynamics, OfATurntableWithoutTorquesIsAStraightLine) {
  const Eigen::Vector2d q(0.3, 0.4);
  const Eigen::Vector2d qd(2, -0.7);
  const VectorX<double> qdd = accelerationsOf(turntable(3), q, qd, VectorX<double>::Zero(2));
  EXPECT_TRUE(agree(qdd, Eigen::Vector2d(-2 * -0.7 * 2 / 0.4, 0.4 * 2 * 2), 10, kByHand));
}

// Without torque every body falls: a lift with the acceleration of gravity.
TEST(ForwardDynamics, OfALiftIsFreeFall) {
  Joint lift;
  lift.name = "lift";
  lift.type = JointType::kPrismatic;
  const Chain chain("lift", {lift}, {pointMass(2, {1, 2, 3})}, {0, 0, -9.81});
  const VectorX<double> zero = VectorX<double>::Zero(1);
  EXPECT_NEAR(accelerationsOf(chain, zero, zero, zero)[0], -9.810, kByHand);
}

// The accelerations carry the rounding of the torques, times the condition of H.
TEST(ForwardDynamics, InvertsInverseDynamics) {
  forEachFastState([](const Chain& chain, const State<double>& state) {
    const VectorX<double> qdd =
        accelerationsOf(chain, state.q, state.qd, torquesThatCause(chain, state));
    EXPECT_TRUE(agree(qdd, state.qdd, largest(state.qdd) * conditionOf(chain, state.q),
                      4 * rounding(chain)));
  });
}

// The torques of the accelerations found are those asked for: no condition of H in this way round.
TEST(ForwardDynamics, IsInvertedByInverseDynamics) {
  forEachFastState([](const Chain& chain, const State<double>& state) {
    const VectorX<double> tau = 10 * state.qdd;
    const State<double> moved{state.q, state.qd, accelerationsOf(chain, state.q, state.qd, tau)};
    const Eigen::Index n = chain.jointCount();
    MatrixX<double> H(n, n);
    VectorX<double> c(n);
    VectorX<double> g(n);
    dynamicComponents(chain, state.q, state.qd, H, c, g);
    const double terms = largest(H.cwiseAbs() * moved.qdd.cwiseAbs() + c.cwiseAbs() + g.cwiseAbs());
    EXPECT_TRUE(agree(torquesThatCause(chain, moved), tau, terms, 4 * rounding(chain)));
  });
}

TEST(ForwardDynamics, SolvesTheEquationOfMotion) {
  forEachFastState([](const Chain& chain, const State<double>& state) {
    const Eigen::Index n = chain.jointCount();
    MatrixX<double> H(n, n);
    VectorX<double> c(n);
    VectorX<double> g(n);
    dynamicComponents(chain, state.q, state.qd, H, c, g);
    const VectorX<double> tau = 10 * state.qdd;
    const VectorX<double> expected = H.llt().solve(tau - c - g);
    EXPECT_TRUE(agree(accelerationsOf(chain, state.q, state.qd, tau), expected,
                      largest(expected) * conditionOf(chain, state.q), 4 * rounding(chain)));
  });
}

// Without torques nothing adds energy: its rate along the motion found is zero.
TEST(ForwardDynamics, WithoutTorquesKeepsTheEnergy) {
  forEachFastState([](const Chain& chain, const State<double>& state) {
    const VectorX<double> qdd =
        accelerationsOf(chain, state.q, state.qd, VectorX<double>::Zero(chain.jointCount()));
    const auto q = moving<double>(state.q, state.qd);
    const auto qd = moving<double>(state.qd, qdd);
    const Dual<double, 1> kinetic = kineticEnergy(chain, q, qd);
    const Dual<double, 1> potential = potentialEnergy(chain, q);
    MatrixX<double> H(chain.jointCount(), chain.jointCount());
    inertiaMatrix(chain, state.q, H);
    const double terms = state.qd.cwiseAbs().dot(H.cwiseAbs() * qdd.cwiseAbs());
    EXPECT_NEAR(kinetic.derivative[0] + potential.derivative[0], 0, 4 * rounding(chain) * terms);
  });
}

// A joint that moves nothing: an error to detect by the caller, not one to hide.
TEST(ForwardDynamics, OfAJointWithoutInertiaIsNotFinite) {
  Joint joint;
  joint.name = "joint";
  const Chain chain("nothing", {joint}, {LinkParameters::zero()}, {0, 0, -9.81});
  const VectorX<double> zero = VectorX<double>::Zero(1);
  const VectorX<double> one = VectorX<double>::Ones(1);
  EXPECT_FALSE(std::isfinite(accelerationsOf(chain, zero, zero, zero)[0]));
  EXPECT_FALSE(std::isfinite(accelerationsOf(chain, zero, zero, one)[0]));
}

TEST(ForwardDynamics, MayOverwriteAnInput) {
  const Chain chain = randomChain(5);
  const State<double> state = randomState(chain, 3);
  VectorX<double> tau = state.qdd;
  const VectorX<double> expected = accelerationsOf(chain, state.q, state.qd, tau);
  const FastModel fast(Model(chain), FastModel::instructionSets().back());
  fast.forwardDynamics(state.q.data(), state.qd.data(), tau.data(), tau.data());
  EXPECT_EQ(tau, expected);
}

}  // namespace
}  // namespace chain_dynamics

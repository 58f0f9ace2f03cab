// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/computed_torque.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <memory>
#include <ur10_inverse_dynamics_solver/ur10_inverse_dynamics_solver.hpp>

#include "arms.hpp"

namespace inverse_dynamics_control::computed_torque_test {

constexpr double kPeriod = 1e-3;  // s

const JointState kState = stateOf(vec({1.0}), vec({0.5}));
const Reference kReference = referenceOf(vec({1.2}), vec({0.4}), vec({3.0}));

double torqueOf(const LawOptions& options, const Gains& gains = {vec({25.0}), vec({10.0})}) {
  ComputedTorque law(Pendulum::make(), gains, options);
  Eigen::VectorXd tau(1);
  EXPECT_EQ(law.update(kState, kReference, kPeriod, tau), Status::kOk);
  return tau[0];
}

TEST(ComputedTorque, PendulumByHand) {
  // 0.5 (3 + 25 * 0.2 + 10 * -0.1) + 9.81 cos 1
  EXPECT_NEAR(torqueOf(unlimited(1)), 3.5 + 9.81 * std::cos(1.0), kRounding);
}

TEST(ComputedTorque, TwoBarsGetEveryTerm) {
  const auto solver = ChainSolver::make(twoBars());
  LawOptions options = unlimited(2);
  options.friction.source = FrictionSource::kReferenceVelocity;
  options.friction.blend = 0.1;
  ComputedTorque law(solver, {vec({100.0, 400.0}), vec({20.0, 30.0})}, options);
  const JointState x = stateOf(vec({0.3, -1.0}), vec({0.7, 1.1}));
  const Reference r = referenceOf(vec({0.4, -1.1}), vec({0.5, 1.3}), vec({2.0, -3.0}));
  Eigen::VectorXd tau(2);
  EXPECT_EQ(law.update(x, r, kPeriod, tau), Status::kOk);

  const Eigen::VectorXd a = vec({2.0 + 100.0 * 0.1 - 20.0 * 0.2, -3.0 - 400.0 * 0.1 + 30.0 * 0.2});
  const Eigen::VectorXd expected = solver->getInertiaMatrix(x.q) * a +
                                   solver->getCoriolisVector(x.q, x.qd) +
                                   solver->getGravityVector(x.q) + 0.4 * r.qd;
  EXPECT_LT((tau - expected).norm(), 1e-11) << tau.transpose() << "\n" << expected.transpose();
}

TEST(ComputedTorque, WhatTheRobotCompensatesIsLeftOut) {
  const auto solver = ChainSolver::make(twoBars());
  const JointState x = stateOf(vec({0.3, -1.0}), vec({0.7, 1.1}));
  const Reference r = referenceOf(x.q, x.qd, vec({2.0, -3.0}));
  const auto torque = [&](const Compensated& compensated) {
    LawOptions options = unlimited(2);
    options.friction = {FrictionSource::kReferenceVelocity, 0.0, 0.1, 1.0};
    options.compensated = compensated;
    ComputedTorque law(solver, Gains::uniform(2, 10.0, 1.0), options);
    Eigen::VectorXd tau(2);
    EXPECT_EQ(law.update(x, r, kPeriod, tau), Status::kOk);
    return tau;
  };
  const Eigen::VectorXd all = torque({});
  const double rounding = 1e-12;
  EXPECT_LT((all - torque({true, false, false}) - solver->getGravityVector(x.q)).norm(), rounding);
  EXPECT_LT((all - torque({false, true, false}) - solver->getCoriolisVector(x.q, x.qd)).norm(),
            rounding);
  EXPECT_LT((all - torque({false, false, true}) - solver->getFrictionVector(r.qd)).norm(),
            rounding);
  EXPECT_LT((torque({true, true, true}) - solver->getInertiaMatrix(x.q) * r.qdd).norm(), rounding);
  const Eigen::Vector2d shares(0.25, 1.0);
  const Eigen::VectorXd g = solver->getGravityVector(x.q);
  EXPECT_LT((all - torque({shares, false, false}) - shares.cwiseProduct(g)).norm(), rounding);
  EXPECT_THROW(torque({1.5, false, false}),
               inverse_dynamics_solver::InvalidParameterValueException);
}

TEST(ComputedTorque, GainsOfAFrequencyAndADampingRatio) {
  const Gains gains = Gains::of(vec({20.0, 30.0}), vec({1.0, 0.5}));
  EXPECT_EQ(gains.Kp, vec({400.0, 900.0}));
  EXPECT_EQ(gains.Kd, vec({40.0, 30.0}));
  EXPECT_EQ(Gains::uniform(2, 3.0, 1.0).Kp, vec({9.0, 9.0}));
  EXPECT_EQ(thrownBy([] {
              Gains::of(vec({20.0, 30.0}), vec({1.0}));
            }),
            "Gains::of: damping_ratio: wrong size: expected 2 numbers, as many as natural "
            "frequencies, got 1; give both for each joint");
}

TEST(ComputedTorque, TheIdentifiedUr10IsRefused) {
  auto ur10 = std::make_shared<ur10_inverse_dynamics_solver::InverseDynamicsSolverUR10>();
  ur10->initialize();
  EXPECT_EQ(thrownBy([&] { ComputedTorque(ur10, Gains::uniform(6, 20.0, 1.0), unlimited(6)); }),
            "computed torque: solver: its inertia matrix isn't physical: expected a symmetric, "
            "positive definite H(q), as errors are fed back through it, got inertiaIsPhysical() "
            "is false; use the law FeedForward, or a solver made from the robot's URDF");
}

TEST(ComputedTorque, BadGainsAreRefused) {
  const auto solver = ChainSolver::make(twoBars());
  const auto text = [&](const Gains& gains) {
    return thrownBy([&] { ComputedTorque(solver, gains, unlimited(2)); });
  };
  EXPECT_EQ(text({vec({1.0}), vec({1.0, 1.0})}),
            "computed torque: Kp: wrong size: expected 2 numbers [1/s^2], got 1; "
            "give one for each of the joints shoulder, elbow");
  EXPECT_EQ(text({vec({1.0, 1.0}), vec({1.0, -2.0})}),
            "computed torque: Kd: joint elbow: wrong value: expected a finite number that isn't "
            "negative [1/s], got -2; correct this number");
  EXPECT_EQ(text({vec({kNan, 1.0}), vec({1.0, 1.0})}),
            "computed torque: Kp: joint shoulder: wrong value: expected a finite number that "
            "isn't negative [1/s^2], got nan; correct this number");
}

TEST(ComputedTorque, ASolverThatIsNotReadyIsRefused) {
  const Gains gains = Gains::uniform(1, 20.0, 1.0);
  EXPECT_EQ(thrownBy([&] { ComputedTorque(nullptr, gains, unlimited(1)); }),
            "computed torque: solver: missing: expected an initialized solver, got none; "
            "load one with SolverLoader");
  EXPECT_THROW(ComputedTorque(std::make_shared<Pendulum>(), gains, unlimited(1)),
               inverse_dynamics_solver::UninitializedException);
}

}  // namespace inverse_dynamics_control::computed_torque_test

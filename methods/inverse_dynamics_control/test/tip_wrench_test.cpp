// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/tip_wrench.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chain_dynamics/spatial.hpp>
#include <cmath>
#include <functional>
#include <inverse_dynamics_solver/configuration.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "arms.hpp"

namespace inverse_dynamics_control::tip_wrench_test {

using inverse_dynamics_solver::Kinematics;
using inverse_dynamics_solver::MatrixRef;

/// An arm of which only the Jacobian matters: it is what it is told to be.
class GivenJacobian : public InverseDynamicsSolver, public Kinematics {
 public:
  static std::shared_ptr<GivenJacobian> make(Eigen::MatrixXd J) {
    auto solver = std::make_shared<GivenJacobian>();
    solver->J = std::move(J);
    solver->initialize();
    return solver;
  }

  Eigen::MatrixXd J;
  bool throws = false;

 protected:
  JointInfo configure(const inverse_dynamics_solver::Configuration&) override {
    std::vector<std::string> names;
    for (Eigen::Index j = 0; j < J.cols(); ++j) names.push_back("joint" + std::to_string(j));
    return {names, {}};
  }
  void computeInertiaMatrix(const ConstVectorRef&, MatrixRef H) const override { H.setIdentity(); }
  void computeCoriolisVector(const ConstVectorRef&, const ConstVectorRef&,
                             VectorRef c) const override {
    c.setZero();
  }
  void computeGravityVector(const ConstVectorRef&, VectorRef g) const override { g.setZero(); }
  bool inertiaIsPhysicalImpl() const override { return true; }

  const InverseDynamicsSolver& torqueSolver() const override { return *this; }
  void computeTipPose(const ConstVectorRef&,
                      chain_dynamics::Transform<double>& pose) const override {
    pose.R << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // a quarter turn about z
    pose.p.setZero();
  }
  void computeTipJacobian(const ConstVectorRef&, MatrixRef result) const override {
    if (throws) throw std::runtime_error("a plugin's fault");
    result = J;
  }
  void computeTipJacobianDerivative(const ConstVectorRef&, const ConstVectorRef&,
                                    MatrixRef dJ) const override {
    dJ.setZero();
  }
};

WrenchOptions options(Eigen::Index joints, double noise) {
  WrenchOptions result;
  result.noise.setConstant(joints, noise);
  return result;
}

Eigen::VectorXd numbersOf(const TipWrench& tip) {
  Eigen::VectorXd w(6);
  w << tip.wrench().force, tip.wrench().torque;
  return w;
}

Eigen::MatrixXd random(Eigen::Index rows, Eigen::Index cols, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return normal(generator); });
}

TEST(TipWrench, OfSixJointsEachFeelingOneNumberByHand) {
  // ratios: 100 N / 2 N m and 10 N m / 2 N m
  TipWrench tip(GivenJacobian::make(Eigen::MatrixXd::Identity(6, 6)), options(6, 2.0));
  const Eigen::VectorXd tau = vec({20.0, -10.0, 5.0, 1.0, -2.0, 3.0});
  EXPECT_EQ(tip.update(Eigen::VectorXd::Zero(6), tau), WrenchStatus::kOk);
  EXPECT_LT((tip.signalToNoise() - vec({50, 50, 50, 5, 5, 5})).norm(), 1e-12);
  const double force = 2500.0 / 2501.0, torque = 25.0 / 26.0;
  EXPECT_LT((tip.wrench().force - force * tau.head<3>()).norm(), 1e-12);
  EXPECT_LT((tip.wrench().torque - torque * tau.tail<3>()).norm(), 1e-12);
  EXPECT_EQ(tip.unseen(), 0);
}

TEST(TipWrench, WithLittleNoiseTheWrenchIsFoundFromMoreJointsThanItHasNumbers) {
  const Eigen::MatrixXd J = random(6, 7, 1);
  const Eigen::VectorXd w = vec({20.0, -10.0, 5.0, 1.0, -2.0, 3.0});
  TipWrench tip(GivenJacobian::make(J), options(7, 1e-5));
  EXPECT_EQ(tip.update(Eigen::VectorXd::Zero(7), J.transpose() * w), WrenchStatus::kOk);
  EXPECT_LT((numbersOf(tip) - w).norm(), 1e-6);
}

TEST(TipWrench, IsTheDampedLeastSquaresSolution) {
  const Eigen::MatrixXd J = random(6, 7, 2);
  const Eigen::VectorXd tau = random(7, 1, 3), noise = random(7, 1, 4).cwiseAbs();
  WrenchOptions chosen;
  chosen.noise = noise;
  chosen.force = 30.0;
  chosen.torque = 0.5;
  TipWrench tip(GivenJacobian::make(J), chosen);
  EXPECT_EQ(tip.update(Eigen::VectorXd::Zero(7), tau), WrenchStatus::kOk);
  Eigen::VectorXd size(6);
  size << 30.0, 30.0, 30.0, 0.5, 0.5, 0.5;
  const Eigen::MatrixXd weights = noise.cwiseAbs2().cwiseInverse().asDiagonal();
  Eigen::MatrixXd normal = J * weights * J.transpose();
  normal.diagonal() += size.cwiseAbs2().cwiseInverse();
  const Eigen::VectorXd expected = normal.ldlt().solve(J * weights * tau);
  EXPECT_LT((numbersOf(tip) - expected).norm(), 1e-9 * expected.norm());
  // A V = U X, singular values decreasing: V is orthonormal, and so are the columns of U
  const Eigen::MatrixXd A = noise.cwiseInverse().asDiagonal() * J.transpose() * size.asDiagonal();
  const Eigen::MatrixXd V = size.cwiseInverse().asDiagonal() * tip.directions();
  const Eigen::VectorXd X = tip.signalToNoise();
  const Eigen::MatrixXd U = A * V * X.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(6, 6);
  EXPECT_LT((V.transpose() * V - identity).norm(), 1e-12);
  EXPECT_LT((U.transpose() * U - identity).norm(), 1e-9);
  EXPECT_TRUE(std::is_sorted(X.data(), X.data() + 6, std::greater<>()));
}

TEST(TipWrench, ADirectionThatTheArmCannotFeelIsTold) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Identity(6, 6);
  J.row(1) = J.row(0);  // forces along x and y turn the same joint
  J(1, 1) = 0.0;
  TipWrench tip(GivenJacobian::make(J), options(6, 0.5));
  const Eigen::VectorXd w = vec({20.0, 20.0, 5.0, 1.0, -2.0, 3.0});
  EXPECT_EQ(tip.update(Eigen::VectorXd::Zero(6), J.transpose() * w), WrenchStatus::kOk);
  EXPECT_EQ(tip.unseen(), 1);
  EXPECT_LT(tip.signalToNoise()[5], 1e-6);
  // x against y
  const Eigen::VectorXd unseen = tip.directions().col(5);
  EXPECT_NEAR(std::abs(unseen[0]), 100.0 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(unseen[0] + unseen[1], 0.0, 1e-6);
  EXPECT_LT(unseen.tail<4>().norm(), 1e-6);
  // what can be felt is right: here the force along (1, 1)
  EXPECT_NEAR(tip.wrench().force.x() + tip.wrench().force.y(), 40.0, 1e-2);
  EXPECT_NEAR(tip.wrench().force.z(), 5.0, 1e-2);
}

TEST(TipWrench, TwoJointsSeeTwoDirections) {
  TipWrench tip(GivenJacobian::make(random(6, 2, 5)), options(2, 0.1));
  EXPECT_EQ(tip.update(vec({0.0, 0.0}), vec({1.0, 2.0})), WrenchStatus::kOk);
  EXPECT_EQ(tip.unseen(), 4);
}

TEST(TipWrench, WhatCannotBeUsedGivesNoWrench) {
  const auto solver = GivenJacobian::make(Eigen::MatrixXd::Identity(6, 6));
  TipWrench tip(solver, options(6, 1.0));
  const Eigen::VectorXd good = Eigen::VectorXd::Ones(6);
  Eigen::VectorXd bad = good;
  bad[2] = kNan;
  const auto expect = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& tau,
                          WrenchStatus status) {
    tip.update(good, good);
    EXPECT_GT(numbersOf(tip).norm(), 1.0);
    EXPECT_EQ(tip.update(q, tau), status);
    EXPECT_EQ(numbersOf(tip).norm(), 0.0);
    EXPECT_EQ(tip.unseen(), 6);
  };
  expect(bad, good, WrenchStatus::kNotFinite);
  expect(good, bad, WrenchStatus::kNotFinite);
  expect(good, vec({1.0}), WrenchStatus::kWrongSize);
  expect(good, Eigen::VectorXd::Constant(6, 1e308), WrenchStatus::kNotFinite);
  solver->throws = true;
  EXPECT_EQ(tip.update(good, good), WrenchStatus::kSolverFailed);
  for (int status = 0; status <= static_cast<int>(WrenchStatus::kWrongSize); ++status) {
    EXPECT_STRNE(text(static_cast<WrenchStatus>(status)), "unknown status");
  }
}

TEST(TipWrench, BadOptionsAreRefused) {
  const auto solver = GivenJacobian::make(Eigen::MatrixXd::Identity(6, 6));
  const auto text = [&](const WrenchOptions& chosen) {
    return thrownBy([&] { TipWrench(solver, chosen); });
  };
  EXPECT_EQ(thrownBy([&] { TipWrench(Pendulum::make(), options(1, 1.0)); }),
            "tip wrench: solver: no Jacobian: expected a solver with the capability Kinematics, "
            "got none of it; use one of this project's solvers");
  EXPECT_EQ(thrownBy([&] { TipWrench(nullptr, options(6, 1.0)); }),
            "tip wrench: solver: missing: expected an initialized solver, got none; load one with "
            "SolverLoader");
  EXPECT_EQ(text(options(6, 0.0)),
            "tip wrench: noise: joint joint0: wrong value: expected a finite number above zero "
            "[N m], got 0; correct this number");
  WrenchOptions chosen = options(6, 1.0);
  chosen.force = kInfinity;
  EXPECT_EQ(text(chosen),
            "tip wrench: force: wrong value: expected a finite number above zero [N], got inf; "
            "correct this number");
  chosen = options(6, 1.0);
  chosen.torque = -1.0;
  EXPECT_EQ(text(chosen),
            "tip wrench: torque: wrong value: expected a finite number above zero [N m], got -1; "
            "correct this number");
  EXPECT_THROW(TipWrench(std::make_shared<GivenJacobian>(), options(6, 1.0)),
               inverse_dynamics_solver::UninitializedException);
}

TEST(ContactSensing, GivesTorquesWrenchAndContact) {
  const auto arm = GivenJacobian::make(Eigen::MatrixXd::Identity(6, 6));
  ContactOptions wanted;
  wanted.choice = Estimator::kMomentum;
  wanted.estimator.gain.setConstant(6, 50.0);
  wanted.thresholds.setConstant(6, 0.5);
  wanted.wrench = options(6, 1e-6);
  ContactSensing sensing(arm, wanted);
  const JointState state(6);
  const Eigen::VectorXd effort = vec({1, 2, 3, 0.1, 0.2, 0.3});
  const auto update = [&] { return sensing.update(state, effort, 1e-3); };
  for (int k = 0; k < 1000; ++k) update();
  ASSERT_EQ(update(), EstimateStatus::kOk);
  EXPECT_LT((sensing.torques() - effort).norm(), 1e-4);
  EXPECT_LT((sensing.wrench().force - Eigen::Vector3d(1, 2, 3)).norm(), 1e-4);
  EXPECT_LT((sensing.wrenchInTip().force - Eigen::Vector3d(2, -1, 3)).norm(), 1e-4);
  EXPECT_LT((sensing.wrenchInTip().torque - Eigen::Vector3d(0.2, -0.1, 0.3)).norm(), 1e-4);
  EXPECT_TRUE(sensing.detector()->contact());

  // Without an estimate: zeros, and the contact neither begins nor ends.
  arm->throws = true;
  EXPECT_EQ(update(), EstimateStatus::kSolverFailed);
  EXPECT_EQ(sensing.torques(), Eigen::VectorXd::Zero(6));
  EXPECT_EQ(sensing.wrenchInTip().force, Eigen::Vector3d::Zero());
  EXPECT_TRUE(sensing.detector()->contact());
  arm->throws = false;
  EXPECT_EQ(update(), EstimateStatus::kStarting);
  sensing.update(state, effort, -1.0);
  EXPECT_FALSE(sensing.detector()->contact());
}

TEST(ContactSensing, LeavesOutWhatIsNotAskedFor) {
  ContactOptions wanted;
  wanted.choice = Estimator::kMomentum;
  wanted.estimator.gain.setConstant(6, 50.0);
  const ContactSensing sensing(GivenJacobian::make(Eigen::MatrixXd::Identity(6, 6)), wanted);
  EXPECT_EQ(sensing.detector(), nullptr);
  EXPECT_EQ(sensing.tip(), nullptr);
}

}  // namespace inverse_dynamics_control::tip_wrench_test

// SPDX-License-Identifier: Apache-2.0
//
// Laws and estimators on arms whose joints preslide by laws that aren't quite those of the model.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "arms.hpp"

namespace inverse_dynamics_control::presliding_test {

constexpr double kPeriod = 1e-3;  // s
constexpr int kSteps = 20;        // of the plant in a period

/// Friction of a joint that preslides, N m.
struct Plant {
  virtual ~Plant() = default;
  /// After `period` [s] at velocity v.
  virtual double advance(double v, double period) = 0;
};

struct Dahl : Plant {
  double z = 0;
  double advance(double v, double period) override {
    z += ((v > 0 ? 1 : -1) - z) * -std::expm1(-std::abs(v) * period / 0.012);
    return 2.2 * v + 8.5 * z;
  }
};

/// Canudas de Wit et al. 1995.
struct LuGre : Plant {
  double z = 0;  // rad
  double advance(double v, double period) override {
    const double stiffness = 900, most = 8.4 + 1.8 * std::exp(-v * v / (0.05 * 0.05));
    const double before = z;
    z = (z + v * period) / (1 + stiffness * std::abs(v) * period / most);
    return stiffness * z + 2.0 * (z - before) / period + 2.0 * v;
  }
};

using Friction = std::vector<std::unique_ptr<Plant>>;

Friction dahl() {
  Friction of;
  for (int j = 0; j < 2; ++j) of.push_back(std::make_unique<Dahl>());
  return of;
}

Friction luGre() {
  Friction of;
  for (int j = 0; j < 2; ++j) of.push_back(std::make_unique<LuGre>());
  return of;
}

/// Two bars with hidden friction, driven by torques that are held for a period.
struct Arm {
  explicit Arm(Friction of, const Eigen::VectorXd& at)
      : friction(std::move(of)), state(stateOf(at, vec({0, 0}))) {}

  void advance(const Eigen::VectorXd& tau) {
    const double step = kPeriod / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      Eigen::VectorXd left =
          tau - bodies->getCoriolisVector(state.q, state.qd) - bodies->getGravityVector(state.q);
      for (Eigen::Index j = 0; j < 2; ++j) {
        left[j] -= friction[static_cast<std::size_t>(j)]->advance(state.qd[j], step);
      }
      state.qd += step * bodies->getInertiaMatrix(state.q).ldlt().solve(left);
      state.q += step * state.qd;
    }
  }

  std::shared_ptr<ChainSolver> bodies = ChainSolver::make(twoBars());
  Friction friction;
  JointState state;
};

/// Back and forth from 1 s to 13 s, then at rest.
Reference motionAt(double t) {
  const Eigen::VectorXd middle = vec({-0.6, 0.8}), amplitude = vec({0.25, -0.35});
  const double w = 2 * M_PI / 4, phase = w * (std::clamp(t, 1.0, 13.0) - 1.0);
  const bool moves = t > 1.0 && t < 13.0;
  return referenceOf(middle - amplitude * std::cos(phase),
                     amplitude * (moves ? w * std::sin(phase) : 0.0),
                     amplitude * (moves ? w * w * std::cos(phase) : 0.0));
}

struct Tracking {
  double at_reversals = 0;  // RMS of the error while the reference is slow, but not at rest [rad]
  double at_rest = 0;       // greatest error in the end [rad]
  double growth = 0;        // change of a torque over the last 2 s at rest [N m]
};

Tracking track(Friction friction, double stribeck, bool remembers) {
  LawOptions options = unlimited(2);
  options.friction.source = FrictionSource::kReferenceVelocity;
  ComputedTorque law(PreslidingArm::make(remembers, stribeck), Gains::uniform(2, 15.0, 1.0),
                     options);
  Arm arm(std::move(friction), motionAt(0).q);
  Tracking result;
  Eigen::VectorXd tau(2), before = tau;
  int slow = 0;
  for (int k = 0; k < 18000; ++k) {
    const double t = k * kPeriod;
    const Reference reference = motionAt(t);
    EXPECT_EQ(law.update(arm.state, reference, kPeriod, tau), Status::kOk);
    arm.advance(tau);
    const Eigen::VectorXd error = motionAt(t + kPeriod).q - arm.state.q;
    if (t > 2.0 && t < 13.0 && std::abs(reference.qd[0]) < 0.15) {
      result.at_reversals += error.squaredNorm();
      ++slow;
    }
    if (k == 16000) before = tau;
    if (t > 16.0) {
      result.at_rest = std::max(result.at_rest, error.cwiseAbs().maxCoeff());
      result.growth = std::max(result.growth, (tau - before).cwiseAbs().maxCoeff());
    }
  }
  result.at_reversals = std::sqrt(result.at_reversals / slow);
  return result;
}

TEST(Presliding, ComputedTorqueThatRemembersTracksReversalsBetterAndRestsNoWorse) {
  for (const auto& plant : {&dahl, &luGre}) {
    const double stribeck = plant == &dahl ? 0 : 1.6;
    const Tracking with = track(plant(), stribeck, true), without = track(plant(), stribeck, false);
    const char* const name = plant == &dahl ? "Dahl" : "LuGre";
    EXPECT_GT(without.at_reversals, 1.3 * with.at_reversals) << name;
    EXPECT_LE(with.at_rest, without.at_rest) << name;
    EXPECT_LT(with.growth, 0.01) << name;
  }
}

// Pushed for a second, and let go.
TEST(Presliding, AnArmGuidedByHandStandsStillWhenItIsLetGo) {
  LawOptions options = unlimited(2);
  options.friction = {FrictionSource::kMeasuredVelocity, 0.02, 0.05, 0.8};
  GravityCompensation law(PreslidingArm::make(true), options);
  for (const auto& plant : {&dahl, &luGre}) {
    law.start();
    Arm arm(plant(), vec({-0.6, 0.8}));
    Eigen::VectorXd tau(2), there = arm.state.q;
    for (int k = 0; k < 9000; ++k) {
      EXPECT_EQ(law.update(arm.state, kPeriod, tau), Status::kOk);
      arm.advance(k < 1000 ? tau + vec({12.0, -8.0}) : tau);
      if (k == 999) {
        EXPECT_GT((arm.state.q - there).cwiseAbs().minCoeff(), 0.05);
      }
      if (k == 6000) there = arm.state.q;
    }
    EXPECT_LT((arm.state.q - there).cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_LT((tau - arm.bodies->getGravityVector(arm.state.q)).cwiseAbs().maxCoeff(), 1e-3);
  }
}

TEST(Presliding, WhatAStandingReferenceRemembersActsUntilTheLawStartsAgain) {
  LawOptions options = unlimited(2);
  options.friction.source = FrictionSource::kReferenceVelocity;
  options.friction.scale = 0.5;
  options.compensated.friction = vec({0.0, 1.0});
  const auto solver = PreslidingArm::make(true);
  PdGravityCompensation law(solver, {vec({10, 10}), vec({1, 1})}, options);
  Eigen::VectorXd tau(2);
  for (const double q : {0.0, 1.0}) {  // a path of many distances
    const Reference rest = referenceOf(vec({q, q}), vec({0, 0}), vec({0, 0}));
    law.update(stateOf(rest.q, rest.qd), rest, kPeriod, tau);
    const Eigen::VectorXd added = tau - solver->getGravityVector(rest.q);
    EXPECT_NEAR(added[0], q == 0 ? 0.0 : 0.5 * PreslidingArm::kPresliding, kRounding);
    EXPECT_NEAR(added[1], 0.0, kRounding);
  }
  law.start();
  const Reference rest = referenceOf(vec({1, 1}), vec({0, 0}), vec({0, 0}));
  law.update(stateOf(rest.q, rest.qd), rest, kPeriod, tau);
  EXPECT_LT((tau - solver->getGravityVector(rest.q)).norm(), kRounding);
}

/// Of an estimate along the motion that computed torque gives an arm with Dahl's friction.
struct Residual {
  double rms = 0;        // N m
  bool contact = false;  // of more than 3 N m
};

template <class Estimator>
Residual residual(bool remembers) {
  LawOptions options = unlimited(2);
  options.friction.source = FrictionSource::kReferenceVelocity;
  const auto solver = PreslidingArm::make(remembers);
  ComputedTorque law(PreslidingArm::make(true), Gains::uniform(2, 15.0, 1.0), options);
  EstimatorOptions chosen;
  chosen.gain = vec({30, 30});
  Estimator estimator(solver, chosen);
  ContactDetector detector(vec({3, 3}), {}, solver->jointNames());
  Arm arm(dahl(), motionAt(0).q);
  Residual result;
  Eigen::VectorXd tau = vec({0, 0});
  int count = 0;
  for (int k = 0; k < 16000; ++k) {
    const double t = k * kPeriod;
    estimator.update(arm.state, tau, kPeriod);
    if (t > 2.0) {  // the state isn't known at the start
      result.contact = detector.update(estimator.torques(), kPeriod) || result.contact;
      result.rms += estimator.torques().squaredNorm();
      ++count;
    }
    EXPECT_EQ(law.update(arm.state, motionAt(t), kPeriod, tau), Status::kOk);
    arm.advance(tau);
  }
  result.rms = std::sqrt(result.rms / count);
  return result;
}

template <class Estimator>
void expectLessOfReversals() {
  const Residual with = residual<Estimator>(true), without = residual<Estimator>(false);
  EXPECT_LT(with.rms, 0.25 * without.rms);
  EXPECT_FALSE(with.contact);
  EXPECT_TRUE(without.contact);
}

TEST(Presliding, EstimatorsThatRememberTakeNoReversalForAContact) {
  expectLessOfReversals<MomentumObserver>();
  expectLessOfReversals<AccelerationResidual>();
}

}  // namespace inverse_dynamics_control::presliding_test

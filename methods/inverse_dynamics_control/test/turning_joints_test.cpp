// SPDX-License-Identifier: Apache-2.0
/// @file
/// Joints that turn on and on: however their driver and their planner report positions, laws,
/// guards and estimators give the numbers of unbounded ones.
#include <gtest/gtest.h>

#include <chain_dynamics/chain.hpp>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "arms.hpp"

namespace inverse_dynamics_control::turning_joints_test {

using chain_dynamics::JointType;

constexpr double kPi = 3.141592653589793;
constexpr double kPeriod = 1e-3;     // s
constexpr double kSpeed = 20.0;      // rad/s: a seam every 0.3 s
constexpr int kCycles = 700;         // two turns
constexpr double kTolerance = 1e-9;  // rounding of two turns, times gains and 1 / period

// How positions are reported: as they are, within (-pi, pi], or within [0, 2 pi).
using Report = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

Report within(double low) {
  return [low](const Eigen::VectorXd& q) -> Eigen::VectorXd {
    return q.unaryExpr([low](double x) { return x - 2 * kPi * std::floor((x - low) / (2 * kPi)); });
  };
}

const Report kUnbounded = [](const Eigen::VectorXd& q) { return q; };
const std::vector<Report> kReports = {kUnbounded, within(-kPi), within(0.0)};

// One joint turns forwards, the other backwards, neither steadily.
Reference motionAt(double t, double q0 = 0.3) {
  const double w = 3.0, a = 0.2;
  const Eigen::VectorXd turn = vec({kSpeed, -kSpeed});
  const Eigen::VectorXd wave = vec({a, 2 * a});
  return referenceOf(Eigen::VectorXd::Constant(2, q0) + turn * t + wave * std::sin(w * t),
                     turn + wave * w * std::cos(w * t), -wave * w * w * std::sin(w * t));
}

std::shared_ptr<ChainSolver> arm(JointType type = JointType::kContinuous) {
  return ChainSolver::make(twoBars(type));
}

Reference reported(Reference reference, const Report& report) {
  reference.q = report(reference.q);
  return reference;
}

using Update = std::function<Status(const JointState&, const Reference&, VectorRef)>;

// Torques of all cycles, one per column; the state follows the reference with an error.
Eigen::MatrixXd torques(const Update& update, const Report& of_state, const Report& of_reference) {
  Eigen::MatrixXd all(2, kCycles);
  Eigen::VectorXd tau(2);
  for (int k = 0; k < kCycles; ++k) {
    const Reference reference = motionAt(k * kPeriod);
    const JointState state = stateOf(of_state(reference.q - vec({0.02, -0.05})), reference.qd);
    EXPECT_EQ(update(state, reported(reference, of_reference), tau), Status::kOk);
    all.col(k) = tau;
  }
  return all;
}

void expectSameWhateverIsReported(const std::function<Update()>& make) {
  const Eigen::MatrixXd expected = torques(make(), kUnbounded, kUnbounded);
  for (const Report& of_state : kReports) {
    for (const Report& of_reference : kReports) {
      const Eigen::MatrixXd found = torques(make(), of_state, of_reference);
      EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), kTolerance);
    }
  }
}

template <class Law, class... Arguments>
std::function<Update()> makerOf(const Arguments&... arguments) {
  return [=]() -> Update {
    auto law = std::make_shared<Law>(arm(), arguments..., unlimited(2));
    return [law](const JointState& state, const Reference& reference, VectorRef tau) {
      return law->update(state, reference, kPeriod, tau);
    };
  };
}

TEST(TurningJoints, PdTakesTheShortWay) {
  expectSameWhateverIsReported(
      makerOf<PdGravityCompensation>(PdGains{vec({400.0, 100.0}), vec({20.0, 5.0})}));
}

TEST(TurningJoints, ComputedTorqueTakesTheShortWay) {
  expectSameWhateverIsReported(makerOf<ComputedTorque>(Gains::uniform(2, 20.0, 1.0)));
}

TEST(TurningJoints, FeedForwardNeedsNoWay) {
  for (const ModelState at : {ModelState::kReference, ModelState::kMeasured}) {
    expectSameWhateverIsReported([at]() -> Update {
      auto law = std::make_shared<FeedForward>(arm(), at, unlimited(2));
      return [law](const JointState& state, const Reference& reference, VectorRef tau) {
        return law->update(state, reference, Eigen::VectorXd::Zero(2), kPeriod, tau);
      };
    });
  }
}

TEST(TurningJoints, AGuardedLawStopsAsIfPositionsWereUnbounded) {
  expectSameWhateverIsReported([]() -> Update {
    auto law = std::make_shared<ComputedTorque>(arm(), Gains::uniform(2, 20.0, 1.0), unlimited(2));
    auto guard = std::make_shared<ReferenceGuard>(ReferenceLimits::none(2), vec({20.0, 30.0}),
                                                  arm()->jointNames(), arm()->jointTypes());
    auto cycle = std::make_shared<int>(0);
    guard->start(vec({0.0, 0.0}));
    return [=](const JointState& state, const Reference& desired, VectorRef tau) {
      Reference next = desired;
      if (++*cycle == 350) next.qd[0] = kNan;
      return law->update(state, guard->next(next, kPeriod), kPeriod, tau);
    };
  });
}

TEST(TurningJoints, LimitsOfAContinuousJointHoldForAnyTurn) {
  ReferenceLimits limits = ReferenceLimits::none(2);
  limits.lower.setConstant(-2.0), limits.upper.setConstant(2.0);
  ReferenceGuard guard(limits, vec({1.0, 1.0}), {"a", "b"},
                       {JointType::kContinuous, JointType::kRevolute});
  const Eigen::VectorXd zero = vec({0.0, 0.0});
  guard.start(zero);
  guard.next(referenceOf(vec({2 * kPi - 1.9, 1.9}), zero, zero), kPeriod);
  EXPECT_FALSE(guard.stopped());
  guard.next(referenceOf(vec({2 * kPi - 2.1, 0.0}), zero, zero), kPeriod);
  EXPECT_EQ(guard.joint(), 0);
  guard.start(zero);
  guard.next(referenceOf(vec({0.0, 2 * kPi - 1.9}), zero, zero), kPeriod);
  EXPECT_EQ(guard.joint(), 1);
}

TEST(TurningJoints, LimitsWiderThanATurnCountTurns) {
  ReferenceLimits limits = ReferenceLimits::none(2);
  limits.lower.setConstant(-10.0), limits.upper.setConstant(10.0);
  ReferenceGuard guard(limits, vec({1.0, 1.0}), {"a", "b"}, arm()->jointTypes());
  const Eigen::VectorXd zero = vec({0.0, 0.0});
  guard.start(zero);
  guard.next(referenceOf(vec({9.0, 0.0}), zero, zero), kPeriod);
  EXPECT_FALSE(guard.stopped());
  guard.next(referenceOf(vec({11.0, 0.0}), zero, zero), kPeriod);
  EXPECT_EQ(guard.joint(), 0);
}

TEST(TurningJoints, ARevoluteJointTakesTheLongWayThatItHasToTake) {
  PdGravityCompensation law(arm(JointType::kRevolute), {vec({100.0, 100.0}), vec({0.0, 0.0})},
                            unlimited(2));
  const Eigen::VectorXd zero = vec({0.0, 0.0});
  EXPECT_EQ(law.positionError(vec({3.0, -3.0}), vec({-3.0, 3.0})), vec({6.0, -6.0}));
}

// Estimates of all cycles, one per column, of efforts that hold an external torque.
template <class Estimator>
Eigen::MatrixXd estimates(VelocitySource velocity, const Report& report) {
  EstimatorOptions options;
  options.gain = vec({60.0, 60.0});
  options.velocity = velocity;
  const auto solver = arm();
  Estimator estimator(solver, options);
  Eigen::MatrixXd all(2, kCycles);
  for (int k = 0; k < kCycles; ++k) {
    const Reference m = motionAt(k * kPeriod), middle = motionAt((k - 0.5) * kPeriod);
    const Eigen::VectorXd effort = solver->getTorques(middle.q, middle.qd, middle.qdd) +
                                   vec({5.0, k > kCycles / 2 ? 3.0 : 0.0});
    estimator.update(stateOf(report(m.q), m.qd), effort, kPeriod);
    all.col(k) = estimator.torques();
  }
  EXPECT_LT((all.rightCols(1) - vec({5.0, 3.0})).norm(), 0.1);  // it works at all
  return all;
}

template <class Estimator>
void expectSameEstimates() {
  for (const VelocitySource velocity : {VelocitySource::kPositions, VelocitySource::kMeasured}) {
    const Eigen::MatrixXd expected = estimates<Estimator>(velocity, kUnbounded);
    for (const Report& report : kReports) {
      const Eigen::MatrixXd found = estimates<Estimator>(velocity, report);
      EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), kTolerance);
    }
  }
}

TEST(TurningJoints, TheMomentumObserverSeesNoSeam) { expectSameEstimates<MomentumObserver>(); }

TEST(TurningJoints, TheAccelerationResidualSeesNoSeam) {
  expectSameEstimates<AccelerationResidual>();
}

TEST(TurningJoints, TheTrackerGoesOnBeyondTheSeam) {
  for (const Report& report : kReports) {
    MotionTracker expected(2, 200.0), tracker(2, 200.0, arm()->jointTypes());
    expected.start(motionAt(0.0).q);
    tracker.start(motionAt(0.0).q);
    for (int k = 1; k < kCycles; ++k) {
      const Eigen::VectorXd q = motionAt(k * kPeriod).q;
      expected.update(q, kPeriod);
      tracker.update(report(q), kPeriod);
      ASSERT_LT((tracker.q() - expected.q()).norm(), kTolerance);
      ASSERT_LT((tracker.qd() - expected.qd()).norm(), kTolerance);
    }
  }
}

}  // namespace inverse_dynamics_control::turning_joints_test

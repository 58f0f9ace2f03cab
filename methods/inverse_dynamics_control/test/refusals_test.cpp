// SPDX-License-Identifier: Apache-2.0
//
// Whatever goes in, what comes out is finite and within the limits.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "arms.hpp"

namespace inverse_dynamics_control::refusals_test {

constexpr double kPeriod = 1e-3;  // s
constexpr double kLimit = 20.0;   // N m
constexpr double kDamping = 4.0;  // N m s/rad

LawOptions options() {
  LawOptions result = unlimited(1);
  result.limits.effort = vec({kLimit});
  result.damping = vec({kDamping});
  return result;
}

double gravityAt(double q) { return 9.81 * std::cos(q); }

/// All laws on one pendulum, called alike.
struct Laws {
  std::shared_ptr<Pendulum> solver = Pendulum::make();
  ComputedTorque computed_torque{solver, Gains::uniform(1, 5.0, 1.0), options()};
  GravityCompensation gravity_compensation{solver, options()};
  FeedForward feed_forward{solver, ModelState::kReference, options()};
  Eigen::VectorXd tau = vec({0.0});

  template <class Check>
  void update(const JointState& state, const Reference& reference, const Check& check,
              double period = kPeriod) {
    Status status = computed_torque.update(state, reference, period, tau);
    check(status, tau[0], "computed torque");
    status = gravity_compensation.update(state, reference.qd, period, tau);
    check(status, tau[0], "gravity compensation");
    status = feed_forward.update(state, reference, vec({0.0}), period, tau);
    check(status, tau[0], "feed-forward");
  }
};

const Reference kReference = referenceOf(vec({1.0}), vec({0.0}), vec({0.0}));

TEST(Refusals, LostReferenceGivesGravityAndDamping) {
  Laws laws;
  const double expected = gravityAt(1.0) - kDamping * 0.5;
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    laws.update(stateOf(vec({1.0}), vec({0.5})), referenceOf(vec({1.0}), vec({bad}), vec({0.0})),
                [&](Status status, double tau, const char* law) {
                  EXPECT_EQ(status, Status::kReferenceNotFinite) << law;
                  EXPECT_NEAR(tau, expected, kRounding) << law;
                });
  }
}

TEST(Refusals, EachPartOfAReferenceCounts) {
  Laws laws;
  Eigen::VectorXd tau(1);
  const JointState state = stateOf(vec({1.0}), vec({0.0}));
  for (int part = 0; part < 3; ++part) {
    Reference reference = kReference;
    (part == 0 ? reference.q : part == 1 ? reference.qd : reference.qdd)[0] = kNan;
    EXPECT_EQ(laws.computed_torque.update(state, reference, kPeriod, tau),
              Status::kReferenceNotFinite);
    EXPECT_EQ(laws.feed_forward.update(state, reference, vec({0.0}), kPeriod, tau),
              Status::kReferenceNotFinite);
  }
  EXPECT_EQ(laws.feed_forward.update(state, kReference, vec({kNan}), kPeriod, tau),
            Status::kReferenceNotFinite);
  EXPECT_NEAR(tau[0], gravityAt(1.0), kRounding);
}

TEST(Refusals, LostPositionGivesTheLastGravityAndDamping) {
  Laws laws;
  const auto ignore = [](Status, double, const char*) {};
  laws.update(stateOf(vec({0.7}), vec({0.0})), kReference, ignore);
  laws.update(stateOf(vec({kNan}), vec({0.5})), kReference,
              [](Status status, double tau, const char* law) {
                EXPECT_EQ(status, Status::kStateNotFinite) << law;
                EXPECT_NEAR(tau, gravityAt(0.7) - kDamping * 0.5, kRounding) << law;
              });
}

TEST(Refusals, LostVelocityGivesGravityOfThePosition) {
  Laws laws;
  laws.update(stateOf(vec({0.7}), vec({kInfinity})), kReference,
              [](Status status, double tau, const char* law) {
                EXPECT_EQ(status, Status::kStateNotFinite) << law;
                EXPECT_NEAR(tau, gravityAt(0.7), kRounding) << law;
              });
}

TEST(Refusals, WithoutAnyPositionThereIsNoGravity) {
  Laws laws;
  laws.update(stateOf(vec({kNan}), vec({kNan})), kReference,
              [](Status status, double tau, const char* law) {
                EXPECT_EQ(status, Status::kStateNotFinite) << law;
                EXPECT_EQ(tau, 0.0) << law;
              });
}

TEST(Refusals, FaultySolverGivesTheLastGravityAndDamping) {
  using Fault = Pendulum::Fault;
  for (const auto& [fault, expected] : {std::pair{Fault::kThrows, Status::kSolverFailed},
                                        std::pair{Fault::kGivesNan, Status::kTorqueNotFinite}}) {
    Laws laws;
    const auto ignore = [](Status, double, const char*) {};
    laws.update(stateOf(vec({0.7}), vec({0.0})), kReference, ignore);
    laws.solver->fault = fault;
    laws.update(stateOf(vec({0.9}), vec({0.5})), kReference,
                [expected = expected](Status status, double tau, const char* law) {
                  EXPECT_EQ(status, expected) << law;
                  EXPECT_NEAR(tau, gravityAt(0.7) - kDamping * 0.5, kRounding) << law;
                });
  }
}

TEST(Refusals, APeriodThatIsNoneIsReportedWithTheLawsTorque) {
  Laws laws;
  for (const double period : {0.0, -1.0, kNan, kInfinity, 1e9}) {
    laws.update(
        stateOf(vec({1.0}), vec({0.0})), kReference,
        [](Status status, double tau, const char* law) {
          EXPECT_EQ(status, Status::kNoPeriod) << law;
          EXPECT_NEAR(tau, gravityAt(1.0), kRounding) << law;
        },
        period);
  }
}

TEST(Refusals, OverflowIsNoTorque) {
  Laws laws;
  Eigen::VectorXd tau(1);
  const Reference far = referenceOf(vec({1e308}), vec({0.0}), vec({0.0}));
  EXPECT_EQ(laws.computed_torque.update(stateOf(vec({1.0}), vec({0.0})), far, kPeriod, tau),
            Status::kTorqueNotFinite);
  EXPECT_NEAR(tau[0], gravityAt(1.0), kRounding);
}

TEST(Refusals, SafeTorqueKeepsTheLimitsToo) {
  Laws laws;
  laws.update(stateOf(vec({1.0}), vec({-500.0})), referenceOf(vec({kNan}), vec({kNan}), vec({0})),
              [](Status status, double tau, const char* law) {
                EXPECT_EQ(status, Status::kReferenceNotFinite) << law;
                EXPECT_EQ(tau, kLimit) << law;
              });
  EXPECT_TRUE(laws.computed_torque.saturated()[0]);
}

TEST(Refusals, WrongSizesAreNotComputedWith) {
  Laws laws;
  laws.update(JointState(2), kReference, [](Status status, double tau, const char* law) {
    EXPECT_EQ(status, Status::kWrongSize) << law;
    EXPECT_EQ(tau, 0.0) << law;
  });
  Eigen::VectorXd tau = vec({7.0, 7.0});
  EXPECT_EQ(laws.computed_torque.update(JointState(1), kReference, kPeriod, tau),
            Status::kWrongSize);
  EXPECT_EQ(tau, vec({0.0, 0.0}));
  tau.resize(1);
  EXPECT_EQ(laws.computed_torque.update(JointState(1), Reference(3), kPeriod, tau),
            Status::kWrongSize);
  EXPECT_EQ(laws.feed_forward.update(JointState(1), kReference, vec({1, 2}), kPeriod, tau),
            Status::kWrongSize);
  JointState half(1);
  half.qd = vec({0.0, 0.0});
  EXPECT_EQ(laws.computed_torque.update(half, kReference, kPeriod, tau), Status::kWrongSize);
}

TEST(Refusals, HoldIsTheSafeTorqueOnDemand) {
  Laws laws;
  Eigen::VectorXd tau(1);
  ControlLaw& law = laws.computed_torque;
  EXPECT_EQ(law.hold(stateOf(vec({0.7}), vec({0.5})), kPeriod, tau), Status::kOk);
  EXPECT_NEAR(tau[0], gravityAt(0.7) - kDamping * 0.5, kRounding);
  EXPECT_EQ(law.hold(stateOf(vec({0.7}), vec({-50.0})), kPeriod, tau), Status::kSaturated);
  EXPECT_EQ(law.hold(stateOf(vec({kNan}), vec({0.0})), kPeriod, tau), Status::kStateNotFinite);
  EXPECT_NEAR(tau[0], gravityAt(0.7), kRounding);
  for (const Pendulum::Fault fault : {Pendulum::Fault::kThrows, Pendulum::Fault::kGivesNan}) {
    laws.solver->fault = fault;
    EXPECT_EQ(law.hold(stateOf(vec({0.2}), vec({0.0})), kPeriod, tau), Status::kSolverFailed);
    EXPECT_NEAR(tau[0], gravityAt(0.7), kRounding);
  }
}

TEST(Refusals, ALawTakesOverWithoutAPosition) {
  Laws laws;
  Eigen::VectorXd tau(1);
  ControlLaw& law = laws.gravity_compensation;
  EXPECT_EQ(laws.computed_torque.hold(stateOf(vec({0.2}), vec({0.5})), kPeriod, tau), Status::kOk);
  law.start(tau, laws.computed_torque.lastPosition());
  EXPECT_EQ(law.hold(stateOf(vec({kNan}), vec({0.5})), kPeriod, tau), Status::kStateNotFinite);
  EXPECT_NEAR(tau[0], gravityAt(0.2) - kDamping * 0.5, kRounding);
  EXPECT_EQ(law.hold(stateOf(vec({0.7}), vec({0.5})), kPeriod, tau), Status::kOk);
  EXPECT_NEAR(tau[0], gravityAt(0.7) - kDamping * 0.5, kRounding);
}

TEST(Refusals, AJointIsTakenWhereItWasLast) {
  const auto solver = ChainSolver::make(twoBars());
  GravityCompensation law(solver, unlimited(2));
  const Eigen::VectorXd rest = vec({0.0, 0.0});
  Eigen::VectorXd tau(2);
  EXPECT_EQ(law.hold(stateOf(vec({0.3, -1.0}), rest), kPeriod, tau), Status::kOk);
  EXPECT_EQ(law.hold(stateOf(vec({kNan, -0.2}), rest), kPeriod, tau), Status::kStateNotFinite);
  EXPECT_LT((tau - solver->getGravityVector(vec({0.3, -0.2}))).norm(), kRounding);
}

TEST(Refusals, ALostJointLeavesTheOthersDamped) {
  const auto solver = ChainSolver::make(twoBars());
  GravityCompensation law(solver, unlimited(2));
  const Eigen::VectorXd q = vec({0.3, -1.0});
  Eigen::VectorXd tau(2);
  EXPECT_EQ(law.hold(stateOf(q, vec({0.0, 0.0})), kPeriod, tau), Status::kOk);
  EXPECT_EQ(law.hold(stateOf(vec({kNan, -1.0}), vec({kNan, 0.5})), kPeriod, tau),
            Status::kStateNotFinite);
  EXPECT_LT((tau - (solver->getGravityVector(q) - vec({0.0, 4.0 * 0.5}))).norm(), kRounding);
}

TEST(Refusals, ALawGoesOnWhenItsInputsAreGoodAgain) {
  Laws laws;
  Eigen::VectorXd before(1), after(1);
  const JointState state = stateOf(vec({1.1}), vec({0.5}));
  EXPECT_EQ(laws.computed_torque.update(state, kReference, kPeriod, before), Status::kOk);
  laws.computed_torque.update(stateOf(vec({kNan}), vec({0.0})), kReference, kPeriod, after);
  EXPECT_EQ(laws.computed_torque.update(state, kReference, kPeriod, after), Status::kOk);
  EXPECT_EQ(before, after);
}

TEST(Refusals, MissingDampingIsRefused) {
  LawOptions missing = options();
  missing.damping = {};
  EXPECT_EQ(thrownBy([&] { GravityCompensation(Pendulum::make(), missing); }),
            "gravity compensation: damping: wrong size: expected 1 numbers [N m s/rad], got 0; "
            "give one for each of the joints pivot");
}

TEST(Refusals, DampingOfAllJointsNeedsAPhysicalInertia) {
  LawOptions rate = options();
  rate.damping = {};
  rate.damping_rate = 5.0;
  const auto solver = Pendulum::make();
  EXPECT_NO_THROW(GravityCompensation(solver, rate));
  solver->physical = false;
  EXPECT_EQ(
      thrownBy([&] { GravityCompensation(solver, rate); }),
      "gravity compensation: damping_rate: no damping: expected zero, as "
      "inertiaIsPhysical() is false, got 5; take a solver made from the robot's URDF, or give "
      "the damping of each joint");
  rate.damping_rate = -1.0;
  EXPECT_EQ(thrownBy([&] { GravityCompensation(solver, rate); }),
            "gravity compensation: damping_rate: wrong value: expected a finite number that isn't "
            "negative [1/s], got -1; correct this number");
}

TEST(Status, RefusalsAreTold) {
  EXPECT_FALSE(isRefusal(Status::kOk));
  EXPECT_FALSE(isRefusal(Status::kSaturated));
  EXPECT_FALSE(isRefusal(Status::kRateLimited));
  EXPECT_FALSE(isRefusal(Status::kNoPeriod));
  for (const Status status :
       {Status::kReferenceNotFinite, Status::kStateNotFinite, Status::kTorqueNotFinite,
        Status::kSolverFailed, Status::kWrongSize}) {
    EXPECT_TRUE(isRefusal(status));
    EXPECT_NE(std::string(text(status)).find("safe torque instead"), std::string::npos);
  }
  EXPECT_STREQ(text(Status::kSaturated), "a joint's torque was cut to its effort limit");
}

}  // namespace inverse_dynamics_control::refusals_test

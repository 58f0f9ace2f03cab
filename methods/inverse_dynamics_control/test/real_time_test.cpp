// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>
#include <inverse_dynamics_solver/conformance/allocation_guard.hpp>
#include <inverse_dynamics_solver/conformance/real_time_section.hpp>
#include <new>

#include "arms.hpp"

namespace inverse_dynamics_control {
namespace {

using inverse_dynamics_solver::conformance::AllocationGuard;
using inverse_dynamics_solver::conformance::inRealTime;
using inverse_dynamics_solver::conformance::kAllocationGuardWorks;
using inverse_dynamics_solver::conformance::kRealtimeSanitizerWatches;

constexpr double kPeriod = 1e-3;  // s

TEST(RealTime, NoCycleAllocatesLocksOrThrows) {
  if (!kAllocationGuardWorks && !kRealtimeSanitizerWatches) {
    GTEST_SKIP() << "allocations can't be counted in this build";
  }
  const auto solver = PreslidingArm::make(true);
  LawOptions options = unlimited(2);
  options.friction = {FrictionSource::kMeasuredVelocity, 0.1, 0.2, 0.5};
  options.limits.rate = vec({1.0, 1.0});
  ComputedTorque computed_torque(solver, Gains::uniform(2, 20.0, 1.0), options);
  GravityCompensation gravity_compensation(solver, options);
  PdGravityCompensation pd(solver, {vec({3.0, 2.0}), vec({0.3, 0.2})}, options);
  const PdGains other_pd_gains{vec({4.0, 2.0}), vec({0.4, 0.2})};
  const Gains other_gains = Gains::uniform(2, 30.0, 1.0);
  FeedForward feed_forward(solver, ModelState::kMeasured, options);
  SafeStop stop(vec({1.0, 1.0}), solver->jointNames());
  ReferenceGuard reference_guard(ReferenceLimits::none(2), vec({1.0, 1.0}), solver->jointNames());

  EstimatorOptions estimator_options;
  estimator_options.gain = vec({60.0, 60.0});
  MomentumObserver momentum(solver, estimator_options);
  AccelerationResidual acceleration(solver, estimator_options);
  ContactDetector detector(vec({1.0, 1.0}), {}, solver->jointNames());

  JointState good = stateOf(vec({0.3, -1.0}), vec({0.7, 1.1})), bad = good;
  bad.q[0] = kNan;
  Reference reference = referenceOf(good.q, good.qd, good.qd);
  Eigen::VectorXd tau(2), effort = vec({1.0, 2.0});

  // The counter counts.
  AllocationGuard proof;
  ::operator delete(::operator new(1));  // by its name: Clang leaves out an unused new-expression
  if (kAllocationGuardWorks) {
    ASSERT_GT(proof.count(), 0) << "the allocation guard doesn't see allocations";
  }

  const auto allocations = [](const std::function<void()>& call) {
    AllocationGuard guard;
    inRealTime(call);
    return guard.count();
  };
  for (const JointState* state : {&good, &bad}) {
    EXPECT_EQ(allocations([&] { computed_torque.update(*state, reference, kPeriod, tau); }), 0);
    EXPECT_EQ(allocations([&] { computed_torque.hold(*state, kPeriod, tau); }), 0);
    EXPECT_EQ(allocations([&] { computed_torque.start(effort); }), 0);
    EXPECT_EQ(allocations([&] { computed_torque.setGains(other_gains); }), 0);
    EXPECT_EQ(allocations([&] { pd.update(*state, reference, kPeriod, tau); }), 0);
    EXPECT_EQ(allocations([&] { pd.setGains(other_pd_gains); }), 0);
    EXPECT_EQ(allocations([&] { pd.setDamping(other_pd_gains.Kd, 5.0); }), 0);
    EXPECT_EQ(allocations([&] { pd.hold(*state, kPeriod, tau); }), 0);
    EXPECT_EQ(allocations([&] { gravity_compensation.update(*state, kPeriod, tau); }), 0);
    EXPECT_EQ(allocations([&] { gravity_compensation.update(*state, effort, kPeriod, tau); }), 0);
    EXPECT_EQ(allocations([&] { feed_forward.update(*state, reference, effort, kPeriod, tau); }),
              0);
    for (ExternalTorqueEstimator* estimator :
         {static_cast<ExternalTorqueEstimator*>(&momentum),
          static_cast<ExternalTorqueEstimator*>(&acceleration)}) {
      for (const double period : {kPeriod, 2 * kPeriod, 1.0}) {
        EXPECT_EQ(allocations([&] { estimator->update(*state, effort, period); }), 0);
      }
      EXPECT_EQ(allocations([&] { detector.update(estimator->torques(), kPeriod); }), 0);
    }
    EXPECT_EQ(allocations([&] { stop.begin(state->q, state->qd); }), 0);
    EXPECT_EQ(allocations([&] { stop.advance(kPeriod, reference); }), 0);
    EXPECT_EQ(allocations([&] { reference_guard.start(state->q); }), 0);
    EXPECT_EQ(allocations([&] { reference_guard.next(reference, kPeriod); }), 0);
  }
}

}  // namespace
}  // namespace inverse_dynamics_control

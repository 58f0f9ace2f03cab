// SPDX-License-Identifier: Apache-2.0

#include "live_torques.hpp"

#include <gtest/gtest.h>

#include <chain_dynamics/model.hpp>
#include <cstdint>
#include <inverse_dynamics_solver/conformance/allocation_guard.hpp>
#include <inverse_dynamics_solver/friction_memory.hpp>
#include <limits>
#include <memory>

#include "two_joint_solver.hpp"

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_evaluation::OnlineDerivative;
using inverse_dynamics_solver::conformance::AllocationGuard;
using Outcome = LiveTorques::Outcome;
using sensor_msgs::msg::JointState;

constexpr double kCutoff = 20.0;  // Hz: settled after 53 ms
constexpr std::int64_t kMillisecond = 1'000'000;
const double kNan = std::numeric_limits<double>::quiet_NaN();

// Velocities grow by 1 and 2 rad/s^2; efforts as they are for that, and 0.5 N m more.
JointState stateAt(std::int64_t stamp) {
  const double t = 1e-9 * static_cast<double>(stamp);
  JointState state;
  state.name = {"gripper", "b", "a"};
  state.position = {9, t * t, 0.5 * t * t};
  state.velocity = {9, 2 * t, t};
  state.effort = {9, 3 * 2 + 20 + 0.5, 2 * 1 + 10 + 0.5};
  return state;
}

LiveTorques make(const std::string& effort = "torque", const std::vector<double>& gains = {}) {
  const auto solver = TwoJointSolver::make();
  const auto meaning = inverse_dynamics_evaluation::statedEffort(effortsOfTwoJoints(effort, gains));
  return {solver, {{"a", "b"}, meaning, kCutoff, 0.5}};
}

/// The solver of the head with presliding friction of 1.5 N m in joint a; its limit without memory is
/// left out.
class Presliding : public TwoJointSolver, public inverse_dynamics_solver::FrictionMemory {
 protected:
  const inverse_dynamics_solver::InverseDynamicsSolver& torqueSolver() const override {
    return *this;
  }
  chain_dynamics::FrictionState frictionStateImpl() const override {
    const auto link =
        chain_dynamics::LinkParameters::fromCenterOfMass(1, {0, 0, 0}, Eigen::Matrix3d::Identity());
    chain_dynamics::Model model(
        chain_dynamics::Chain("two joints", {{"a"}, {"b"}}, {link, link}, {0, 0, 0}));
    chain_dynamics::SmoothCoulomb law;
    law.fm = 1.5;
    law.width = law.distance = 1e-3;
    model.friction = {law, chain_dynamics::ViscousCoulombOffset()};
    return chain_dynamics::FrictionState(model);
  }
};

// Runs until the filter has settled; the stamp after the last one.
std::int64_t settle(LiveTorques& live, std::int64_t begin = 0) {
  std::int64_t stamp = begin;
  for (int k = 0; k < 400; ++k, stamp += kMillisecond) {
    live.process(stateAt(stamp), stamp);
  }
  return stamp;
}

TEST(LiveTorques, AreThoseOfTheMotionAndTheResidualIsMeasuredMinusComputed) {
  LiveTorques live = make();
  const std::int64_t stamp = settle(live);
  ASSERT_EQ(live.process(stateAt(stamp), stamp), Outcome::kComputed);
  EXPECT_NEAR(live.computed()[0], 2 * 1 + 10, 1e-6);
  EXPECT_NEAR(live.computed()[1], 3 * 2 + 20, 1e-6);
  ASSERT_TRUE(live.hasResidual());
  EXPECT_NEAR(live.residual()[0], 0.5, 1e-6);
  EXPECT_NEAR(live.residual()[1], 0.5, 1e-6);
}

TEST(LiveTorques, AreNotThereBeforeTheFilterHasSettled) {
  LiveTorques live = make();
  EXPECT_EQ(live.process(stateAt(0), 0), Outcome::kSettling);
  EXPECT_EQ(live.process(stateAt(50 * kMillisecond), 50 * kMillisecond), Outcome::kSettling);
  EXPECT_EQ(live.process(stateAt(54 * kMillisecond), 54 * kMillisecond), Outcome::kComputed);
}

TEST(LiveTorques, RememberTheMotionUntilTheFilterRestarts) {
  const auto solver = std::make_shared<Presliding>();
  solver->initialize();
  const auto meaning = inverse_dynamics_evaluation::statedEffort(effortsOfTwoJoints("torque", {}));
  LiveTorques live(solver, {{"a", "b"}, meaning, kCutoff, 0.5}), without = make();
  JointState state;
  const auto remembered = [&](std::int64_t begin) {
    std::int64_t stamp = begin;
    for (int k = 0; k < 400; ++k, stamp += kMillisecond) {
      live.process(state, stamp);
      without.process(state, stamp);
    }
    return Eigen::VectorXd(live.computed() - without.computed());
  };
  const std::int64_t stamp = settle(live);
  state = stateAt(stamp);
  state.velocity = {0, 0, 0};
  EXPECT_LT((remembered(stamp) - Eigen::Vector2d(1.5, 0)).norm(), 1e-6);
  EXPECT_LT(remembered(100 * stamp).norm(), 1e-6);
}

TEST(LiveTorques, CompareCurrentsByDriveGainsAndEffortsWithoutGravityWithoutIt) {
  LiveTorques currents = make("current", {2, 4});
  std::int64_t stamp = settle(currents);
  JointState state = stateAt(stamp);
  state.effort = {9, 26.0 / 4, 12.0 / 2};
  ASSERT_EQ(currents.process(state, stamp), Outcome::kComputed);
  EXPECT_EQ(currents.measured(), Eigen::Vector2d(12, 26));
  EXPECT_NEAR(currents.residual().cwiseAbs().maxCoeff(), 0, 1e-6);

  LiveTorques without_gravity = make("torque_without_gravity");
  stamp = settle(without_gravity);
  state.effort = {9, 6, 2};
  ASSERT_EQ(without_gravity.process(state, stamp), Outcome::kComputed);
  EXPECT_NEAR(without_gravity.computed()[0], 2, 1e-6);
  EXPECT_NEAR(without_gravity.residual().cwiseAbs().maxCoeff(), 0, 1e-6);
}

TEST(LiveTorques, ComeWithoutAResidualWhereEffortsAreAbsentOrNotFinite) {
  LiveTorques live = make();
  const std::int64_t stamp = settle(live);
  JointState state = stateAt(stamp);
  state.effort.clear();
  EXPECT_EQ(live.process(state, stamp), Outcome::kComputed);
  EXPECT_FALSE(live.hasResidual());
  EXPECT_TRUE(live.measured().array().isNaN().all());
  state.effort = {9, kNan, 9};
  EXPECT_EQ(live.process(state, stamp + kMillisecond), Outcome::kComputed);
  EXPECT_FALSE(live.hasResidual());
}

TEST(LiveTorques, LeaveOutWhatCannotBeUsed) {
  LiveTorques live = make();
  const std::int64_t stamp = settle(live);
  JointState state = stateAt(stamp);
  state.name = {"x", "y", "z"};
  EXPECT_EQ(live.process(state, stamp), Outcome::kOtherJoints);
  state.name = {"x", "b", "z"};
  EXPECT_EQ(live.process(state, stamp), Outcome::kMissing);
  EXPECT_EQ(live.culprits(), (std::vector<std::string>{"a"}));
  state = stateAt(stamp);
  state.velocity.clear();
  EXPECT_EQ(live.process(state, stamp), Outcome::kNoVelocities);
  state = stateAt(stamp);
  state.velocity[1] = kNan;
  EXPECT_EQ(live.process(state, stamp), Outcome::kNotFinite);
  EXPECT_EQ(live.process(stateAt(stamp - kMillisecond), stamp - kMillisecond), Outcome::kRepeated);

  // and the filter hasn't taken any of it
  ASSERT_EQ(live.process(stateAt(stamp), stamp), Outcome::kComputed);
  EXPECT_NEAR(live.computed()[0], 12, 1e-6);
}

TEST(LiveTorques, StartAnewWhenTheClockJumpsBackOrAfterAGap) {
  LiveTorques live = make();
  settle(live, 1'000'000'000);
  EXPECT_EQ(live.process(stateAt(0), 0), Outcome::kSettling);
  EXPECT_EQ(live.step(), OnlineDerivative::Step::kWentBack);
  const std::int64_t stamp = settle(live, kMillisecond);
  EXPECT_EQ(live.process(stateAt(stamp + 600 * kMillisecond), stamp + 600 * kMillisecond),
            Outcome::kSettling);
  EXPECT_EQ(live.step(), OnlineDerivative::Step::kGap);
}

TEST(LiveTorques, AllocateNothing) {
  if (!inverse_dynamics_solver::conformance::kAllocationGuardWorks) {
    GTEST_SKIP() << "allocations can't be counted here";
  }
  for (const std::string effort : {"torque", "torque_without_gravity"}) {
    LiveTorques live = make(effort);
    const std::int64_t stamp = settle(live);
    const JointState state = stateAt(stamp);
    const AllocationGuard guard;
    ASSERT_EQ(live.process(state, stamp), Outcome::kComputed);
    EXPECT_EQ(guard.count(), 0) << effort;
  }
}

}  // namespace
}  // namespace inverse_dynamics_ros

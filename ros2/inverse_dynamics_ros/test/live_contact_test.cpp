// SPDX-License-Identifier: Apache-2.0

#include "live_contact.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <inverse_dynamics_control/momentum_observer.hpp>
#include <inverse_dynamics_solver/conformance/allocation_guard.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <limits>
#include <random>

#include "robot_parameters.hpp"
#include "two_joint_solver.hpp"

namespace inverse_dynamics_ros {
namespace {

using Eigen::VectorXd;
using inverse_dynamics_control::EstimatorOptions;
using inverse_dynamics_control::MomentumObserver;
using inverse_dynamics_solver::ExternalWrench;
using inverse_dynamics_solver::InverseDynamicsSolver;
using inverse_dynamics_solver::WrenchFrame;
using inverse_dynamics_solver::WrenchInRoot;
using inverse_dynamics_solver::WrenchInTip;
using inverse_dynamics_solver::conformance::AllocationGuard;
using Status = LiveContact::Status;

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kGain = 60.0;
const Eigen::Vector3d kForce(10, -20, 5), kTorque(0.5, 1, -0.3);

std::shared_ptr<InverseDynamicsSolver> ur10() {
  const NodeRobot robot(
      inverse_dynamics_solver::Parameters{{"robot", std::string("ur10_simulated")}});
  return robot.makeSolver(robot.description());
}

/// The UR10 in motion; its tip exerts a wrench, in the axes of its own frame, or none.
class Arm {
 public:
  explicit Arm(std::shared_ptr<const InverseDynamicsSolver> solver) : solver_(std::move(solver)) {}

  void moveTo(std::int64_t stamp) {
    const double t = 1e-9 * static_cast<double>(stamp);
    q.resize(6);
    qd.resize(6);
    VectorXd qdd(6);
    for (Eigen::Index j = 0; j < 6; ++j) {
      const double w = 1.0 + 0.2 * static_cast<double>(j);
      q[j] = 0.6 * std::sin(w * t) + 0.5 * static_cast<double>(j) - 1.0;
      qd[j] = 0.6 * w * std::cos(w * t);
      qdd[j] = -0.6 * w * w * std::sin(w * t);
    }
    effort = solver_->getTorques(q, qd, qdd);
    if (pushes) {
      effort += dynamic_cast<const ExternalWrench&>(*solver_).getExternalTorques(
          q, WrenchInTip{kForce, kTorque});
    }
  }

  VectorXd q, qd, effort;
  bool pushes = false;

 private:
  std::shared_ptr<const InverseDynamicsSolver> solver_;
};

LiveContactOptions optionsOf(const InverseDynamicsSolver& solver) {
  LiveContactOptions options;
  options.estimator.gain = VectorXd::Constant(solver.jointCount(), kGain);
  options.thresholds = VectorXd::Constant(solver.jointCount(), 2.0);
  options.wrench.noise = VectorXd::Constant(solver.jointCount(), 1e-4);
  return options;
}

class LiveContactTest : public testing::Test {
 protected:
  bool update(std::int64_t stamp) {
    arm.moveTo(stamp);
    return contact.update(stamp, arm.q, arm.qd, arm.effort);
  }
  // At 1 kHz; the stamp after the last one.
  std::int64_t run(std::int64_t begin, int count) {
    for (int k = 0; k < count; ++k) {
      update(begin + k * kMillisecond);
    }
    return begin + count * kMillisecond;
  }

  const std::shared_ptr<InverseDynamicsSolver> solver = ur10();
  LiveContact contact{solver, optionsOf(*solver)};
  Arm arm{solver};
};

TEST_F(LiveContactTest, JitterOfStampsIsNoTorque) {
  LiveContactOptions options = optionsOf(*solver);
  options.estimator.velocity = inverse_dynamics_control::VelocitySource::kMeasured;
  std::array<double, 2> noise{};
  for (const bool jitter : {false, true}) {
    LiveContact live(solver, options);
    std::mt19937 random(1);
    std::normal_distribution<double> late(0.0, 0.5e6), sensed(0.0, 0.3);  // ns, N m
    double sum = 0.0;
    for (std::int64_t k = 0; k < 2000; ++k) {
      const std::int64_t stamp = k * 10 * kMillisecond;  // 100 Hz
      arm.moveTo(stamp);
      arm.effort += VectorXd::NullaryExpr(6, [&] { return sensed(random); });
      live.update(stamp + (jitter ? std::llround(late(random)) : 0), arm.q, arm.qd, arm.effort);
      if (k > 100) sum += live.torques().squaredNorm();
    }
    noise[jitter ? 1 : 0] = std::sqrt(sum);
  }
  EXPECT_LT(noise[1], 1.1 * noise[0]);  // 1.14 with distances of stamps
}

TEST_F(LiveContactTest, TorquesAreThoseOfTheEstimatorOnTheSameSamples) {
  MomentumObserver observer(solver, optionsOf(*solver).estimator);
  inverse_dynamics_control::JointState state(6);
  std::int64_t stamp = 5'000'000'000, last = stamp;
  int estimates = 0;
  VectorXd effort;  // of the sample before
  for (int k = 0; k < 500; ++k) {
    arm.pushes = k > 250;
    const bool estimated = update(stamp);
    state.q = arm.q;
    const VectorXd mean = k == 0 ? arm.effort : VectorXd(0.5 * (effort + arm.effort));
    effort = arm.effort;
    const Status status = observer.update(state, mean, 1e-9 * static_cast<double>(stamp - last));
    EXPECT_EQ(contact.status(), status);
    EXPECT_EQ(estimated, status == Status::kOk);
    EXPECT_EQ(contact.torques(), observer.torques()) << k;
    estimates += estimated ? 1 : 0;
    last = stamp;
    stamp += k % 7 == 0 ? 3 * kMillisecond : kMillisecond;
  }
  EXPECT_GT(estimates, 400);
  EXPECT_EQ(contact.counts()[static_cast<std::size_t>(Status::kOk)], estimates);
}

TEST_F(LiveContactTest, TheWrenchIsTheOneThatTheTipFeels) {
  run(0, 200);
  EXPECT_FALSE(contact.detector()->contact());
  arm.pushes = true;
  run(200 * kMillisecond, 300);
  ASSERT_TRUE(contact.hasWrench());
  // what the damping leaves, and what the estimate of a changing torque lags
  EXPECT_LT((contact.force() + kForce).norm(), 0.05 * kForce.norm());
  EXPECT_LT((contact.torque() + kTorque).norm(), 0.05 * kTorque.norm() + 0.1);
  EXPECT_TRUE(contact.detector()->contact());

  LiveContactOptions options = optionsOf(*solver);
  options.wrench_frame = WrenchFrame::kRoot;
  LiveContact in_root(solver, options);
  for (int k = 0; k < 500; ++k) {
    arm.moveTo(k * kMillisecond);
    in_root.update(k * kMillisecond, arm.q, arm.qd, arm.effort);
  }
  const auto pose =
      dynamic_cast<const inverse_dynamics_solver::Kinematics&>(*solver).getTipPose(arm.q);
  const Eigen::Vector3d force = -(pose.R * kForce);
  const Eigen::Vector3d torque = -(pose.R * kTorque) + pose.p.cross(force);
  EXPECT_LT((in_root.force() - force).norm(), 0.05 * force.norm());
  EXPECT_LT((in_root.torque() - torque).norm(), 0.05 * torque.norm() + 0.1);
  EXPECT_GT((in_root.force() + kForce).norm(), 0.2 * kForce.norm()) << "the frames are alike here";
}

// Nothing is known for a while, then the estimate grows from zero: never a jump.
class LiveContactReset : public LiveContactTest {
 protected:
  // The samples after an interruption, to the first estimate.
  void expectASoftStart(std::int64_t stamp) {
    int samples = 0;
    while (!update(stamp) && samples < 200) {
      EXPECT_EQ(contact.torques().norm(), 0.0);
      stamp += kMillisecond;
      ++samples;
    }
    EXPECT_GT(samples, 40);
    EXPECT_LT(samples, 60);
    const double step = 1.0 - std::exp(-kGain * 1e-3);
    const VectorXd external = dynamic_cast<const ExternalWrench&>(*solver).getExternalTorques(
        arm.q, WrenchInTip{kForce, kTorque});
    EXPECT_LT(contact.torques().norm(), 1.5 * step * external.norm());
  }
  void expectCount(Status status, std::int64_t count) {
    EXPECT_EQ(contact.counts()[static_cast<std::size_t>(status)], count) << text(status);
  }
};

TEST_F(LiveContactReset, EffortsThatAreNotFiniteAreOne) {
  arm.pushes = true;
  const std::int64_t stamp = run(0, 300);
  ASSERT_TRUE(contact.detector()->contact());
  arm.moveTo(stamp);
  arm.effort[2] = kNan;
  EXPECT_FALSE(contact.update(stamp, arm.q, arm.qd, arm.effort));
  EXPECT_EQ(contact.status(), Status::kEffortNotFinite);
  EXPECT_FALSE(contact.hasWrench());
  expectCount(Status::kEffortNotFinite, 1);
  EXPECT_TRUE(contact.detector()->contact()) << "nothing is known of its end";
  expectASoftStart(stamp + kMillisecond);
  run(stamp + 100 * kMillisecond, 50);
  EXPECT_TRUE(contact.detector()->contact());
}

TEST_F(LiveContactReset, PositionsThatAreNotFiniteAreOne) {
  const std::int64_t stamp = run(0, 300);
  arm.moveTo(stamp);
  arm.q[0] = kNan;
  EXPECT_FALSE(contact.update(stamp, arm.q, arm.qd, arm.effort));
  EXPECT_EQ(contact.status(), Status::kStateNotFinite);
  expectASoftStart(stamp + kMillisecond);
}

TEST_F(LiveContactReset, AGapIsOne) {
  arm.pushes = true;
  const std::int64_t stamp = run(0, 300) + 21 * kMillisecond;
  EXPECT_FALSE(update(stamp));
  EXPECT_EQ(contact.status(), Status::kGap);
  EXPECT_TRUE(contact.detector()->contact());
  expectASoftStart(stamp + kMillisecond);
}

TEST_F(LiveContactReset, AClockThatGoesBackIsOneAndEndsAContact) {
  arm.pushes = true;
  run(1'000'000'000, 300);
  ASSERT_TRUE(contact.detector()->contact());
  EXPECT_FALSE(update(0));
  EXPECT_EQ(contact.status(), Status::kGap);
  EXPECT_FALSE(contact.detector()->contact());
  expectASoftStart(kMillisecond);
}

TEST_F(LiveContactReset, ARepeatedStampIsLeftOut) {
  arm.pushes = true;
  const std::int64_t stamp = run(0, 300);
  const VectorXd before = contact.torques();
  const LiveContact::Counts counts = contact.counts();
  EXPECT_FALSE(contact.update(stamp - kMillisecond, arm.q, arm.qd, VectorXd(10 * arm.effort)));
  EXPECT_EQ(contact.torques(), before);
  EXPECT_EQ(contact.counts(), counts);
  EXPECT_TRUE(update(stamp));
  EXPECT_LT((contact.torques() - before).norm(), 1.0);
}

TEST(LiveContact, SolversWithoutKinematicsHaveNoWrench) {
  const auto solver = TwoJointSolver::make();
  LiveContactOptions options = optionsOf(*solver);
  EXPECT_THROW(LiveContact(solver, options),
               inverse_dynamics_solver::InvalidParameterValueException);
  options.wrench.noise.resize(0);
  options.thresholds.resize(0);
  LiveContact contact(solver, options);
  EXPECT_EQ(contact.tip(), nullptr);
  EXPECT_EQ(contact.detector(), nullptr);
  const VectorXd zero = VectorXd::Zero(2);
  VectorXd effort(2);
  effort << 10 + 1, 20 - 2;
  for (int k = 0; k < 1000; ++k) {
    contact.update(k * kMillisecond, zero, zero, effort);
  }
  EXPECT_NEAR(contact.torques()[0], 1, 1e-9);
  EXPECT_NEAR(contact.torques()[1], -2, 1e-9);
}

TEST_F(LiveContactTest, AllocatesNothing) {
  if (!inverse_dynamics_solver::conformance::kAllocationGuardWorks) {
    GTEST_SKIP() << "allocations can't be counted here";
  }
  const std::int64_t stamp = run(0, 300);
  arm.moveTo(stamp);
  const AllocationGuard guard;
  const bool estimated = contact.update(stamp, arm.q, arm.qd, arm.effort);
  EXPECT_EQ(guard.count(), 0);
  EXPECT_TRUE(estimated && contact.hasWrench());
}

}  // namespace
}  // namespace inverse_dynamics_ros

// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <inverse_dynamics_solver/conformance/allocation_guard.hpp>
#include <inverse_dynamics_solver/conformance/real_time_section.hpp>
#include <new>

#include "inverse_dynamics_controllers/external_wrench_broadcaster.hpp"
#include "inverse_dynamics_controllers/feed_forward_controller.hpp"
#include "inverse_dynamics_controllers/gravity_compensation_controller.hpp"
#include "inverse_dynamics_controllers/inverse_dynamics_controller.hpp"
#include "inverse_dynamics_controllers/pd_gravity_compensation_controller.hpp"
#include "inverse_dynamics_controllers/testing/controller_fixture.hpp"

namespace inverse_dynamics_controllers {
namespace {

using inverse_dynamics_solver::conformance::AllocationGuard;
using inverse_dynamics_solver::conformance::inRealTime;
using inverse_dynamics_solver::conformance::kAllocationGuardWorks;
using inverse_dynamics_solver::conformance::kRealtimeSanitizerWatches;

void proveTheGuard() {
  if (kRealtimeSanitizerWatches) return;
  if (!kAllocationGuardWorks) GTEST_SKIP() << "allocations can't be counted in this build";
  AllocationGuard proof;
  ::operator delete(::operator new(1));  // by its name: Clang leaves out an unused new-expression
  ASSERT_GT(proof.count(), 0) << "the allocation guard doesn't see allocations";
}

// Allocations of cycles in all that may happen: following, stepping, stopping, failing.
template <class Fixture, class SetReference>
long allocationsOf(Fixture& fixture, FakeHardware& hardware, const SetReference& setReference) {
  AllocationGuard guard;
  const auto cycles = [&fixture] {
    inRealTime([&fixture] {
      for (int k = 0; k < 30; ++k) fixture.update();
    });
  };
  cycles();
  setReference(1e-3);
  cycles();
  setReference(2.0);
  cycles();
  setReference(kNan);
  cycles();
  hardware.q[0] = kNan;
  cycles();
  return guard.count();
}

class InverseDynamicsCycle : public ChainedFixture<InverseDynamicsController> {
 public:
  using ControllerFixture::update;
};

TEST_F(InverseDynamicsCycle, AllocatesLocksAndThrowsNothing) {
  proveTheGuard();
  if (IsSkipped() || HasFatalFailure()) return;
  Parameters parameters = good();
  parameters["gains.natural_frequency"] = rclcpp::ParameterValue(std::vector<double>{50.0});
  parameters["limits.effort_rate"] = rclcpp::ParameterValue(std::vector<double>{1e4});
  ASSERT_TRUE(start(parameters)) << log.text();
  EXPECT_EQ(allocationsOf(*this, hardware,
                          [this](double q) {
                            for (std::size_t j = 0; j < 6; ++j) {
                              for (std::size_t k = 0; k < 3; ++k) setReference(j, k, k ? 0 : q);
                            }
                          }),
            0);
}

class FeedForwardCycle : public ChainedFixture<FeedForwardController> {
 public:
  using ControllerFixture::update;
};

TEST_F(FeedForwardCycle, AllocatesLocksAndThrowsNothing) {
  proveTheGuard();
  if (IsSkipped() || HasFatalFailure()) return;
  Parameters parameters = good();
  parameters["reference_interfaces"] = rclcpp::ParameterValue(
      std::vector<std::string>{"position", "velocity", "acceleration", "effort"});
  parameters["gains.p"] = rclcpp::ParameterValue(std::vector<double>{1000.0});
  parameters["gains.d"] = rclcpp::ParameterValue(std::vector<double>{10.0});
  parameters["reference_steps"] = rclcpp::ParameterValue("ramp");
  ASSERT_TRUE(start(parameters)) << log.text();
  EXPECT_EQ(allocationsOf(*this, hardware,
                          [this](double q) {
                            for (std::size_t j = 0; j < 6; ++j) {
                              for (std::size_t k = 0; k < 4; ++k) setReference(j, k, k ? 0 : q);
                            }
                          }),
            0);
}

class PdGravityCompensationCycle : public ChainedFixture<PdGravityCompensationController> {
 public:
  using ControllerFixture::update;
};

TEST_F(PdGravityCompensationCycle, AllocatesLocksAndThrowsNothing) {
  proveTheGuard();
  if (IsSkipped() || HasFatalFailure()) return;
  Parameters parameters = good();
  parameters["gains.p"] = rclcpp::ParameterValue(std::vector<double>{1000.0});
  parameters["gains.d"] = rclcpp::ParameterValue(std::vector<double>{10.0});
  ASSERT_TRUE(start(parameters)) << log.text();
  // New gains, already handed over by the node's thread, are taken in the first cycle.
  EXPECT_EQ(set("gains.p", rclcpp::ParameterValue(std::vector<double>{500.0})), "");
  spinUntil([] { return false; }, std::chrono::milliseconds(200));
  EXPECT_EQ(allocationsOf(*this, hardware,
                          [this](double q) {
                            for (std::size_t j = 0; j < 6; ++j) {
                              for (std::size_t k = 0; k < 2; ++k) setReference(j, k, k ? 0 : q);
                            }
                          }),
            0);
}

class GravityCompensationCycle : public ControllerFixture<GravityCompensationController> {
 public:
  using ControllerFixture::update;
};

TEST_F(GravityCompensationCycle, AllocatesLocksAndThrowsNothing) {
  proveTheGuard();
  if (IsSkipped() || HasFatalFailure()) return;
  ASSERT_TRUE(configure(good()) && activate()) << log.text();
  EXPECT_EQ(allocationsOf(*this, hardware, [](double) {}), 0);
}

class ExternalWrenchCycle : public ControllerFixture<ExternalWrenchBroadcaster> {
 public:
  using ControllerFixture::update;
};

TEST_F(ExternalWrenchCycle, AllocatesLocksAndThrowsNothing) {
  proveTheGuard();
  if (IsSkipped() || HasFatalFailure()) return;
  Parameters parameters = good();
  parameters.erase("damping.values");
  parameters["noise"] = rclcpp::ParameterValue(std::vector<double>{0.3});
  parameters["contact.thresholds"] = rclcpp::ParameterValue(std::vector<double>{1.0});
  ASSERT_TRUE(configure(parameters) && activate()) << log.text();
  EXPECT_EQ(
      allocationsOf(*this, hardware, [this](double effort) { hardware.measured_tau[0] = effort; }),
      0);
}

}  // namespace
}  // namespace inverse_dynamics_controllers

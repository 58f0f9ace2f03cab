// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/fault_latch.hpp"

#include <gtest/gtest.h>

namespace inverse_dynamics_control::fault_latch_test {

TEST(FaultLatch, ShortFaultsAreTolerated) {
  FaultLatch fault(0.05);
  for (int k = 0; k < 4; ++k) fault.note(Status::kStateNotFinite, 0.01);
  fault.note(Status::kSaturated, 0.01);  // a torque of the law: counting restarts
  for (int k = 0; k < 4; ++k) fault.note(Status::kStateNotFinite, 0.01);
  EXPECT_FALSE(fault.latched());
}

TEST(FaultLatch, FaultsThatLastAreKeptUntilReset) {
  FaultLatch fault(0.05);
  for (int k = 0; k < 6; ++k) fault.note(Status::kStateNotFinite, 0.01);
  fault.note(Status::kOk, 0.01);
  EXPECT_TRUE(fault.latched());
  EXPECT_EQ(fault.why(), Status::kStateNotFinite);
  fault.reset();
  EXPECT_FALSE(fault.latched());
}

TEST(FaultLatch, AClockThatJumpsBackTakesNoTimeAway) {
  FaultLatch fault(0.05);
  fault.note(Status::kSolverFailed, 0.04);
  fault.note(Status::kSolverFailed, -1.0);
  EXPECT_FALSE(fault.latched());
  fault.note(Status::kSolverFailed, 0.02);
  EXPECT_TRUE(fault.latched());
}

TEST(FaultLatch, WithoutToleranceTheFirstRefusalLatches) {
  FaultLatch fault(0.0);
  fault.note(Status::kReferenceNotFinite, 0.001);
  EXPECT_TRUE(fault.latched());
}

}  // namespace inverse_dynamics_control::fault_latch_test

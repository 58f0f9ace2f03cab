// SPDX-License-Identifier: Apache-2.0
#include "wrench_report.hpp"

#include <gtest/gtest.h>

namespace inverse_dynamics_controllers {
namespace {

using inverse_dynamics_control::EstimateStatus;
using Texts = std::vector<std::string>;

Texts texts(WrenchReport& report) {
  Texts all;
  for (const ReportLine& line : report.takeLines()) {
    all.push_back((line.is_error ? "ERROR: " : "WARN: ") + line.text);
  }
  return all;
}

TEST(WrenchReport, EstimatesAndBeginningsAreNotWorthALine) {
  WrenchReport report(6);
  report.note(EstimateStatus::kStarting, 6);
  report.note(EstimateStatus::kOk, 0);
  EXPECT_EQ(texts(report), Texts{});
}

TEST(WrenchReport, FaultsAreCountedOnce) {
  WrenchReport report(6);
  report.note(EstimateStatus::kEffortNotFinite, 0);
  report.note(EstimateStatus::kEffortNotFinite, 0);
  EXPECT_EQ(texts(report),
            Texts{"ERROR: a measured effort isn't finite: begins again: no wrench in 2 cycles"});
  EXPECT_EQ(texts(report), Texts{});
}

TEST(WrenchReport, DirectionsThatAreNotFeltAreThoseThatSixJointsWouldFeel) {
  WrenchReport six(6), four(4);
  six.note(EstimateStatus::kOk, 2);
  six.note(EstimateStatus::kOk, 1);
  four.note(EstimateStatus::kOk, 2);
  EXPECT_EQ(texts(six),
            Texts{"WARN: the joints don't feel 2 of 6 directions of a wrench, near a singularity, "
                  "in 2 cycles: taken for zero"});
  EXPECT_EQ(texts(four), Texts{});
}

TEST(WrenchReport, GivingUpIsSaidFirst) {
  WrenchReport report(6);
  report.note(EstimateStatus::kSolverFailed, 0);
  report.noteGivenUp(EstimateStatus::kSolverFailed);
  const Texts lines = texts(report);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(
      lines[0],
      "ERROR: the solver failed: begins again, for longer than tolerated_fault_time: no wrench "
      "until the controller is activated again");
}

}  // namespace
}  // namespace inverse_dynamics_controllers

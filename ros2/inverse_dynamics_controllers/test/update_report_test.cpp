// SPDX-License-Identifier: Apache-2.0
#include "update_report.hpp"

#include <gtest/gtest.h>

namespace inverse_dynamics_controllers {
namespace {

using inverse_dynamics_control::Status;
using inverse_dynamics_control::StopReason;

class UpdateReportTest : public ::testing::Test {
 protected:
  static UpdateReport::Joints joints(bool a, bool b) {
    UpdateReport::Joints joints(2);
    joints << a, b;
    return joints;
  }

  std::vector<std::string> texts() {
    std::vector<std::string> all;
    for (const UpdateReport::Line& line : report.takeLines()) {
      all.push_back((line.is_error ? "ERROR: " : "WARN: ") + line.text);
    }
    return all;
  }

  using Texts = std::vector<std::string>;
  UpdateReport report{{"shoulder", "elbow"}};
};

TEST_F(UpdateReportTest, GoodCyclesAreNotWorthALine) {
  report.note(Status::kOk, joints(false, false), joints(false, false));
  EXPECT_EQ(texts(), Texts{});
}

TEST_F(UpdateReportTest, CutsNameTheJointsOnceUntilTheyComeAgain) {
  report.note(Status::kSaturated, joints(false, true), joints(false, false));
  report.note(Status::kRateLimited, joints(false, true), joints(true, true));
  EXPECT_EQ(texts(), (Texts{"WARN: effort cut to its limit: elbow",
                            "WARN: effort held back by limits.effort_rate: shoulder, elbow"}));
  EXPECT_EQ(texts(), Texts{});
}

TEST_F(UpdateReportTest, RefusalsSayWhyAndHowOften) {
  for (int k = 0; k < 3; ++k) {
    report.note(Status::kStateNotFinite, joints(false, false), joints(false, false));
  }
  report.noteGivenUp(Status::kStateNotFinite);
  report.noteNotWritten();
  const std::string why = text(Status::kStateNotFinite);
  EXPECT_EQ(texts(),
            (Texts{"ERROR: " + why +
                       ", for longer than tolerated_fault_time: nothing but the safe torque until "
                       "the controller is activated again",
                   "ERROR: " + why + ": safe torque in 3 cycles",
                   "ERROR: an effort couldn't be written to the hardware in 1 cycles"}));
}

TEST_F(UpdateReportTest, StopsNameTheJoint) {
  report.noteStop(StopReason::kNotFinite, 1);
  EXPECT_EQ(texts(), Texts{"ERROR: the reference is NaN or infinite (elbow): stopping; references "
                           "are ignored until the controller is activated again"});
  report.noteStop(StopReason::kStale, -1);
  EXPECT_EQ(texts(), Texts{"ERROR: no new reference came while the last one still moves: "
                           "stopping; references are ignored until the controller is activated "
                           "again"});
}

}  // namespace
}  // namespace inverse_dynamics_controllers

// SPDX-License-Identifier: Apache-2.0

#include "evaluation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "two_joint_solver.hpp"
#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_evaluation::SampleTable;

// Efforts as the motion needs them with recorded accelerations, and 0.25 and -0.5 N m more.
std::unique_ptr<SampleTable> log(bool efforts = true) {
  constexpr Eigen::Index kCount = 50;
  auto table = std::make_unique<SampleTable>();
  table->resize(2, kCount, {efforts, true});
  table->header_stamps.setLinSpaced(0, 10'000'000 * (kCount - 1));
  table->receive_stamps = table->header_stamps;
  const Eigen::RowVectorXd t = Eigen::RowVectorXd::LinSpaced(kCount, 0, 0.01 * (kCount - 1));
  table->q << t.array().sin().matrix(), t.array().cos().matrix();
  table->qd << t.array().cos().matrix(), -t.array().sin().matrix();
  table->qdd = -table->q;
  if (efforts) {
    table->effort.row(0) = (2 * table->qdd.row(0)).array() + 10 + 0.25;
    table->effort.row(1) = (3 * table->qdd.row(1)).array() + 20 - 0.5;
  }
  table->complete(inverse_dynamics_evaluation::Clock::kHeader);
  return table;
}

EvaluationOptions options() {
  EvaluationOptions options;
  options.effort.option = "torque";
  options.units = {"N m", "N m"};
  return options;
}

TEST(Evaluation, HasNoErrorsWhereNoEffortsAreRecorded) {
  const Evaluation evaluation =
      evaluate(log(false)->recorded(), *TwoJointSolver::make(), options());
  EXPECT_TRUE(evaluation.errors.empty());
  EXPECT_EQ(evaluation.table->computed.cols(), 50);
  EXPECT_EQ(errorTable(evaluation, {"N m", "N m"}),
            "  no efforts are recorded: there is nothing to compare with\n");
}

TEST(Evaluation, IsPrintedAsATable) {
  const Evaluation evaluation = evaluate(log()->recorded(), *TwoJointSolver::make(), options());
  const std::string table = errorTable(evaluation, {"N m", "N"});
  EXPECT_NE(table.find("  joint  unit      MAE     RMSE"), std::string::npos) << table;
  EXPECT_NE(table.find("  a      N m     0.250    0.250"), std::string::npos) << table;
  EXPECT_NE(table.find("  b      N       0.500    0.500"), std::string::npos) << table;
  EXPECT_EQ(table.find("mean"), std::string::npos) << "units differ";
  EXPECT_NE(errorTable(evaluation, {"N m", "N m"}).find("  mean   N m     0.375    0.375\n"),
            std::string::npos);
}

TEST(Evaluation, TheTableHasTheErrorsOfTheValidSamplesToo) {
  Evaluation evaluation = evaluate(log()->recorded(), *TwoJointSolver::make(), options());
  evaluation.table->kept.head(3).setConstant(false);
  evaluation.errors_of_kept = evaluation.errors;
  evaluation.errors_of_kept[0].rmse = 0.125;
  evaluation.errors_of_kept[1].rmse = 0.375;
  const std::string table = errorTable(evaluation, {"N m", "N m"});
  for (const char* end : {"RMSE*\n", "   0.125\n", "   0.375\n", "   0.250\n"}) {
    EXPECT_NE(table.find(end), std::string::npos) << end << table;
  }
  const std::string caption = "\n* over the 47 valid samples of 50\n";
  ASSERT_GT(table.size(), caption.size());
  EXPECT_EQ(table.substr(table.size() - caption.size()), caption);
}

}  // namespace
}  // namespace inverse_dynamics_ros

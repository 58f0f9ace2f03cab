// SPDX-License-Identifier: Apache-2.0

#include "torque_bag.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <rclcpp/utilities.hpp>
#include <sensor_msgs/msg/joint_state.hpp>

#include "output_bag.hpp"
#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

namespace fs = std::filesystem;

// A folder that is gone after the test.
class TorqueBag : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "torque_bag_test_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Everything in the folder, hidden files too.
  std::size_t entries(const fs::path& name = "") const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_ / name), fs::directory_iterator()));
  }

  fs::path folder_;
};

TEST_F(TorqueBag, IsThereOnlyWhenItIsFinished) {
  const fs::path target = folder_ / "result";
  {
    OutputBag bag(target, "sqlite3");
    bag.write(sensor_msgs::msg::JointState(), "/torques", 1);
    EXPECT_FALSE(fs::exists(target));
    bag.finish();
    EXPECT_TRUE(fs::exists(target / "metadata.yaml"));
    EXPECT_EQ(entries("result"), 2U);  // names of the other file differ by distribution
  }
  EXPECT_EQ(entries(), 1U);
}

TEST_F(TorqueBag, LeavesNothingIfItIsNotFinished) {
  {
    OutputBag bag(folder_ / "result", "sqlite3");
    bag.write(sensor_msgs::msg::JointState(), "/torques", 1);
    EXPECT_EQ(entries(), 1U);
  }
  EXPECT_EQ(entries(), 0U);
}

TEST_F(TorqueBag, NeverReplacesWhatIsThere) {
  const fs::path target = folder_ / "result";
  {
    OutputBag bag(target, "sqlite3");
    std::ofstream(target) << "meanwhile";
    EXPECT_THROW(bag.finish(), UserError);
  }
  EXPECT_TRUE(fs::is_regular_file(target));
  EXPECT_EQ(entries(), 1U);
  EXPECT_THROW(OutputBag(target, "sqlite3"), UserError);
}

TEST_F(TorqueBag, TakesANameWithASlashBehindIt) {
  OutputBag bag(folder_ / "result" / "", "sqlite3");
  bag.finish();
  EXPECT_TRUE(fs::exists(folder_ / "result" / "metadata.yaml"));
}

TEST_F(TorqueBag, RefusesAStorageThatIsNotInstalled) {
  EXPECT_THROW(OutputBag(folder_ / "result", "tape"), UserError);
  EXPECT_EQ(entries(), 0U);
}

TEST_F(TorqueBag, IsLeftOutWhenTheUserInterrupts) {
  using inverse_dynamics_evaluation::Storage;
  const RecordedMotion motion;
  Evaluation evaluation;
  evaluation.table = std::make_shared<inverse_dynamics_evaluation::SampleTable>();
  inverse_dynamics_evaluation::SampleTable& table = *evaluation.table;
  table.joint_names = {"a"};
  table.resize(1, 3, {});
  table.header_stamps.setLinSpaced(0, 2);
  table.receive_stamps = table.header_stamps;
  for (auto* columns : {&table.q, &table.qd, &table.effort}) columns->setZero();
  table.complete(inverse_dynamics_evaluation::Clock::kHeader);

  ASSERT_FALSE(rclcpp::ok());  // as after Ctrl-C
  EXPECT_THROW(writeTorques((folder_ / "result").string(), Storage::kSqlite3, "/torques", motion,
                            evaluation),
               Interrupted);
  EXPECT_EQ(entries(), 0U);

  rclcpp::init(0, nullptr);
  writeTorques((folder_ / "result").string(), Storage::kSqlite3, "/torques", motion, evaluation);
  rclcpp::shutdown();
  EXPECT_TRUE(fs::exists(folder_ / "result" / "metadata.yaml"));
}

}  // namespace
}  // namespace inverse_dynamics_ros

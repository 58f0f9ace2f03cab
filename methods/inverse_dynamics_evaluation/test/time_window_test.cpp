// SPDX-License-Identifier: Apache-2.0

#include <gmock/gmock.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "error_of.hpp"
#include "inverse_dynamics_evaluation/sample_table.hpp"
#include "joint_state_block.hpp"

namespace inverse_dynamics_evaluation::time_window_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Numbers = std::vector<std::int64_t>;
constexpr std::int64_t kSecond = 1'000'000'000;
constexpr double kForever = std::numeric_limits<double>::infinity();

// Messages `first` to `last`, received at 100 s and each second afterwards; q is their number.
JointStateBlock blockOf(std::int64_t first, std::int64_t last, bool with_header = true,
                        const std::vector<std::string>& names = {"a", "b"}) {
  JointStateBlock block;
  block.joint_names = names;
  block.frame_id = "base";
  for (std::int64_t k = first; k <= last; ++k) {
    block.header_stamps.push_back(with_header ? k * kSecond : 0);
    block.receive_stamps.push_back((100 + k) * kSecond);
    for (int j = 0; j < 2; ++j) {
      block.position.values.push_back(static_cast<double>(k));
      block.velocity.values.push_back(10.0 * static_cast<double>(k));
    }
  }
  block.position.columns = block.velocity.columns = 2;
  return block;
}

class Blocks : public JointStateSource {
 public:
  explicit Blocks(std::vector<JointStateBlock> blocks) : blocks_(std::move(blocks)) {}
  bool next(JointSample& sample) override {
    if (at_ == blocks_.size()) return false;
    sample = blocks_[at_].sample(row_++);
    sample.message = done_++;
    if (row_ == blocks_[at_].size()) ++at_, row_ = 0;
    return true;
  }
  void rewind() override { at_ = row_ = done_ = 0; }
  std::int64_t expectedMessages() const override { return 7; }
  std::string where() const override { return "bag: /joint_states"; }

 private:
  std::vector<JointStateBlock> blocks_;
  std::size_t at_ = 0, row_ = 0, done_ = 0;
};

struct Part {
  std::vector<JointStateBlock> blocks;
  TimeSpan span;
  std::vector<std::string> joints = {};
  Clock clock = Clock::kAuto;
};

// Numbers of the messages in a part of a recording, each checked to be whole.
Numbers messagesOf(const Part& part) {
  Blocks source(part.blocks);
  RecordingOptions options;
  options.joints = part.joints;
  options.clock = part.clock;
  options.effort_required = false;
  options.window = part.span;
  SampleTable table;
  readTable(source, options, table);
  Numbers numbers;
  for (Eigen::Index k = 0; k < table.size(); ++k) {
    const auto number = static_cast<std::int64_t>(table.q(0, k));
    EXPECT_EQ(table.q(1, k), static_cast<double>(number));
    EXPECT_EQ(table.qd(0, k), 10.0 * static_cast<double>(number));
    EXPECT_EQ(table.receive_stamps[k], (100 + number) * kSecond);
    numbers.push_back(number);
  }
  EXPECT_EQ(table.effort.size(), 0);
  EXPECT_EQ(table.frame_id, "base");
  return numbers;
}

TEST(TimeWindow, GivesTheMessagesBetweenItsEndsBothIncluded) {
  const Part source{{blockOf(5, 7), blockOf(8, 9), blockOf(10, 13)}, {2, 6}};
  EXPECT_THAT(messagesOf(source), ElementsAre(7, 8, 9, 10, 11));
}

TEST(TimeWindow, MeansItsEndsToTheNanosecond) {
  JointStateBlock block = blockOf(0, 2);
  block.header_stamps = {0, 300'000'000, 300'000'001};  // 1e-9 * 3e8 > 0.3
  const Part to{{block}, {0, 0.3}};
  const Part from{{block}, {0.300000001, 1}};
  EXPECT_THAT(messagesOf(to), ElementsAre(0, 1));
  EXPECT_THAT(messagesOf(from), ElementsAre(2));
}

TEST(TimeWindow, IsOpenWhereNoEndIsGiven) {
  const Part from{{blockOf(0, 2), blockOf(3, 4)}, {3, kForever}};
  const Part to{{blockOf(0, 2), blockOf(3, 4)}, {-kForever, 1}};
  const Part all{{blockOf(0, 2), blockOf(3, 4)}, {}};
  EXPECT_THAT(messagesOf(from), ElementsAre(3, 4));
  EXPECT_THAT(messagesOf(to), ElementsAre(0, 1));
  EXPECT_THAT(messagesOf(all), ElementsAre(0, 1, 2, 3, 4));
}

TEST(TimeWindow, TakesStampsThatDontIncreaseAsTheyAre) {
  JointStateBlock block = blockOf(0, 4);
  block.header_stamps = {0, 3 * kSecond, 1 * kSecond, 4 * kSecond, 2 * kSecond};
  const Part source{{block}, {1, 2}};
  EXPECT_THAT(messagesOf(source), ElementsAre(2, 4));
}

TEST(TimeWindow, GoesByTheHeaderIfAnyHasAStampElseByReception) {
  const Part stamped{{blockOf(0, 0), blockOf(1, 4)}, {2, 3}};  // the first stamp is 0
  EXPECT_THAT(messagesOf(stamped), ElementsAre(2, 3));
  const Part received{{blockOf(0, 1, false), blockOf(2, 4, false)}, {2, 3}};
  EXPECT_THAT(messagesOf(received), ElementsAre(2, 3));
}

TEST(TimeWindow, GoesByTheClockThatIsGiven) {
  JointStateBlock block = blockOf(0, 3);
  block.header_stamps = {0, 10 * kSecond, 20 * kSecond, 30 * kSecond};
  const Part header{{block}, {5, 25}, {}, Clock::kHeader};
  const Part receive{{block}, {2, 25}, {}, Clock::kReceive};
  EXPECT_THAT(messagesOf(header), ElementsAre(1, 2));
  EXPECT_THAT(messagesOf(receive), ElementsAre(2, 3));
}

TEST(TimeWindow, CountsFromTheFirstMessageWithTheJoints) {
  const Part source{{blockOf(0, 1, true, {"gripper", "lid"}), blockOf(2, 6)}, {1, 2}, {"b", "a"}};
  EXPECT_THAT(messagesOf(source), ElementsAre(3, 4));
}

TEST(TimeWindow, LeavesOutWhatIsWrongOutsideOfIt) {
  JointStateBlock block = blockOf(0, 4);
  block.position.values[0] = block.velocity.values[9] = std::numeric_limits<double>::quiet_NaN();
  const Part inside{{block}, {1, 3}};
  EXPECT_THAT(messagesOf(inside), ElementsAre(1, 2, 3));
  const Part beyond{{block}, {1, 4}};
  EXPECT_THAT(errorOf<RecordingError>([&] { messagesOf(beyond); }),
              HasSubstr("message 5: velocity"));
}

TEST(TimeWindow, LeavesARecordingWithoutTheJointsToItsReader) {
  const Part others{{blockOf(0, 1)}, {1, 2}, {"c"}};
  EXPECT_THAT(errorOf<RecordingError>([&] { messagesOf(others); }),
              HasSubstr("expected the joints c, got only a, b"));
  const Part empty{{}, {1, 2}};
  EXPECT_THAT(errorOf<RecordingError>([&] { messagesOf(empty); }), HasSubstr("got no message"));
}

TEST(TimeWindow, TakesAnyTwoStamps) {
  JointStateBlock block = blockOf(0, 1);
  block.header_stamps = {std::numeric_limits<std::int64_t>::min(),
                         std::numeric_limits<std::int64_t>::max()};
  const Part source{{block}, {1e10, 2e10}};
  EXPECT_THAT(messagesOf(source), ElementsAre(1));  // 1.8e10 s later
}

}  // namespace inverse_dynamics_evaluation::time_window_test

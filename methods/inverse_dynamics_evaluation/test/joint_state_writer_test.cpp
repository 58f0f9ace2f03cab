// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/joint_state_writer.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <inverse_dynamics_evaluation/error.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "error_of.hpp"
#include "joint_state_block.hpp"

namespace inverse_dynamics_evaluation::joint_state_writer_test {

namespace fs = std::filesystem;
using inverse_dynamics_evaluation::RecordingError;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr double kNumbers[] = {1, 2};

// What a test writes goes with it.
class JointStateWriterTest : public ::testing::TestWithParam<Storage> {
 protected:
  void SetUp() override {
    std::string pattern = fs::temp_directory_path() / "writer_test_XXXXXX";
    directory_ = ::mkdtemp(pattern.data());
    bag_ = directory_ / "bag";
  }
  void TearDown() override { fs::remove_all(directory_); }

  JointStateWriter writer() const {
    return JointStateWriter(bag_, GetParam(), {{"/torques", {"joint_1", "joint_2"}}});
  }

  fs::path directory_;
  std::string bag_;
};

// One message, whose stamps must stay.
JointStateRows rowsAt(const std::int64_t& header, const std::int64_t& received) {
  return {1, &header, &received, kNumbers, kNumbers, kNumbers};
}
constexpr std::int64_t kOne = 1;

TEST_P(JointStateWriterTest, RefusesStampsThatMessagesCantHold) {
  constexpr std::int64_t kMost = (std::int64_t{1} << 31U) * kSecond;
  for (const std::int64_t header : {kMost, -kMost - 1, 3 * kMost}) {
    JointStateWriter made = writer();
    EXPECT_THAT(errorOf<RecordingError>([&] { made.write({rowsAt(header, kOne)}); }),
                StartsWith(bag_ +
                           ": /torques: a time of the header: expected the years 1901 to "
                           "2038, got " +
                           std::to_string(header) + " ns; "));
  }
  for (const std::int64_t header : {kMost - 1, -kMost}) {
    JointStateWriter made = writer();
    made.write({rowsAt(header, kOne)});
    made.finish();
    const auto source = Recording(bag_).jointStates();
    JointSample sample;
    source->next(sample);
    EXPECT_EQ(sample.header_stamp, header);
    fs::remove_all(bag_);
  }
}

TEST_P(JointStateWriterTest, RefusesTimesOfReceptionThatCantBeReadAgain) {
  for (const std::int64_t received : {std::int64_t{-1}, (std::int64_t{1} << 62U) + 1}) {
    JointStateWriter made = writer();
    EXPECT_THAT(errorOf<RecordingError>([&] { made.write({rowsAt(kOne, received)}); }),
                StartsWith(bag_ +
                           ": /torques: a time of reception: expected the years 1970 to "
                           "2116, got " +
                           std::to_string(received) + " ns; "));
  }
}

TEST_P(JointStateWriterTest, RefusesRowsThatDontFitItsTopics) {
  const JointStateRows one = rowsAt(kOne, kOne);
  for (const std::size_t count : {0U, 2U}) {
    EXPECT_THAT(errorOf<RecordingError>([&] { writer().write(std::vector(count, one)); }),
                HasSubstr("expected rows of each topic, 1, got " + std::to_string(count)));
  }
  JointStateRows without = one;
  without.velocity = nullptr;
  EXPECT_THAT(errorOf<RecordingError>([&] { writer().write({without}); }),
              HasSubstr("/torques: expected numbers of each field that the topic has"));
}

TEST_P(JointStateWriterTest, WritesComputedTorquesAndMeasuredOnesWhereThereAreAny) {
  constexpr std::size_t kCount = 5000;  // more than are written at once
  std::vector<std::int64_t> stamps(kCount);
  std::vector<double> q(2 * kCount), computed(2 * kCount), measured(2 * kCount);
  for (std::size_t k = 0; k < 2 * kCount; ++k) {
    stamps[k / 2] = static_cast<std::int64_t>(k / 2);
    q[k] = static_cast<double>(k);
    computed[k] = 2.0 * q[k];
    measured[k] = 3.0 * q[k];
  }
  const JointStateRows rows = {kCount,   stamps.data(), stamps.data(),
                               q.data(), q.data(),      computed.data()};
  const JointStateTopic topic = {"/tau", {"joint_1", "joint_2"}, "base"};
  for (const double* efforts : {measured.data(), static_cast<double*>(nullptr)}) {
    writeTorques(bag_, GetParam(), topic, rows, efforts);
    const Recording recording(bag_);
    ASSERT_EQ(recording.topics().size(), efforts == nullptr ? 1U : 2U);
    for (const Topic& written : recording.topics()) {
      const double* next = written.name == "/tau" ? computed.data() : efforts;
      const JointStateBlock all = rest(*recording.jointStates(written.name));
      EXPECT_EQ(all.frame_id, "base");
      for (const double effort : all.effort.values) ASSERT_EQ(effort, *next++);
      EXPECT_EQ(all.size(), kCount) << written.name;
    }
    fs::remove_all(bag_);
  }
  EXPECT_THROW(writeTorques(bag_, GetParam(), topic, rows, measured.data(),
                            [](double share) {
                              if (share > 0) throw std::runtime_error("stopped");
                            }),
               std::runtime_error);
  EXPECT_FALSE(fs::exists(bag_));
}

TEST_P(JointStateWriterTest, LeavesNothingIncomplete) {
  {
    JointStateWriter made = writer();
    made.write({rowsAt(kOne, kOne)});
    EXPECT_TRUE(fs::exists(bag_));
  }
  EXPECT_FALSE(fs::exists(bag_));
  {
    JointStateWriter made = writer();
    made.finish();
  }
  EXPECT_TRUE(fs::exists(bag_));
}

// A limit on the size of files stands for a disk that is full.
TEST_P(JointStateWriterTest, LeavesNothingWhereTheDiskIsFull) {
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{100'000, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  JointStateWriter made = writer();
  const std::vector<std::int64_t> stamps(100'000, 1);
  const std::vector<double> numbers(2 * stamps.size());
  const std::string text = errorOf<RecordingError>([&] {
    made.write({{stamps.size(), stamps.data(), stamps.data(), numbers.data(), numbers.data(),
                 numbers.data()}});
    made.finish();
  });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(text, StartsWith(bag_ + ": can't be written ("));
  EXPECT_FALSE(fs::exists(bag_));
}

INSTANTIATE_TEST_SUITE_P(Storages, JointStateWriterTest,
                         ::testing::Values(Storage::kSqlite3, Storage::kMcap),
                         [](const auto& storage) { return name(storage.param); });

}  // namespace inverse_dynamics_evaluation::joint_state_writer_test

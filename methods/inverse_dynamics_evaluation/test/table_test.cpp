// SPDX-License-Identifier: Apache-2.0

// An evaluation of a recording that is read message by message against that of samples in memory.

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "error_of.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/evaluator.hpp"
#include "joint_log.hpp"
#include "motion.hpp"
#include "two_joint_solver.hpp"

namespace inverse_dynamics_evaluation::table_test {

using Eigen::Index;
using Eigen::MatrixXd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A log as messages; joint b before joint a.
class Messages : public JointStateSource {
 public:
  explicit Messages(const JointLog& log) : log_(log) {}

  bool next(JointSample& sample) override {
    if (next_ == log_.q.cols()) return false;
    sample = JointSample();
    sample.names = &names_;
    sample.frame_id = "base";
    numbers_ << log_.q.col(next_).reverse(), log_.qd.col(next_).reverse(),
        log_.effort.col(next_).reverse();
    sample.position = {numbers_.data(), 2};
    sample.velocity = {numbers_.data() + 2, 2};
    sample.effort = {numbers_.data() + 4, 2};
    sample.header_stamp = log_.header_stamps[next_];
    sample.receive_stamp = log_.receive_stamps[next_];
    sample.message = next_++;
    return true;
  }
  void rewind() override {
    next_ = 0;
    ++passes;
  }
  std::int64_t expectedMessages() const override { return log_.q.cols(); }
  std::string where() const override { return "bag: /joint_states"; }

  int passes = 0;  // that were begun, by rewind()

 private:
  const JointLog& log_;
  std::vector<std::string> names_ = {"b", "a"};
  Eigen::Matrix<double, 6, 1> numbers_;
  Index next_ = 0;
};

JointLog logOf(const Motion& motion) {
  JointLog log;
  log.header_stamps = (motion.time * 1e9).array().round().cast<std::int64_t>();
  log.header_stamps.array() += 1'700'000'000'000'000'000;
  log.receive_stamps = log.header_stamps;
  log.receive_stamps.array() += 1'000'000;
  log.q = motion.q;
  log.qd = motion.qd;
  log.effort = motion.effort;
  return log;
}

Motion noisy(double rate, double seconds) {
  Motion motion = sines(rate, seconds, {0.5, 1.0});
  addVelocityNoise(motion, 0.005, 1);
  return motion;
}

// Everything that is odd about recordings, one by one.
std::vector<std::pair<std::string, JointLog>> oddRecordings() {
  std::vector<std::pair<std::string, JointLog>> all;
  const auto add = [&](const std::string& what, const Motion& motion) {
    all.emplace_back(what, logOf(motion));
  };
  const Motion clean = noisy(125.0, 80.0);
  add("clean", clean);
  add("repeats", withRepeats(clean, 10));
  Motion motion = clean;
  motion.time.tail(6000).array() += 3.0;
  motion.time.tail(5995).array() += 2.0;  // five samples between two gaps
  add("gaps", motion);
  motion = clean;
  motion.time[4096] = motion.time[4095];
  motion.time.segment(4090, 5).array() -= 0.5;
  motion.time.tail(1).array() -= 1.0;
  add("backward stamps", motion);
  motion = clean;
  for (Index k = 0; k < 20; ++k) {
    motion.effort(0, k) += k % 2 == 0 ? 800.0 : -800.0;
  }
  add("start transient", motion);
  motion = clean;
  jitterStamps(motion, 0.8, 2);
  add("regular", motion);
  std::vector<Index> samples;
  for (Index k = 0; k < clean.count(); ++k) {
    samples.push_back(k - k / 25);
  }
  add("regular fresh", pick(clean, samples, 0.96 * clean.time));
  motion = clean;
  motion.time.segment(3000, 4000).array() -= 40.0;  // a clock that was set back
  add("clock set back", motion);
  return all;
}

EvaluationOptions options(const std::string& effort = kTorque) {
  EvaluationOptions options;
  options.effort.option = effort;
  options.recording = "bag";
  options.topic = "/joint_states";
  return options;
}

RecordingOptions joints(const std::string& scratch = "") {
  RecordingOptions options;
  options.joints = {"a", "b"};
  options.scratch = scratch;
  return options;
}

TEST(Table, OfARecordingHasTheBitsOfSamplesInMemory) {
  const TwoJointSolver solver;
  for (const auto& [what, log] : oddRecordings()) {
    SCOPED_TRACE(what);
    const Evaluation expected = evaluate(log, solver, options(kAutomatic));
    const SampleTable& whole = *expected.table;
    EXPECT_EQ(whole.size(), log.q.cols());
    for (const std::string& directory : {std::string(), testing::TempDir()}) {
      Messages messages(log);
      const Evaluation found = evaluate(messages, joints(directory), solver, options(kAutomatic));
      EXPECT_EQ(messages.passes, 0);
      const SampleTable& table = *found.table;
      EXPECT_EQ(table.header_stamps, log.header_stamps);
      EXPECT_EQ(table.receive_stamps, log.receive_stamps);
      EXPECT_EQ(table.q, log.q);
      EXPECT_EQ(table.effort, log.effort);
      EXPECT_EQ(table.qdd, whole.qdd);
      EXPECT_EQ(table.computed, whole.computed);
      EXPECT_EQ(table.measured, whole.measured);
      EXPECT_TRUE((table.kept == whole.kept).all());
      EXPECT_EQ(found.notes, expected.notes);
      EXPECT_EQ(found.errors[1].rmse, expected.errors[1].rmse);
      EXPECT_EQ(found.errors_of_kept[1].rmse, expected.errors_of_kept[1].rmse);
      EXPECT_EQ(found.accelerations.filter.cutoff, expected.accelerations.filter.cutoff);
      EXPECT_EQ(found.accelerations.samples.counts.kept, whole.kept.count());
      EXPECT_EQ(table.joint_names, (std::vector<std::string>{"a", "b"}));
      EXPECT_EQ(table.frame_id, "base");
    }
  }
}

TEST(Table, FindsWhatIsOdd) {
  const TwoJointSolver solver;
  std::vector<std::string> bases;
  for (const auto& [what, log] : oddRecordings()) {
    const Evaluation found = evaluate(log, solver, options());
    const SampleReport& report = found.accelerations.samples;
    const SampleTable& table = *found.table;
    bases.push_back(name(report.time_base));
    EXPECT_EQ(report.counts.repeated, table.repeated.count()) << what;
    EXPECT_EQ(report.counts.non_increasing, table.non_increasing.count()) << what;
    EXPECT_EQ(report.counts.start_transient, table.start_transient.count()) << what;
    EXPECT_EQ(report.counts.isolated, table.isolated.count()) << what;
    EXPECT_EQ(report.counts.kept, table.kept.count()) << what;
    for (Index k = 1; k < table.size(); ++k) {
      ASSERT_LE(table.instant[k - 1], table.instant[k]) << what << k;
    }
  }
  EXPECT_THAT(bases, ElementsAre("stamps", "stamps", "stamps", "stamps", "stamps", "regular",
                                 "regular_fresh", "stamps"));
}

TEST(Table, TakesTheTimeOfReceptionIfNoHeaderHasAStamp) {
  JointLog log = logOf(noisy(125.0, 20.0));
  log.header_stamps.setZero();
  for (const std::string& scratch : {std::string(), testing::TempDir()}) {
    Messages messages(log);
    log.clock = Clock::kHeader;
    const Evaluation found = evaluate(messages, joints(scratch), TwoJointSolver(), options());
    EXPECT_EQ(found.table->clock(), Clock::kReceive);
    EXPECT_THAT(found.table->notes, ElementsAre(HasSubstr("time of reception")));
    log.clock = Clock::kReceive;
    EXPECT_EQ(found.errors[0].rmse, evaluate(log, TwoJointSolver(), options()).errors[0].rmse);
  }
}

TEST(Table, TellsWhyTheSamplesCannotBeKept) {
  const JointLog log = logOf(noisy(125.0, 20.0));
  Messages messages(log);
  EXPECT_THAT(errorOf<RecordingError>([&] {
                evaluate(messages, joints("/no/such/directory"), TwoJointSolver(), options());
              }),
              HasSubstr("/no/such/directory: can't be written (No such file or directory); free "
                        "some space, or name another output"));
}

TEST(Table, TellsOfTheProgressAndCanBeStopped) {
  const JointLog log = logOf(noisy(125.0, 80.0));
  Messages messages(log);
  EvaluationOptions told = options();
  std::vector<double> shares;
  told.progress = [&](double share) { shares.push_back(share); };
  evaluate(messages, joints(), TwoJointSolver(), told);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GT(shares.size(), 8U);
  EXPECT_NEAR(shares.back(), 1.0, 0.1);
  told.progress = [](double share) {
    if (share > 0.5) {
      throw std::runtime_error("stopped");
    }
  };
  messages.rewind();
  EXPECT_THROW(evaluate(messages, joints(), TwoJointSolver(), told), std::runtime_error);
}

// Bytes that a file may have at most.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FileLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
};

TEST(Table, IsAnErrorWhereTheDirectoryHasNoRoomForIt) {
  const std::string directory = testing::TempDir();
  const JointLog log = logOf(noisy(125.0, 80.0));  // 16 bytes a column and sample: 160 kB
  const FileLimit limit(100'000);
  Messages messages(log);
  EXPECT_THAT(errorOf<RecordingError>(
                  [&] { evaluate(messages, joints(directory), TwoJointSolver(), options()); }),
              HasSubstr(directory + ": can't be written (File too large); free some space"));
}

TEST(Table, KeepsItsRowsWhereItGrows) {
  const JointLog log = logOf(noisy(125.0, 80.0));
  for (const std::string& directory : {std::string(), testing::TempDir()}) {
    SampleTable table(directory);
    for (Index count = 1; table.size() < log.q.cols(); count *= 2) {
      const Index first = table.size();
      count = std::min(count, log.q.cols() - first);
      table.resize(2, first + count, {});
      table.header_stamps.tail(count) = log.header_stamps.segment(first, count);
      table.receive_stamps.tail(count) = log.receive_stamps.segment(first, count);
      table.q.rightCols(count) = log.q.middleCols(first, count);
      table.qd.rightCols(count) = log.qd.middleCols(first, count);
      table.effort.rightCols(count) = log.effort.middleCols(first, count);
    }
    table.complete(Clock::kReceive);
    EXPECT_EQ(table.q, log.q);
    EXPECT_EQ(table.qd, log.qd);
    EXPECT_EQ(table.effort, log.effort);
    EXPECT_EQ(table.stamps(), log.receive_stamps);
    EXPECT_EQ(table.time, log.time());
    EXPECT_EQ(table.measured.cols(), log.q.cols());
  }
}

TEST(Table, TellsTheProgressUpToATimeWindowAndItsEnd) {
  const JointLog log = logOf(noisy(125.0, 80.0));
  Messages messages(log);
  RecordingOptions part = joints();
  part.window = {70.0, 75.0};
  EvaluationOptions watched = options();
  std::vector<double> shares;
  watched.progress = [&](double share) { shares.push_back(share); };
  evaluate(messages, part, TwoJointSolver(), watched);
  EXPECT_NEAR(shares.front(), 0.4 * 4096 / 10001, 1e-9);  // of the whole recording
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1.0);
}

}  // namespace inverse_dynamics_evaluation::table_test

// SPDX-License-Identifier: Apache-2.0

/// @file
/// Samples as they come, as often as they are asked for.
///
///     SampleBlock block;
///     while (stream.next(block)) use(block);
///     stream.rewind();   // for another pass

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/joint_log.hpp"
#include "inverse_dynamics_evaluation/joint_state_source.hpp"
#include "inverse_dynamics_evaluation/log_accelerations.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Samples that a solver gets at once: whole groups of those that it computes in parallel, and few
/// enough to stay in the cache.
constexpr Eigen::Index kSamplesAtOnce = 4096;

/// B consecutive samples of n joints, one sample per column.
struct SampleBlock {
  using StampVector = Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>;

  Eigen::Index first = 0;                     ///< number of the first one in the recording
  StampVector header_stamps, receive_stamps;  ///< B; ns
  Eigen::VectorXd time;                       ///< B; s
  Eigen::MatrixXd q, qd;                      ///< n x B; rad, rad/s (prismatic m, m/s)
  Eigen::MatrixXd effort;                     ///< n x B; as recorded; empty (0 x 0) if none was
  Eigen::MatrixXd qdd;  ///< n x B; rad/s^2 (prismatic m/s^2); empty (0 x 0) if none was

  Eigen::Index size() const { return time.size(); }
};

/// Samples of a recording, block by block; each pass gives the same ones.
class SampleStream {
 public:
  SampleStream() = default;
  SampleStream(const SampleStream&) = delete;
  SampleStream& operator=(const SampleStream&) = delete;
  virtual ~SampleStream() = default;

  /// Replaces a block by the next samples, at least one; false after the last one.
  virtual bool next(SampleBlock& block) = 0;

  /// Makes the first sample the next one.
  virtual void rewind() = 0;

  /// After the first pass: whether its time has to be taken from the other stamps, and so the pass
  /// to be repeated.
  virtual bool clockHasChanged() { return false; }

  /// Whose stamps are the time.
  virtual Clock clock() const = 0;

  /// File and topic, for texts; empty where nobody knows.
  virtual std::string where() const { return ""; }

  /// After the first pass: the first frame that a header has.
  virtual std::string frameId() const { return ""; }

  /// What is told where a pass gives other samples than the first one. @throws RecordingError
  [[noreturn]] void throwChanged() const;
};

/// Samples in memory.
class SamplesInMemory : public SampleStream {
 public:
  /// @param log   must outlive the stream; stamps may be missing.
  /// @param time  N; s.
  SamplesInMemory(const JointLogView& log, Eigen::VectorXd time)
      : log_(log), time_(std::move(time)) {}

  bool next(SampleBlock& block) override;
  void rewind() override { next_ = 0; }
  Clock clock() const override { return log_.clock; }

 private:
  const JointLogView& log_;
  Eigen::VectorXd time_;
  Eigen::Index next_ = 0;
};

/// Samples without stamps.
inline JointLogView withoutStamps(const JointLogView::Block& q, const JointLogView::Block& qd,
                                  const JointLogView::Block& effort) {
  const JointLogView::StampsBlock none = SampleBlock::StampVector();
  return {none, none, Clock::kHeader, q, qd, effort, Eigen::MatrixXd()};
}

/// Samples of recorded messages, by the rules of joint_log.hpp.
class RecordedSamples : public SampleStream {
 public:
  /// @param source  must outlive the stream.
  RecordedSamples(JointStateSource& source, std::vector<std::string> joints, Clock clock,
                  JointLogOptions options);

  bool next(SampleBlock& block) override;
  void rewind() override;
  bool clockHasChanged() override;
  Clock clock() const override { return clock_; }
  std::string where() const override { return source_.where(); }
  std::string frameId() const override { return about_.frame_id; }

  /// After the first pass: what the recording holds beside the samples.
  const JointLog& about() const { return about_; }

 private:
  void check(const Eigen::Ref<const Eigen::MatrixXd>& numbers);

  JointStateSource& source_;
  std::vector<std::string> joints_;
  Clock asked_, clock_;
  JointLogOptions options_;
  JointLogBuilder builder_;
  JointStateBlock messages_;
  JointLog about_;
  Eigen::Index samples_ = 0;                     // that this pass has given
  Eigen::Index all_ = -1;                        // that the first pass gave
  std::int64_t begin_ = 0;                       // first stamp
  std::uint64_t checked_ = 0, all_checked_ = 0;  // check sums of this pass and of the first one
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

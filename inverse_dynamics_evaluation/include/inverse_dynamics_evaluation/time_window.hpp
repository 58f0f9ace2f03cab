// SPDX-License-Identifier: Apache-2.0

/// @file
/// A part of a recording: the joint states whose time lies in a window.
///
///     TimeWindow part(recording.jointStates(), {10.0, 20.0});  // s since the first sample
///     while (part.next(block)) builder.add(block);             // JointLogBuilder [joint_log.hpp]
///
/// The rest is read, but never held. Times are those of the stamps: if a recording's stamps are
/// replaced by another time base [samples.hpp], that happens afterwards, to the samples of the
/// window.

#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/joint_log.hpp"
#include "inverse_dynamics_evaluation/joint_matching.hpp"
#include "inverse_dynamics_evaluation/joint_state_source.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// From when to when; both ends belong to it.
struct TimeSpan {
  double from = -std::numeric_limits<double>::infinity();  ///< s since the first sample
  double to = std::numeric_limits<double>::infinity();     ///< s since the first sample

  /// Whether it has an end.
  bool isBounded() const { return std::isfinite(from) || std::isfinite(to); }
};

/// Another source without the messages outside of a window.
class TimeWindow : public JointStateSource {
 public:
  /// @param source  at its first message.
  /// @param joints  the first message with any of them is at time zero; none: the first message.
  /// @param clock   which stamps are the time; kAuto: as JointLogBuilder decides.
  TimeWindow(std::unique_ptr<JointStateSource> source, TimeSpan window,
             std::vector<std::string> joints = {}, Clock clock = Clock::kAuto);

  /// @throws RecordingError: no message in the window, at the end; whatever the source throws.
  bool next(JointStateBlock& block) override;
  void rewind() override;
  std::int64_t expectedMessages() const override { return source_->expectedMessages(); }
  std::string where() const override { return source_->where(); }

 private:
  void findStart();
  bool isSample(const JointStateBlock& block);
  bool holds(std::size_t i);
  [[noreturn]] void refuse() const;

  std::unique_ptr<JointStateSource> source_;
  TimeSpan window_;
  JointMatching joints_;
  Clock clock_;
  std::optional<std::int64_t> start_;  // ns; stamp of the first sample
  bool looked_ = false;                // for it
  JointStateBlock read_;               // the source's last block
  std::size_t at_ = 0;                 // how many of its messages were looked at
  bool found_ = false;                 // a message in the window, in this pass
  double least_ = 0, greatest_ = 0;    // ns since the first sample; times of this pass
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

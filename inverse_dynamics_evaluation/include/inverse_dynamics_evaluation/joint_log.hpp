// SPDX-License-Identifier: Apache-2.0

/// @file
/// From decoded messages to samples: which joints, which messages, which time.
///
///     JointLogBuilder builder("recording: /joint_states", {"joint_1", "joint_2"});
///     for (const JointSample& sample : messages) builder.add(sample);
///     const JointLog log = builder.finish();
///
/// The rules, said in the notes of the result wherever they change anything:
///
/// - Joints are matched by name. Other joints may be there, in any order, in some messages or in
///   all.
/// - A message with none of the joints (the gripper's, on the same topic) is left out; one with
///   only some of them is an error.
/// - Time is the header's stamp; if no header has one, the time of reception. Stamps are taken as
///   they are, also where they don't increase: see samples.hpp.
/// - Arrays that are empty or not as long as the names are errors; so are numbers that aren't
///   finite or exceed kLargestNumber.

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/joint_matching.hpp"
#include "inverse_dynamics_evaluation/joint_state_source.hpp"
#include "inverse_dynamics_evaluation/metrics.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Stamps of N samples; ns since the epoch of whoever wrote them.
using Stamps = chain_dynamics::Owned<Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>>;

/// ns from one stamp to another, whatever their signs; exact up to 104 days.
double nanosecondsBetween(std::int64_t from, std::int64_t to);

/// N; s from one stamp [ns] to each of others.
OwnedVector secondsSince(
    std::int64_t from, const Eigen::Ref<const Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>>& to);

/// Which stamps are the time: the header's, those of reception, or what is there.
enum class Clock { kAuto, kHeader, kReceive };

/// `auto`, `header` or `receive`.
std::string name(Clock clock);

/// No position, velocity, effort or acceleration of a robot is larger, in SI units: beyond it lie
/// damage and mistaken units. The fourth power still fits into a double.
inline constexpr double kLargestNumber = 1e12;

/// The state of some joints in a message, looked at where it lies.
struct JointSample {
  using Numbers = Eigen::Map<const Eigen::VectorXd>;

  const std::vector<std::string>& names;
  Numbers position{nullptr, 0};      ///< rad (prismatic m); as long as the names
  Numbers velocity{nullptr, 0};      ///< rad/s (prismatic m/s)
  Numbers effort{nullptr, 0};        ///< as recorded: N m, A, ...
  Numbers acceleration{nullptr, 0};  ///< rad/s^2 (prismatic m/s^2); empty where none is recorded
  std::int64_t header_stamp = 0;     ///< ns
  std::int64_t receive_stamp = 0;    ///< ns
  Eigen::Index message = 0;          ///< number of its message, counted from 0
  Eigen::Index point = -1;           ///< number of it in a message with several, counted from 0
  std::string_view frame_id{};       ///< of the header
};

/// Joint states of one chain over time: N samples of n joints, one sample per column.
struct JointLog {
  std::vector<std::string> joint_names;  ///< n; the order of the rows
  Stamps header_stamps;                  ///< N; as the publisher wrote them
  Stamps receive_stamps;                 ///< N; as the recorder wrote them
  OwnedMatrix q;                         ///< n x N; rad (prismatic m)
  OwnedMatrix qd;                        ///< n x N; rad/s (prismatic m/s)
  OwnedMatrix effort;                    ///< n x N; as recorded; empty (0 x 0) if none was
  OwnedMatrix qdd;                       ///< n x N; as recorded; empty (0 x 0) if none was
  std::string frame_id;                  ///< the first that a header has
  std::vector<Eigen::Index> message;     ///< N; which message each sample is of
  Clock clock = Clock::kHeader;          ///< which of the stamps is the time
  std::vector<std::string> notes;        ///< what was left out or assumed, a sentence each

  /// N; those stamps that are the time of the samples.
  const Stamps& stamps() const { return clock == Clock::kReceive ? receive_stamps : header_stamps; }

  /// N; s since the first sample.
  OwnedVector time() const;
};

/// What a JointLogBuilder is to insist on, and how its texts name things.
struct JointLogOptions {
  bool effort_required = true;           ///< else efforts may be absent, from all samples
  std::string joints_option = "joints";  ///< where a user gives the recording's joint names
};

/// Collects samples into a JointLog.
class JointLogBuilder {
 public:
  /// @param where   file and topic, for error texts.
  /// @param joints  names in the order wanted; none: those of the first sample.
  /// @throws RecordingError: a name twice.
  JointLogBuilder(std::string where, std::vector<std::string> joints, JointLogOptions options = {});

  /// Adds a sample. @throws RecordingError by the rules at the top of this file.
  void add(const JointSample& sample);

  /// Adds each message of a block. @throws RecordingError by the same rules.
  void add(const JointStateBlock& block) { add(block, 0, block.size()); }

  /// Adds messages `begin` to `end` of a block. @throws RecordingError by the same rules.
  void add(const JointStateBlock& block, std::size_t begin, std::size_t end);

  /// How many samples were added, those left out too.
  Eigen::Index samples() const { return samples_; }

  /// What was added since the last call, and is given away: stamps, numbers, messages; no clock and
  /// no notes, which take the whole recording. For recordings that don't fit into memory.
  JointLog takeSamples();

  /// How many samples that would give.
  Eigen::Index samplesToTake() const { return static_cast<Eigen::Index>(message_.size()); }

  /// Everything added that wasn't taken, whose memory the builder gives away; clock and notes are
  /// those of all samples. The builder holds nothing then.
  ///
  /// @throws RecordingError: no sample with the joints.
  JointLog finish(Clock clock = Clock::kAuto);

 private:
  struct Column {
    const char* field;
    const char* reason;   // why it is needed
    OwnedMatrix numbers;  // with room for more samples than there are
    bool recorded;        // by the first sample, and so by all
  };

  bool addWhole(const JointStateBlock& block, std::size_t begin, std::size_t end);
  bool copy(Column& column, const JointStateNumbers& numbers, std::size_t begin, std::size_t end);
  bool matches(const JointSample& sample);
  bool isFirst() const { return taken_ == 0 && message_.empty(); }
  void noteStamps(std::int64_t header, std::int64_t receive);
  void reserve(Column& column, Eigen::Index more) const;
  void append(Column& column, const JointSample::Numbers& numbers, const JointSample& sample,
              bool required);
  std::string place(const JointSample& sample) const;
  void requireSamples() const;
  OwnedMatrix taken(Column& column) const;

  std::string where_;
  JointLogOptions options_;
  JointMatching matching_;
  std::vector<std::string> other_names_;  // of the first message left out
  Eigen::Index samples_ = 0;              // all that came
  Eigen::Index taken_ = 0;                // of those with the joints
  bool header_stamped_ = false;           // by any sample: not zero
  bool receive_stamped_ = false;
  std::string frame_id_;
  std::vector<std::int64_t> header_stamps_, receive_stamps_;
  std::vector<Eigen::Index> message_;
  Column position_, velocity_, effort_, acceleration_;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

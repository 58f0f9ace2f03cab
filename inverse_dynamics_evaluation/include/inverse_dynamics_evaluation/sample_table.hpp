// SPDX-License-Identifier: Apache-2.0

/// @file
/// Samples of a recording as a table: one column per quantity, one row per sample.
///
///     SampleTable table;
///     const JointLog about = readTable(*source, {joints}, table);   // one pass over the recording
///     table.q.col(k);                                               // positions of sample k
///
/// A recording of any length fits: with a directory, the columns lie in files there that have no
/// name, mapped into memory, so the system may write their pages to the disk. Such files vanish with
/// the program, however it ends.

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_evaluation/joint_log.hpp"
#include "inverse_dynamics_evaluation/joint_state_source.hpp"
#include "inverse_dynamics_evaluation/log_accelerations.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// N samples of n joints.
///
/// append() and complete() give the columns their size; functions over the table fill those that
/// aren't recorded. Copies of a column's map look at the same memory, which is the table's.
class SampleTable {
 public:
  using StampColumn = Eigen::Map<Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>>;
  using NumberColumn = Eigen::Map<Eigen::VectorXd>;
  using JointColumns = Eigen::Map<Eigen::MatrixXd>;
  using FlagColumn = Eigen::Map<Eigen::Array<bool, Eigen::Dynamic, 1>>;

  /// @param directory  of the files, about 400 bytes per sample of seven joints; empty: no files.
  explicit SampleTable(std::string directory = "");
  ~SampleTable();
  SampleTable(const SampleTable&) = delete;
  SampleTable& operator=(const SampleTable&) = delete;

  /// Adds recorded samples behind those that are there: all with efforts or none, likewise
  /// accelerations. @throws RecordingError: they don't fit into the directory.
  void append(const JointLogView& samples);

  /// All samples are there: sets their time, and gives the computed columns their size.
  ///
  /// @throws RecordingError: they don't fit into the directory.
  void complete(Clock clock);

  /// Memory for rows x cols numbers, the same for each call: valid until the next one.
  ///
  /// @throws RecordingError: they don't fit into the directory.
  JointColumns scratch(Eigen::Index rows, Eigen::Index cols);

  /// N.
  Eigen::Index size() const { return header_stamps.size(); }

  /// N; ns; those stamps that are the time of the samples.
  const StampColumn& stamps() const {
    return clock_ == Clock::kReceive ? receive_stamps : header_stamps;
  }
  Clock clock() const { return clock_; }

  /// @name As recorded
  /// @{
  StampColumn header_stamps{nullptr, 0}, receive_stamps{nullptr, 0};  ///< N; ns
  NumberColumn time{nullptr, 0};       ///< N; s since the first sample
  JointColumns q{nullptr, 0, 0};       ///< n x N; rad (prismatic m)
  JointColumns qd{nullptr, 0, 0};      ///< n x N; rad/s (prismatic m/s)
  JointColumns effort{nullptr, 0, 0};  ///< n x N; empty (0 x 0) if none was recorded
  bool has_accelerations = false;      ///< whether qdd is recorded
  /// @}

  /// @name Computed
  /// @{
  JointColumns qdd{nullptr, 0, 0};       ///< n x N; rad/s^2 (prismatic m/s^2)
  JointColumns computed{nullptr, 0, 0};  ///< n x N; N m (prismatic N); see Evaluation
  JointColumns measured{nullptr, 0, 0};  ///< n x N; N m (prismatic N); empty without efforts
  NumberColumn instant{nullptr, 0};      ///< N; s; when each sample was taken: SampleReport::time
  FlagColumn repeated{nullptr, 0}, non_increasing{nullptr, 0}, start_transient{nullptr, 0},
      isolated{nullptr, 0}, used{nullptr, 0}, kept{nullptr, 0};  ///< N; as in SampleReport
                                                                 /// @}

 private:
  class Memory;

  template <class Columns>
  void place(Columns& columns, Eigen::Index rows, Eigen::Index cols);

  std::string directory_;
  Clock clock_ = Clock::kHeader;
  JointColumns scratch_{nullptr, 0, 0};
  std::vector<std::pair<const void*, std::unique_ptr<Memory>>> memory_;  // of each column
};

/// From when to when; both ends belong to it.
struct TimeSpan {
  double from = -std::numeric_limits<double>::infinity();  ///< s since the first sample
  double to = std::numeric_limits<double>::infinity();     ///< s since the first sample
};

/// Which joints of a recording, and which time.
struct RecordingOptions {
  std::vector<std::string> joints;  ///< n; their names there, in the order of the chain
  Clock clock = Clock::kAuto;
  JointLogOptions log;
  std::string scratch;  ///< directory for the table's files; empty: memory
  TimeSpan window =
      {};  ///< other messages are left out, whatever they hold. Its times are those of
           ///< the stamps, from the first message with any of the joints on
};

/// Progress callback with the share that is done, 0 to 1; throwing cancels. Optional.
using TellProgress = std::function<void(double)>;

/// Reads the samples of a recording in one pass, by the rules of joint_log.hpp.
///
/// @return names, clock, frame and notes; its columns are those of the table.
/// @throws RecordingError: by those rules; no message in the window; they don't fit into the
///         table's directory.
JointLog readTable(JointStateSource& source, const RecordingOptions& options, SampleTable& table,
                   const TellProgress& progress = nullptr);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

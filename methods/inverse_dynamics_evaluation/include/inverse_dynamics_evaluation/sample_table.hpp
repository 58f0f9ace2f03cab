// SPDX-License-Identifier: Apache-2.0

/// @file
/// Samples of a recording as a table: one column per quantity, one row per sample.
///
///     SampleTable table;
///     readTable(source, {joints}, table);            // one pass over the recording
///     std::cout << table.q.col(k);                   // positions of sample k
///
/// A recording of any length fits: with a directory, the columns lie in unnamed files there, mapped
/// into memory, so the system may write their pages to the disk. Such files vanish with the program,
/// however it ends.
///
/// Rules of reading; notes of the table say where they change anything:
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
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/joint_matching.hpp"
#include "inverse_dynamics_evaluation/joint_state_source.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Which stamps are the time: the header's, those of reception, or what is there.
enum class Clock { kAuto, kHeader, kReceive };

/// `auto`, `header` or `receive`.
std::string name(Clock clock);

/// ns from one stamp to another, whatever their signs; exact up to 104 days.
double nanosecondsBetween(std::int64_t from, std::int64_t to);

/// No position, velocity, effort or acceleration of a robot is larger, in SI units: beyond it lie
/// damage and mistaken units. The fourth power still fits into a double.
inline constexpr double kLargestNumber = 1e12;

/// Recorded samples of n joints, N of them, one per column; looked at where they lie.
struct RecordedColumns {
  using Numbers = Eigen::Ref<const Eigen::MatrixXd>;
  using Stamps = Eigen::Ref<const Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>>;

  Stamps header_stamps, receive_stamps;  ///< N; ns
  Clock clock;                           ///< which of them are the time
  Numbers q, qd;                         ///< n x N; rad, rad/s (prismatic m, m/s)
  Numbers effort;                        ///< n x N; as recorded; empty (0 x 0) if none was
  Numbers qdd;  ///< n x N; rad/s^2 (prismatic m/s^2); empty (0 x 0) if none was
};

/// N samples of n joints.
///
/// resize() and complete() give the columns their size. Copies of a column's map look at the same
/// memory, which is the table's.
class SampleTable {
 public:
  using StampColumn = Eigen::Map<Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>>;
  using NumberColumn = Eigen::Map<Eigen::VectorXd>;
  using JointColumns = Eigen::Map<Eigen::MatrixXd>;
  using FlagColumn = Eigen::Map<Eigen::Array<bool, Eigen::Dynamic, 1>>;

  /// @param directory  of the files, 430 bytes per sample of seven joints; empty: no files.
  explicit SampleTable(std::string directory = "");
  ~SampleTable();
  SampleTable(const SampleTable&) = delete;
  SampleTable& operator=(const SampleTable&) = delete;

  /// Which columns are recorded beside stamps, positions and velocities.
  struct Recorded {
    bool efforts = true, accelerations = false;
  };

  /// Gives the recorded columns their size; samples that are there stay.
  ///
  /// @throws RecordingError: they don't fit into the directory.
  void resize(Eigen::Index joints, Eigen::Index samples, Recorded recorded);

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

  /// What was recorded.
  RecordedColumns recorded() const;

  /// @name As recorded
  /// @{
  std::vector<std::string> joint_names;  ///< n; those of the recording, in the order of the rows
  std::string frame_id;                  ///< the first that a header has
  std::vector<std::string> notes;        ///< what was left out or assumed, a sentence each
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

/// A table of these samples, in memory; its computed columns hold nothing yet.
std::unique_ptr<SampleTable> tableOf(const RecordedColumns& columns);

/// The same of samples without stamps.
///
/// @param time    N; s.
/// @param q       n x N, one sample per column; rad (prismatic m).
/// @param qd      n x N; rad/s (prismatic m/s).
/// @param effort  n x N; N m (prismatic N), or empty (0 x 0).
/// @throws EvaluationError: sizes differ; fewer than 2 samples; a number that isn't finite (joint
///         and sample are named).
std::unique_ptr<SampleTable> tableOf(const Eigen::Ref<const Eigen::VectorXd>& time,
                                     const Eigen::Ref<const Eigen::MatrixXd>& q,
                                     const Eigen::Ref<const Eigen::MatrixXd>& qd,
                                     const Eigen::Ref<const Eigen::MatrixXd>& effort);

/// From when to when; both ends belong to it.
struct TimeSpan {
  double from = -std::numeric_limits<double>::infinity();  ///< s since the first sample
  double to = std::numeric_limits<double>::infinity();     ///< s since the first sample
};

/// Which samples of a recording are read, and how texts name things.
struct RecordingOptions {
  std::vector<std::string> joints;  ///< n; their names there, in the order of the chain; none:
                                    ///< those of the first message
  Clock clock = Clock::kAuto;
  bool effort_required = true;           ///< else efforts may be absent, from all samples
  std::string joints_option = "joints";  ///< where a user gives the recording's joint names
  std::string scratch = {};              ///< directory for the table's files; empty: memory
  /// Other messages are left out, whatever they hold. Its times are those of the stamps, from the
  /// first message with any of the joints on.
  TimeSpan window = {};
};

/// Writes samples into a table by the rules at the top of this file.
class TableBuilder {
 public:
  /// @param where    file and topic, for error texts.
  /// @param options  their window and scratch aside.
  /// @param table    empty; must stay.
  /// @throws RecordingError: a name twice.
  TableBuilder(std::string where, const RecordingOptions& options, SampleTable& table);

  /// Adds a sample; false if it has none of the joints. @throws RecordingError by the rules.
  bool add(const JointSample& sample);

  /// Completes the table. @throws RecordingError: no sample with the joints.
  void finish(Clock clock);

 private:
  struct Field;

  bool matches(const JointSample& sample);
  void put(const Field& field, const JointSample& sample, const JointSample::Numbers& numbers,
           SampleTable::JointColumns& columns);
  [[noreturn]] void throwImpossible(const Field& field, const JointSample& sample, std::size_t j,
                                    double number) const;
  std::string place(const JointSample& sample) const;
  void requireSamples() const;

  std::string where_;
  bool effort_required_;
  std::string joints_option_;
  JointMatching matching_;
  SampleTable& table_;
  SampleTable::Recorded recorded_;
  std::vector<std::string> other_names_;            // of the first message left out
  Eigen::Index samples_ = 0, kept_ = 0;             // all that came; those with the joints
  bool header_stamped_ = false, received_ = false;  // any stamp that isn't zero
};

/// Progress callback with the share that is done, 0 to 1; throwing cancels. Optional.
using TellProgress = std::function<void(double)>;

/// Reads the samples of a recording into an empty table, in one pass.
///
/// @throws RecordingError: by the rules at the top of this file; no message in the window; they
///         don't fit into the table's directory.
void readTable(JointStateSource& source, const RecordingOptions& options, SampleTable& table,
               const TellProgress& progress = nullptr);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

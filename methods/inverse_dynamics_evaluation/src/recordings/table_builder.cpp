// SPDX-License-Identifier: Apache-2.0

/// @file
/// From joint states to rows of a table.

#include <algorithm>
#include <chain_dynamics/text.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "../figures.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/sample_table.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

using Eigen::Index;

// A field of messages.
struct TableBuilder::Field {
  const char* name;
  const char* reason;  // why it is needed
  bool required;
};

namespace {

constexpr Index kAtOnce = 4096;           // samples by which a table grows
constexpr std::size_t kLongestName = 60;  // characters of it in a message

std::vector<std::string> withoutRepeats(std::vector<std::string> joints) {
  if (std::set<std::string>(joints.begin(), joints.end()).size() != joints.size()) {
    throw RecordingError("joints: expected each name once, got " + listed(joints));
  }
  return joints;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// "; did you mean X?", of the names in a message that aren't those of other joints; or nothing. One
// or two letters are like any other.
std::string didYouMean(const std::string& missing, std::vector<std::string> names,
                       const std::vector<std::string>& joints) {
  constexpr std::size_t kShort = 2;
  names.erase(std::remove_if(names.begin(), names.end(),
                             [&](const std::string& name) { return contains(joints, name); }),
              names.end());
  const std::string nearest = chain_dynamics::nearestName(missing, names);
  if (missing.size() <= kShort || nearest.empty()) return "";
  return "; did you mean " + chain_dynamics::printable(nearest, kLongestName) + "?";
}

}  // namespace

TableBuilder::TableBuilder(std::string where, const RecordingOptions& options, SampleTable& table)
    : where_(std::move(where)),
      effort_required_(options.effort_required),
      joints_option_(options.joints_option),
      matching_(withoutRepeats(options.joints)),
      table_(table) {}

bool TableBuilder::add(const JointSample& sample) {
  ++samples_;
  if (!matches(sample)) return false;
  if (kept_ == 0) recorded_ = {sample.effort.size > 0, sample.acceleration.size > 0};
  if (kept_ == table_.size()) {
    table_.resize(static_cast<Index>(matching_.joints().size()), kept_ + kAtOnce, recorded_);
  }
  put({"position", "joint positions are needed", true}, sample, sample.position, table_.q);
  put({"velocity", "joint velocities are needed (accelerations come from them)", true}, sample,
      sample.velocity, table_.qd);
  put({"effort", "measured efforts are what computed torques are compared with",
       effort_required_ || recorded_.efforts},
      sample, sample.effort, table_.effort);
  put({"acceleration", "others before it have some", recorded_.accelerations}, sample,
      sample.acceleration, table_.qdd);
  table_.header_stamps[kept_] = sample.header_stamp;
  table_.receive_stamps[kept_] = sample.receive_stamp;
  header_stamped_ = header_stamped_ || sample.header_stamp != 0;
  received_ = received_ || sample.receive_stamp != 0;
  if (table_.frame_id.empty()) table_.frame_id = sample.frame_id;
  ++kept_;
  return true;
}

void TableBuilder::finish(Clock clock) {
  requireSamples();
  table_.joint_names = matching_.joints();
  if (kept_ < samples_) {
    table_.notes.push_back(std::to_string(samples_ - kept_) + " of " + std::to_string(samples_) +
                           " messages left out: they hold none of the joints, but " +
                           listed(other_names_));
  }
  if (clock == Clock::kAuto) {
    clock = Clock::kHeader;
    if (!header_stamped_ && received_) {
      clock = Clock::kReceive;
      table_.notes.emplace_back("no header has a stamp: the time of reception is used");
    }
  }
  table_.resize(table_.q.rows(), kept_, recorded_);
  table_.complete(clock);
}

void TableBuilder::requireSamples() const {
  if (kept_ > 0) return;
  if (samples_ == 0) {
    throw RecordingError(where_ +
                         ": expected joint states, got no message; was the robot's driver "
                         "running while it was recorded?");
  }
  throw RecordingError(where_ + ": expected the joints " + listed(matching_.joints()) +
                       ", got only " + listed(other_names_) + "; give the recording's names with " +
                       joints_option_ + ", in the order of the chain");
}

// Whether the sample is of the joints.
bool TableBuilder::matches(const JointSample& sample) {
  const std::vector<std::string>& names = *sample.names;
  if (matching_.joints().empty()) {
    if (names.empty()) {
      throw RecordingError(place(sample) + ": expected joint names, got none; record it again");
    }
    matching_ = JointMatching(names);
  }
  switch (matching_.match(names)) {
    case JointMatching::Found::kAll:
      return true;
    case JointMatching::Found::kNone:
      if (other_names_.empty()) other_names_ = names;
      return false;
    case JointMatching::Found::kMissing:
      throw RecordingError(place(sample) + ": expected the joints " + listed(matching_.joints()) +
                           ", got " + listed(names) + "; missing: " + listed(matching_.culprits()) +
                           "; give the recording's names with " + joints_option_ +
                           ", in the order of the chain" +
                           didYouMean(matching_.culprits().front(), names, matching_.joints()));
    case JointMatching::Found::kRepeated:
      throw RecordingError(
          place(sample) + ": expected each joint once, got " + listed(names) +
          "; repeated: " + listed(matching_.culprits()) +
          "; correct the driver that publishes it, or give a table with one column per joint");
  }
  return false;
}

// Copies the numbers of the joints, which must be there if they are required.
void TableBuilder::put(const Field& field, const JointSample& sample,
                       const JointSample::Numbers& numbers, SampleTable::JointColumns& columns) {
  const std::size_t names = sample.names->size();
  const bool late = kept_ > 0 && columns.size() == 0;  // absent from those before
  if (numbers.size == 0 && !field.required) return;
  if (numbers.size != names || late) {
    const std::string expected =
        late ? "none, as in those before it"
             : std::to_string(names) + (names == 1 ? " number" : " numbers") + ", one per name";
    const std::string got = numbers.size == 0 ? "an empty array" : std::to_string(numbers.size);
    throw RecordingError(place(sample) + ": " + field.name + ": expected " + expected + ", got " +
                         got + "; " + field.reason + ": does the driver publish them?");
  }
  double* to = columns.col(kept_).data();
  for (const std::size_t j : matching_.columns()) {
    const double number = numbers.data[j];
    if (!(std::abs(number) <= kLargestNumber)) throwImpossible(field, sample, j, number);
    *to++ = number;
  }
}

// A number of joint `j` of the message that isn't one of a motion.
void TableBuilder::throwImpossible(const Field& field, const JointSample& sample, std::size_t j,
                                   double number) const {
  const std::string what = place(sample) + ": " + field.name + " of joint " + (*sample.names)[j];
  if (!std::isfinite(number)) {
    throw RecordingError(what + ": expected a finite number, got " + formatted("%g", number) +
                         "; cut such messages out of the recording, or record it again");
  }
  throw RecordingError(what + ": expected a number of a motion, in SI units, of at most " +
                       formatted("%g", kLargestNumber) + ", got " + formatted("%g", number) +
                       "; is the recording damaged?");
}

// `recording: /joint_states, message 3`, counted from 1.
std::string TableBuilder::place(const JointSample& sample) const {
  const std::string message = where_ + ", message " + std::to_string(sample.message + 1);
  return sample.point < 0 ? message : message + ", point " + std::to_string(sample.point + 1);
}

namespace {

// The samples of a recording between two times.
class Window {
 public:
  Window(JointStateSource& source, const RecordingOptions& options)
      : span_(options.window), clock_(options.clock), where_(source.where()) {
    if (std::isfinite(span_.from) || std::isfinite(span_.to)) findStart(source, options.joints);
  }

  bool holds(const JointSample& sample) {
    if (!has_start_) return true;
    const double time = nanosecondsBetween(
        start_, clock_ == Clock::kReceive ? sample.receive_stamp : sample.header_stamp);
    least_ = std::min(least_, time);
    greatest_ = std::max(greatest_, time);
    const bool inside = std::round(1e9 * span_.from) <= time && time <= std::round(1e9 * span_.to);
    found_ = found_ || inside;
    return inside;
  }

  /// All samples were looked at. @throws RecordingError: none lies in the window.
  void requireAny() const {
    if (!has_start_ || found_) return;
    const auto seconds = [](double time) { return formatted("%.9g", time) + " s"; };
    std::string asked;
    if (std::isfinite(span_.from)) asked += " from " + seconds(span_.from);
    if (std::isfinite(span_.to)) asked += " to " + seconds(span_.to);
    throw RecordingError(where_ + ": expected samples" + asked +
                         " after the first one, got none: those of the recording go from " +
                         seconds(1e-9 * least_) + " to " + seconds(1e-9 * greatest_) +
                         "; choose --from and --to in between");
  }

 private:
  // The clock, and the stamp of the first sample: a recording without headers is read to its end.
  void findStart(JointStateSource& source, const std::vector<std::string>& joints) {
    JointMatching matching(joints);
    std::int64_t header = 0, receive = 0;
    bool stamped = false;
    JointSample sample;
    while (!(has_start_ && (stamped || clock_ != Clock::kAuto)) && source.next(sample)) {
      if (!joints.empty() && matching.match(*sample.names) == JointMatching::Found::kNone) continue;
      if (!std::exchange(has_start_, true)) {
        header = sample.header_stamp;
        receive = sample.receive_stamp;
      }
      stamped = stamped || sample.header_stamp != 0;
    }
    if (clock_ == Clock::kAuto) clock_ = stamped ? Clock::kHeader : Clock::kReceive;
    start_ = clock_ == Clock::kHeader ? header : receive;
    source.rewind();
  }

  TimeSpan span_;
  Clock clock_;
  std::string where_;
  bool has_start_ = false;           // else all samples are in the window
  std::int64_t start_ = 0;           // ns; stamp of the first sample
  bool found_ = false;               // a sample in the window
  double least_ = 0, greatest_ = 0;  // ns since the first sample
};

}  // namespace

void readTable(JointStateSource& source, const RecordingOptions& options, SampleTable& table,
               const TellProgress& progress) {
  TableBuilder builder(source.where(), options, table);
  Window window(source, options);
  const auto expected = std::max<std::int64_t>(source.expectedMessages(), 1);
  JointSample sample;
  while (source.next(sample)) {
    if (window.holds(sample)) builder.add(sample);
    const std::int64_t read = sample.message + 1;
    if (progress && read % kAtOnce == 0) {
      progress(std::min(static_cast<double>(read) / static_cast<double>(expected), 1.0));
    }
  }
  window.requireAny();
  if (const std::string note = source.note(); !note.empty()) table.notes.push_back(note);
  builder.finish(options.clock);
  if (progress) progress(1.0);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

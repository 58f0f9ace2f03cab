// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/joint_log.hpp"

#include <algorithm>
#include <chain_dynamics/text.hpp>
#include <cmath>
#include <set>
#include <sstream>
#include <utility>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

constexpr std::size_t kLongestName = 60;  // characters of it in a message

std::vector<std::string> withoutRepeats(std::vector<std::string> joints) {
  if (std::set<std::string>(joints.begin(), joints.end()).size() != joints.size()) {
    throw RecordingError("joints: expected each name once, got " + listed(joints));
  }
  return joints;
}

// "; did you mean X?", of the names in a message that aren't those of other joints; or nothing. One
// or two letters are like any other.
std::string didYouMean(const std::string& missing, std::vector<std::string> names,
                       const std::vector<std::string>& joints) {
  constexpr std::size_t kShort = 2;
  const auto taken = [&joints](const std::string& name) {
    return std::find(joints.begin(), joints.end(), name) != joints.end();
  };
  names.erase(std::remove_if(names.begin(), names.end(), taken), names.end());
  const std::string nearest = chain_dynamics::nearestName(missing, names);
  if (missing.size() <= kShort || nearest.empty()) return "";
  return "; did you mean " + chain_dynamics::printable(nearest, kLongestName) + "?";
}

// Whether a message has nothing but some of the joints: the others aren't misnamed.
bool isPart(const std::vector<std::string>& names, const std::vector<std::string>& joints) {
  return std::all_of(names.begin(), names.end(), [&joints](const std::string& name) {
    return std::find(joints.begin(), joints.end(), name) != joints.end();
  });
}

std::string numberText(double number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

// The stamps; their own memory is freed.
Stamps takenStamps(std::vector<std::int64_t>& stamps) {
  const auto given = std::exchange(stamps, {});
  using Numbers = Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>;
  return Eigen::Map<const Numbers>(given.data(), static_cast<Index>(given.size()));
}

}  // namespace

std::string name(Clock clock) {
  switch (clock) {
    case Clock::kAuto:
      return "auto";
    case Clock::kHeader:
      return "header";
    case Clock::kReceive:
      return "receive";
  }
  return "unknown";
}

double nanosecondsBetween(std::int64_t from, std::int64_t to) {
  const auto distance = [](std::int64_t less, std::int64_t more) {
    return static_cast<double>(static_cast<std::uint64_t>(more) - static_cast<std::uint64_t>(less));
  };
  return from <= to ? distance(from, to) : -distance(to, from);
}

OwnedVector secondsSince(
    std::int64_t from, const Eigen::Ref<const Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>>& to) {
  OwnedVector seconds(to.size());
  for (Index k = 0; k < to.size(); ++k) {
    seconds[k] = 1e-9 * nanosecondsBetween(from, to[k]);
  }
  return seconds;
}

OwnedVector JointLog::time() const { return secondsSince(stamps()[0], stamps()); }

JointLogBuilder::JointLogBuilder(std::string where, std::vector<std::string> joints,
                                 JointLogOptions options)
    : where_(std::move(where)),
      options_(std::move(options)),
      matching_(withoutRepeats(std::move(joints))),
      position_{"position", "joint positions are needed", {}, false},
      velocity_{
          "velocity", "joint velocities are needed (accelerations come from them)", {}, false},
      effort_{"effort", "measured efforts are what computed torques are compared with", {}, false},
      acceleration_{"acceleration", "others before it have some", {}, false} {}

void JointLogBuilder::add(const JointSample& sample) {
  ++samples_;
  if (!matches(sample)) {
    return;
  }
  append(position_, sample.position, sample, true);
  append(velocity_, sample.velocity, sample, true);
  append(effort_, sample.effort, sample, options_.effort_required || effort_.recorded);
  append(acceleration_, sample.acceleration, sample, acceleration_.recorded);
  if (isFirst()) {
    position_.recorded = velocity_.recorded = true;
    effort_.recorded = sample.effort.size() > 0;
    acceleration_.recorded = sample.acceleration.size() > 0;
  }
  noteStamps(sample.header_stamp, sample.receive_stamp);
  message_.push_back(sample.message);
  if (frame_id_.empty()) {
    frame_id_ = sample.frame_id;
  }
}

void JointLogBuilder::noteStamps(std::int64_t header, std::int64_t receive) {
  header_stamps_.push_back(header);
  receive_stamps_.push_back(receive);
  header_stamped_ = header_stamped_ || header != 0;
  receive_stamped_ = receive_stamped_ || receive != 0;
}

void JointLogBuilder::add(const JointStateBlock& block, std::size_t begin, std::size_t end) {
  if (addWhole(block, begin, end)) {
    return;
  }
  // sample by sample: to decide what is recorded, or to tell what is wrong
  using Numbers = JointSample::Numbers;
  const auto row = [](const JointStateNumbers& field, std::size_t i) {
    return Numbers(field.row(i), static_cast<Index>(field.columns));
  };
  for (std::size_t i = begin; i < end; ++i) {
    add(JointSample{block.joint_names, row(block.position, i), row(block.velocity, i),
                    row(block.effort, i), Numbers(nullptr, 0), block.header_stamps[i],
                    block.receive_stamps[i], static_cast<Index>(block.first) + Index(i), -1,
                    block.frame_id});
  }
}

// Adds messages in which nothing is wrong; false, and none of them added, if anything may be.
bool JointLogBuilder::addWhole(const JointStateBlock& block, std::size_t begin, std::size_t end) {
  const auto fits = [&](const Column& column, const JointStateNumbers& numbers) {
    return numbers.columns == (column.recorded ? block.joint_names.size() : 0);
  };
  if (isFirst() || matching_.match(block.joint_names) != JointMatching::Found::kAll ||
      !fits(position_, block.position) || !fits(velocity_, block.velocity) ||
      !fits(effort_, block.effort) || acceleration_.recorded ||
      !copy(position_, block.position, begin, end) ||
      !copy(velocity_, block.velocity, begin, end) || !copy(effort_, block.effort, begin, end)) {
    return false;
  }
  for (std::size_t i = begin; i < end; ++i) {
    noteStamps(block.header_stamps[i], block.receive_stamps[i]);
    message_.push_back(static_cast<Index>(block.first) + static_cast<Index>(i));
  }
  if (frame_id_.empty()) {
    frame_id_ = block.frame_id;
  }
  samples_ += static_cast<Index>(end - begin);
  return true;
}

// Copies the numbers of the joints behind those that were added; false if one isn't of a motion.
bool JointLogBuilder::copy(Column& column, const JointStateNumbers& numbers, std::size_t begin,
                           std::size_t end) {
  if (!column.recorded) {
    return true;
  }
  reserve(column, static_cast<Index>(end - begin));
  const std::vector<std::size_t>& from = matching_.columns();
  double* to = column.numbers.col(static_cast<Index>(message_.size())).data();
  bool possible = true;
  for (std::size_t i = begin; i < end; ++i) {
    const double* const row = numbers.row(i);
    for (const std::size_t j : from) {
      possible = possible && std::abs(row[j]) <= kLargestNumber;
      *to++ = row[j];
    }
  }
  return possible;
}

JointLog JointLogBuilder::takeSamples() {
  JointLog log;
  log.joint_names = matching_.joints();
  log.header_stamps = takenStamps(header_stamps_);
  log.receive_stamps = takenStamps(receive_stamps_);
  log.q = taken(position_);
  log.qd = taken(velocity_);
  log.effort = taken(effort_);
  log.qdd = taken(acceleration_);
  log.message = std::exchange(message_, {});
  taken_ += static_cast<Index>(log.message.size());
  return log;
}

JointLog JointLogBuilder::finish(Clock clock) {
  requireSamples();
  JointLog log = takeSamples();
  log.frame_id = std::exchange(frame_id_, {});
  const Index samples = std::exchange(samples_, 0);
  const std::vector<std::string> others = std::exchange(other_names_, {});
  const Index left_out = samples - std::exchange(taken_, 0);
  if (left_out > 0) {
    log.notes.push_back(std::to_string(left_out) + " of " + std::to_string(samples) +
                        " messages left out: they hold none of the joints, but " + listed(others));
  }
  for (Column* column : {&position_, &velocity_, &effort_, &acceleration_}) {
    column->recorded = false;
  }
  log.clock = clock;
  const bool no_header_stamp = !std::exchange(header_stamped_, false);
  const bool received = std::exchange(receive_stamped_, false);
  if (clock == Clock::kAuto) {
    log.clock = Clock::kHeader;
    if (no_header_stamp && received) {
      log.clock = Clock::kReceive;
      log.notes.emplace_back("no header has a stamp: the time of reception is used");
    }
  }
  return log;
}

void JointLogBuilder::requireSamples() const {
  if (!isFirst()) {
    return;
  }
  if (samples_ == 0) {
    throw RecordingError(where_ +
                         ": expected joint states, got no message; was the robot's driver "
                         "running while it was recorded?");
  }
  throw RecordingError(where_ + ": expected the joints " + listed(matching_.joints()) +
                       ", got only " + listed(other_names_) + "; give the recording's names with " +
                       options_.joints_option + ", in the order of the chain");
}

// Whether the sample is of the joints.
bool JointLogBuilder::matches(const JointSample& sample) {
  if (matching_.joints().empty()) {
    if (sample.names.empty()) {
      throw RecordingError(place(sample) + ": expected joint names, got none; record it again");
    }
    matching_ = JointMatching(sample.names);
  }
  switch (matching_.match(sample.names)) {
    case JointMatching::Found::kAll:
      return true;
    case JointMatching::Found::kNone:
      if (other_names_.empty()) {
        other_names_ = sample.names;
      }
      return false;
    case JointMatching::Found::kMissing:
      throw RecordingError(
          place(sample) + ": expected the joints " + listed(matching_.joints()) + ", got " +
          listed(sample.names) + "; missing: " + listed(matching_.culprits()) +
          (isPart(sample.names, matching_.joints())
               ? "; joints that arrive in several messages aren't merged: record a topic that has "
                 "all of "
                 "them in each message, as joint_state_publisher makes with source_list"
               : "; give the recording's names with " + options_.joints_option +
                     ", in the order of the chain" +
                     didYouMean(matching_.culprits().front(), sample.names, matching_.joints())));
    case JointMatching::Found::kRepeated:
      throw RecordingError(place(sample) + ": expected each joint once, got " +
                           listed(sample.names) + "; repeated: " + listed(matching_.culprits()) +
                           "; do two drivers publish on this topic?");
  }
  return false;
}

// Appends the numbers of the joints, which must be there if they are required.
void JointLogBuilder::append(Column& column, const JointSample::Numbers& numbers,
                             const JointSample& sample, bool required) {
  const auto names = static_cast<Index>(sample.names.size());
  const bool late = !isFirst() && !column.recorded;  // absent from those before
  if (numbers.size() == 0 && !required) {
    return;
  }
  if (numbers.size() != names || late) {
    const std::string expected =
        late ? "none, as in those before it"
             : std::to_string(names) + (names == 1 ? " number" : " numbers") + ", one per name";
    const std::string got = numbers.size() == 0 ? "an empty array" : std::to_string(numbers.size());
    throw RecordingError(place(sample) + ": " + column.field + ": expected " + expected + ", got " +
                         got + "; " + column.reason + ": does the driver publish them?");
  }
  reserve(column, 1);
  const auto count = static_cast<Index>(message_.size());
  for (std::size_t j = 0; j < matching_.columns().size(); ++j) {
    const double number = numbers[static_cast<Index>(matching_.columns()[j])];
    if (!std::isfinite(number)) {
      throw RecordingError(place(sample) + ": " + column.field + " of joint " +
                           matching_.joints()[j] + ": expected a finite number, got " +
                           numberText(number) +
                           "; cut such messages out of the recording, or record it again");
    }
    if (std::abs(number) > kLargestNumber) {
      throw RecordingError(
          place(sample) + ": " + column.field + " of joint " + matching_.joints()[j] +
          ": expected a number of a motion, in SI units, of at most " + numberText(kLargestNumber) +
          ", got " + numberText(number) + "; is the recording damaged?");
    }
    column.numbers(static_cast<Index>(j), count) = number;
  }
}

// `recording: /joint_states, message 3`, counted from 1.
std::string JointLogBuilder::place(const JointSample& sample) const {
  std::string text = where_ + ", message " + std::to_string(sample.message + 1);
  if (sample.point >= 0) {
    text += ", point " + std::to_string(sample.point + 1);
  }
  return text;
}

// Makes room: twice as much if it is full, by realloc, which copies no pages.
void JointLogBuilder::reserve(Column& column, Index more) const {
  const auto count = static_cast<Index>(message_.size());
  if (column.numbers.rows() == 0) {
    column.numbers.resize(static_cast<Index>(matching_.joints().size()), 0);
  }
  if (column.numbers.cols() < count + more) {
    column.numbers.conservativeResize(Eigen::NoChange,
                                      std::max<Index>({64, 2 * count, count + more}));
  }
}

// What was appended, in the same memory.
OwnedMatrix JointLogBuilder::taken(Column& column) const {
  if (column.numbers.size() != 0) {
    column.numbers.conservativeResize(Eigen::NoChange, static_cast<Index>(message_.size()));
  }
  return std::exchange(column.numbers, {});
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

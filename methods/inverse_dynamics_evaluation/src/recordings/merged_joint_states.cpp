// SPDX-License-Identifier: Apache-2.0

#include "merged_joint_states.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../figures.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/joint_matching.hpp"
#include "text.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

constexpr std::int64_t kLookedAt = 1000;  // first messages of each topic
constexpr double kBridged = 1.5;          // periods: two messages further apart have a gap between
constexpr double kSlower = 1.1;           // times the period of a stream that is no slower
constexpr std::array<const char*, 3> kFields = {"position", "velocity", "effort"};
constexpr std::int64_t kBeforeAll = std::numeric_limits<std::int64_t>::min();

std::array<JointSample::Numbers, 3> fieldsOf(const JointSample& sample) {
  return {sample.position, sample.velocity, sample.effort};
}

std::size_t columnOf(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

bool has(const std::vector<std::string>& names, const std::string& name) {
  return columnOf(names, name) < names.size();
}

// Joints as asked for, else all that there are.
std::vector<std::string> jointsOf(const std::vector<JointStream>& streams,
                                  const RecordingOptions& options) {
  std::vector<std::string> joints = options.joints;
  if (!joints.empty()) return joints;
  for (const JointStream& stream : streams) {
    for (const std::string& name : stream.names) {
      if (!has(joints, name)) joints.push_back(name);
    }
  }
  return joints;
}

// The header's stamps, unless a stream has none.
Clock clockOf(const std::vector<JointStream>& streams, Clock asked) {
  if (asked != Clock::kAuto) return asked;
  const bool stamped = std::all_of(streams.begin(), streams.end(), [](const JointStream& stream) {
    return std::any_of(stream.header_stamps.begin(), stream.header_stamps.end(),
                       [](std::int64_t stamp) { return stamp != 0; });
  });
  return stamped ? Clock::kHeader : Clock::kReceive;
}

// Median distance of the first messages [ns]; 0 of a single one.
double periodOf(const JointStream& stream, Clock clock) {
  const auto& stamps = clock == Clock::kReceive ? stream.receive_stamps : stream.header_stamps;
  std::vector<double> distances;
  for (std::size_t k = 1; k < stamps.size(); ++k) {
    distances.push_back(nanosecondsBetween(stamps[k - 1], stamps[k]));
  }
  if (distances.empty()) return 0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

// Where a number of a message goes: to the field of the joint.
struct Target {
  std::size_t field, column, joint;
};

// A stream, read up to the two messages around a time.
class Part {
 public:
  Part(JointStream stream, std::unique_ptr<JointStateSource> source, Clock clock,
       const std::vector<std::string>& joints)
      : stream_(std::move(stream)), source_(std::move(source)), clock_(clock) {
    for (std::size_t field = 0; field < kFields.size(); ++field) {
      for (std::size_t joint = 0; joint < joints.size(); ++joint) {
        const std::size_t column = columnOf(stream_.names, joints[joint]);
        if (!stream_.filled[field] || column == stream_.names.size()) continue;
        targets_.push_back({field, column, joint});
        if (!has(joints_, joints[joint])) joints_.push_back(joints[joint]);
      }
    }
  }

  /// Takes one message further; false after the last one. `sample` is the message.
  bool read(JointSample& sample) {
    do {
      if (!source_->next(sample)) return false;
    } while (!stream_.takes(sample));
    std::swap(before_, after_);
    after_.time = clock_ == Clock::kReceive ? sample.receive_stamp : sample.header_stamp;
    after_.numbers.clear();
    for (const Target& target : targets_) {
      after_.numbers.push_back(fieldsOf(sample)[target.field].data[target.column]);
    }
    first_ = std::min(first_, after_.time);
    last_ = std::max(last_, after_.time);
    return true;
  }

  /// Writes the numbers at a time into fields of n numbers; false if they aren't known.
  ///
  /// @param longest  ns; between two messages that have no gap in between.
  bool write(std::int64_t time, double longest, std::array<std::vector<double>, 3>& fields) {
    JointSample sample;
    while (after_.time < time && read(sample)) {
    }
    const double whole = nanosecondsBetween(before_.time, after_.time);
    const bool between = before_.time < time && time < after_.time && whole <= longest;
    if (after_.time != time && !between) return false;
    const double share = between ? nanosecondsBetween(before_.time, time) / whole : 1.0;
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      const double from = between ? before_.numbers[i] : after_.numbers[i], to = after_.numbers[i];
      // the nearer of two positions between which a driver has left out a turn
      const double part = std::abs(to - from) > M_PI ? std::round(share) : share;
      fields[targets_[i].field][targets_[i].joint] = from + part * (to - from);
    }
    return true;
  }

  void rewind() {
    source_->rewind();
    before_.time = after_.time = kBeforeAll;
  }

  /// Reads what is left, so that damage is noticed.
  void finish() {
    for (JointSample sample; read(sample);) {
    }
  }

  const std::string& topic() const { return stream_.topic; }
  const JointStateSource& source() const { return *source_; }
  std::int64_t time() const { return after_.time; }

  /// `position, velocity of joint_1, joint_2`.
  std::string content() const {
    std::vector<std::string> fields;
    for (std::size_t i = 0; i < kFields.size(); ++i) {
      if (stream_.filled[i]) fields.emplace_back(kFields[i]);
    }
    return listed(fields) + " of " + listed(joints_);
  }

  /// `/left from 1.5 s to 9.5 s`.
  std::string span() const {
    if (first_ > last_) return topic() + " without any";
    return topic() + " from " + formatted("%.9f", 1e-9 * static_cast<double>(first_)) + " s to " +
           formatted("%.9f", 1e-9 * static_cast<double>(last_)) + " s";
  }

 private:
  struct Row {
    std::int64_t time = kBeforeAll;
    std::vector<double> numbers;  // of each place
  };

  JointStream stream_;
  std::unique_ptr<JointStateSource> source_;
  Clock clock_;
  std::vector<Target> targets_;
  std::vector<std::string> joints_;  // that it has numbers of
  Row before_, after_;
  std::int64_t first_ = std::numeric_limits<std::int64_t>::max(), last_ = kBeforeAll;
};

class MergedJointStates : public JointStateSource {
 public:
  MergedJointStates(std::vector<JointStream> streams, const OpenTopic& open,
                    const RecordingOptions& options, const std::string& path)
      : clock_(clockOf(streams, options.clock)), joints_(jointsOf(streams, options)) {
    const auto slowest = std::max_element(
        streams.begin(), streams.end(), [&](const JointStream& a, const JointStream& b) {
          return periodOf(b, clock_) > kSlower * periodOf(a, clock_);
        });
    std::rotate(streams.begin(), slowest, slowest + 1);
    longest_ = kBridged * periodOf(streams.front(), clock_);
    for (JointStream& stream : streams) {
      where_ += (where_.empty() ? path + ": " : "+") + stream.topic;
      for (std::size_t i = 0; i < kFields.size(); ++i) {
        if (stream.filled[i]) fields_[i].resize(joints_.size());
      }
      auto source = open(stream.topic);
      parts_.emplace_back(std::move(stream), std::move(source), clock_, joints_);
    }
  }

  bool next(JointSample& sample) override {
    while (parts_.front().read(sample)) {
      ++read_;
      const bool known = std::all_of(parts_.begin(), parts_.end(), [&](Part& part) {
        return part.write(parts_.front().time(), longest_, fields_);
      });
      if (!known) continue;
      ++known_;
      sample.names = &joints_;
      JointSample::Numbers* const to[] = {&sample.position, &sample.velocity, &sample.effort};
      for (std::size_t i = 0; i < kFields.size(); ++i)
        *to[i] = {fields_[i].data(), fields_[i].size()};
      return true;
    }
    for (Part& part : parts_) part.finish();
    if (known_ == 0) throwNeverTogether();
    return false;
  }

  void rewind() override {
    for (Part& part : parts_) part.rewind();
    read_ = known_ = 0;
  }

  std::int64_t expectedMessages() const override {
    return parts_.front().source().expectedMessages();
  }
  std::string where() const override { return where_; }

  std::string note() const override {
    std::string text = parts_.front().source().note();
    text += (text.empty() ? "" : "; ") + std::string("joint states are merged:");
    for (const Part& part : parts_) {
      text += (&part == &parts_.front() ? " " : "; ") + part.content() + " from " + part.topic() +
              (&part == &parts_.front() ? ", at its times"
                                        : ", on straight lines between its messages");
    }
    if (known_ == read_) return text;
    return text + "; " + std::to_string(read_ - known_) + " of " + counted(read_, "message") +
           " of " + parts_.front().topic() +
           " left out, at whose times others have a gap of more than " +
           formatted("%.3g", 1e-9 * longest_) + " s";
  }

 private:
  [[noreturn]] void throwNeverTogether() const {
    std::string spans;
    for (const Part& part : parts_) spans += (spans.empty() ? "" : ", ") + part.span();
    throw RecordingError(
        where_ +
        ": expected messages at the same times, got none between two messages of the "
        "others that are no more than " +
        formatted("%.3g", 1e-9 * longest_) + " s apart, by the stamps of " + name(clock_) + ": " +
        spans + "; try the other stamps with --clock, or name one topic with --topic");
  }

  Clock clock_;
  std::vector<std::string> joints_;
  std::vector<Part> parts_;  // the slowest first
  std::string where_;
  double longest_ = 0;  // ns; between two messages that have no gap in between
  std::array<std::vector<double>, 3> fields_;
  std::int64_t read_ = 0, known_ = 0;  // messages of the slowest stream
};

}  // namespace

bool JointStream::takes(const JointSample& sample) const {
  const auto fields = fieldsOf(sample);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (filled[i] != (fields[i].size > 0 && fields[i].size == names.size())) return false;
  }
  return *sample.names == names;
}

std::vector<JointStream> streamsOf(const std::vector<std::string>& topics, const OpenTopic& open) {
  std::vector<JointStream> streams;
  for (const std::string& topic : topics) {
    const auto source = open(topic);
    JointSample sample;
    for (std::int64_t k = 0; k < kLookedAt && source->next(sample); ++k) {
      auto stream = std::find_if(streams.begin(), streams.end(), [&](const JointStream& known) {
        return known.topic == topic && known.takes(sample);
      });
      if (stream == streams.end()) {
        JointStream made{topic, *sample.names, {}, {}, {}};
        const auto fields = fieldsOf(sample);
        for (std::size_t i = 0; i < fields.size(); ++i) {
          made.filled[i] = fields[i].size > 0 && fields[i].size == made.names.size();
        }
        stream = streams.insert(streams.end(), std::move(made));
      }
      stream->header_stamps.push_back(sample.header_stamp);
      stream->receive_stamps.push_back(sample.receive_stamp);
    }
  }
  return streams;
}

Complementary complementary(const std::vector<JointStream>& streams,
                            const RecordingOptions& options, const std::string& path) {
  Complementary found;
  std::vector<bool> gives(streams.size());
  for (std::size_t field = 0; field < kFields.size(); ++field) {
    const bool needed = field < 2 || options.effort_required;
    for (const std::string& joint : jointsOf(streams, options)) {
      std::vector<std::size_t> owners;
      for (std::size_t i = 0; i < streams.size(); ++i) {
        if (streams[i].filled[field] && has(streams[i].names, joint)) owners.push_back(i);
      }
      if (owners.empty() && needed) found.missing = kFields[field] + (" of " + joint);
      for (const std::size_t owner : owners) gives[owner] = true;
      if (owners.size() < 2) continue;
      const std::string &one = streams[owners[0]].topic, &other = streams[owners[1]].topic;
      found.missing = kFields[field] + (" of " + joint) + " in only one kind of messages";
      if (one == other) continue;  // two drivers
      throw RecordingError(path + ": expected " + kFields[field] + " of " + joint +
                           " on one topic, got it on " + one + " and on " + other +
                           "; name the topics to take with --topic, joined by +");
    }
  }
  for (std::size_t i = 0; i < streams.size(); ++i) {
    if (gives[i]) found.streams.push_back(streams[i]);
  }
  return found;
}

bool Complementary::has(const std::string& topic) const {
  return std::any_of(streams.begin(), streams.end(),
                     [&](const JointStream& stream) { return stream.topic == topic; });
}

std::unique_ptr<JointStateSource> merged(std::vector<JointStream> streams, const OpenTopic& open,
                                         const RecordingOptions& options, const std::string& path) {
  return std::make_unique<MergedJointStates>(std::move(streams), open, options, path);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

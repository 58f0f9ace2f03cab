// SPDX-License-Identifier: Apache-2.0

/// @file
/// From the files of a recording to rows of a table.

#include "joint_states.hpp"

#include <algorithm>
#include <chain_dynamics/text.hpp>
#include <cmath>
#include <cstring>
#include <set>
#include <utility>

#include "../figures.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/sample_table.hpp"
#include "recording_content.hpp"
#include "unpack.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

// ---------------------------------------------------------------------------------------------
// Messages

// Messages of a topic, file by file: as many as the recording states. No topic: of all, any number.
class Messages : public MessageSource {
 public:
  Messages(std::shared_ptr<const RecordingContent> content, std::string topic)
      : content_(std::move(content)),
        topic_(std::move(topic)),
        where_(content_->path + ": " + topic_) {
    for (const Connection& connection : content_->connections) {
      if (!isWanted(connection)) continue;
      expected_ += connection.messages;
      if (connection.serialization == "cdr") continue;
      throw RecordingError(
          content_->path + ": topic " + chain_dynamics::printable(connection.topic, 60) +
          ": serialization: expected cdr, got " + quoted(connection.serialization) +
          "; was the recording edited? Copy or record it again");
    }
  }

  bool next(Message& message) override {
    const bool found = readable(content_->path, [&] { return nextOfFiles(message); });
    if (!topic_.empty()) check(found, message.received);
    return found;
  }

  void rewind() override {
    reader_.reset();
    file_ = 0;
    done_ = 0;
  }

 private:
  bool nextOfFiles(Message& message) {
    while (reader_ != nullptr || file_ < content_->files.size()) {
      if (reader_ == nullptr) openNextFile();
      if (reader_->next(message)) {
        if (content_->compression == Compression::kMessages && message.data != nullptr) {
          zstd_.unpack(message.data, message.size, "a message or chunk", unpacked_);
          message.data = unpacked_.data();
          message.size = unpacked_.size();
        }
        return true;
      }
      reader_.reset();
    }
    return false;
  }

  void openNextFile() {
    reader_ = content_->open(content_->files[file_++]);
    std::vector<bool> wanted;
    for (const Connection& there : reader_->connections()) {
      wanted.push_back(isWanted(there) && there.serialization == "cdr" && isOfRecording(there));
    }
    reader_->select(wanted);
  }

  bool isWanted(const Connection& connection) const {
    return topic_.empty() || connection.topic == topic_;
  }

  // Whether the recording states a connection of a file.
  bool isOfRecording(const Connection& there) const {
    return std::any_of(content_->connections.begin(), content_->connections.end(),
                       [&](const Connection& stated) {
                         return stated.topic == there.topic && stated.type == there.type;
                       });
  }

  // As many messages as the recording states, received within the years 1970 to 2116.
  void check(bool found, std::int64_t received) {
    if (found ? ++done_ > expected_ : done_ != expected_) {
      throw RecordingError(
          where_ + ": expected " + counted(expected_, "message") + ", as its metadata say, got " +
          (found ? "more: they belong to another recording; run `ros2 bag reindex` on it"
                 : std::to_string(done_) + ": the file is cut off; copy or record it again"));
    }
    if (found && (received < 0 || received > kLatestReception)) {
      throw RecordingError(where_ + ", message " + std::to_string(done_) +
                           ": time of reception: expected 0 to 4.6e+18 ns, got " +
                           std::to_string(received) +
                           "; was the recording edited? Record it again");
    }
  }

  std::shared_ptr<const RecordingContent> content_;
  std::string topic_, where_;
  std::int64_t expected_ = 0, done_ = 0;  // messages
  std::size_t file_ = 0;                  // number of the next one
  std::unique_ptr<StorageReader> reader_;
  ZstdUnpacker zstd_;
  Bytes unpacked_;
};

}  // namespace

std::unique_ptr<MessageSource> messagesOf(std::shared_ptr<const RecordingContent> content,
                                          const std::string& topic) {
  return std::make_unique<Messages>(std::move(content), topic);
}

namespace {

// ---------------------------------------------------------------------------------------------
// Decoding

// Fields of a message, in either order of bytes.
class CdrFields {
 public:
  CdrFields(const std::uint8_t* message, std::size_t size, bool little_endian)
      : message_(message), size_(size), little_endian_(little_endian) {}

  std::size_t offset() const { return at_; }

  std::uint32_t number() {
    at_ = cdrAligned(at_, 4);
    require(4);
    std::uint8_t bytes[4];
    std::copy_n(message_ + at_, 4, bytes);
    if (!little_endian_) std::reverse(bytes, bytes + 4);
    at_ += 4;
    return littleEndian<std::uint32_t>(bytes);
  }

  std::string string() {
    const std::size_t length = number();
    require(length);
    if (length == 0 || message_[at_ + length - 1] != 0) {
      throw DamageError("a string at offset " + std::to_string(at_) + " has no closing zero");
    }
    std::string text(reinterpret_cast<const char*>(message_ + at_), length - 1);
    requireUtf8(text, "a string");
    at_ += length;
    return text;
  }

  CdrArray array() {
    const std::size_t count = number();
    if (count == 0) return {at_, 0};
    at_ = cdrAligned(at_, 8);
    require(8 * count);
    const std::size_t begin = at_;
    at_ += 8 * count;
    return {begin, count};
  }

  /// @throws DamageError: fewer bytes are left.
  void require(std::size_t bytes) const {
    if (at_ > size_ || bytes > size_ - at_) {
      throw DamageError("expected " + std::to_string(bytes) + " bytes at offset " +
                        std::to_string(at_) + ", got a message of " + std::to_string(size_));
    }
  }

 private:
  const std::uint8_t* message_;
  std::size_t size_;
  bool little_endian_;
  std::size_t at_ = kCdrEncapsulation;
};

std::int64_t stampOf(const std::uint8_t* message, bool little_endian) {
  std::uint8_t bytes[8];
  std::copy_n(message + kCdrStamp, 8, bytes);
  if (!little_endian) {
    std::reverse(bytes, bytes + 4);
    std::reverse(bytes + 4, bytes + 8);
  }
  const std::int64_t seconds = littleEndian<std::int32_t>(bytes);
  return seconds * kSecond + littleEndian<std::uint32_t>(bytes + 4);
}

}  // namespace

JointStateLayout layoutOf(const std::uint8_t* message, std::size_t size) {
  constexpr std::size_t kPaddingAtEnd = 3;  // bytes, at most
  if (size < kCdrEncapsulation || message[0] != 0 || message[1] > 1) {
    throw DamageError("it doesn't begin with the encapsulation of plain CDR");
  }
  JointStateLayout layout;
  layout.little_endian = message[1] == 1;
  CdrFields fields(message, size, layout.little_endian);
  fields.number();  // sec
  fields.number();  // nanosec
  layout.frame_id = fields.string();
  const std::size_t names = fields.number();
  fields.require(5 * names);  // a length and a closing zero each
  for (std::size_t i = 0; i < names; ++i) layout.names.push_back(fields.string());
  for (CdrArray& array : layout.arrays) array = fields.array();
  if (size > fields.offset() + kPaddingAtEnd) {
    throw DamageError("expected " + std::to_string(fields.offset()) + " bytes, got " +
                      std::to_string(size));
  }
  return layout;
}

JointSample JointStateDecoder::decode(const std::uint8_t* message, std::size_t size) {
  if (!repeatsLast(message, size)) {
    layout_ = layoutOf(message, size);
    size_ = size;
    head_.clear();
    if (layout_.little_endian) head_.assign(message, message + layout_.arrays[0].offset);
    numbers_.resize(layout_.arrays[0].count + layout_.arrays[1].count + layout_.arrays[2].count);
  }
  JointSample sample;
  sample.names = &layout_.names;
  sample.frame_id = layout_.frame_id;
  sample.header_stamp = stampOf(message, layout_.little_endian);
  double* numbers = numbers_.data();
  JointSample::Numbers* const fields[] = {&sample.position, &sample.velocity, &sample.effort};
  for (std::size_t i = 0; i < layout_.arrays.size(); ++i) {
    const auto [offset, count] = layout_.arrays[i];
    if (count > 0) std::memcpy(numbers, message + offset, 8 * count);
    *fields[i] = {numbers, count};
    numbers += count;
  }
  if (!layout_.little_endian) {
    auto* const bytes = reinterpret_cast<std::uint8_t*>(numbers_.data());
    for (std::size_t i = 0; i < numbers_.size(); ++i)
      std::reverse(bytes + 8 * i, bytes + 8 * i + 8);
  }
  return sample;
}

// Padding may make messages of one layout differ: those are taken apart.
bool JointStateDecoder::repeatsLast(const std::uint8_t* message, std::size_t size) const {
  if (size != size_ || head_.empty() || message[0] != 0 || message[1] != 1 ||
      std::memcmp(message + kCdrFrame, head_.data() + kCdrFrame, head_.size() - kCdrFrame) != 0) {
    return false;
  }
  for (std::size_t i = 1; i < layout_.arrays.size(); ++i) {
    const CdrArray& before = layout_.arrays[i - 1];
    const std::size_t at = before.offset + 8 * before.count;
    if (littleEndian<std::uint32_t>(message + at) != layout_.arrays[i].count) return false;
  }
  return true;
}

namespace {

class JointStates : public JointStateSource {
 public:
  JointStates(std::unique_ptr<MessageSource> messages, std::string where, std::int64_t expected)
      : messages_(std::move(messages)), where_(std::move(where)), expected_(expected) {}

  bool next(JointSample& sample) override {
    Message message;
    if (!messages_->next(message)) return false;
    try {
      if (message.data == nullptr && message.size == 0) throw DamageError("it holds no bytes");
      sample = decoder_.decode(message.data, message.size);
    } catch (const DamageError& error) {
      throw RecordingError(where_ + ", message " + std::to_string(done_ + 1) +
                           ": can't be decoded as " + kJointState + " (" +
                           chain_dynamics::printable(error.what(), 300) +
                           "): the recording is damaged; copy or record it again");
    }
    sample.receive_stamp = message.received;
    sample.message = done_++;
    return true;
  }

  void rewind() override {
    messages_->rewind();
    done_ = 0;
  }

  std::int64_t expectedMessages() const override { return expected_; }
  std::string where() const override { return where_; }

 private:
  std::unique_ptr<MessageSource> messages_;
  std::string where_;
  std::int64_t expected_, done_ = 0;
  JointStateDecoder decoder_;
};

}  // namespace

std::unique_ptr<JointStateSource> jointStatesOf(std::unique_ptr<MessageSource> messages,
                                                std::string where, std::int64_t expected) {
  return std::make_unique<JointStates>(std::move(messages), std::move(where), expected);
}

// ---------------------------------------------------------------------------------------------
// Writing into a table

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

// What can be done where a message lacks joints: `names` are its own.
std::string remedyOf(const JointMatching& matching, const std::vector<std::string>& names,
                     const std::string& option) {
  const bool is_part = std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    return contains(matching.joints(), name);
  });
  if (is_part) {
    return "joints that arrive in several messages aren't merged: record a topic that has all of "
           "them in each message, as joint_state_publisher makes with source_list";
  }
  return "give the recording's names with " + option + ", in the order of the chain" +
         didYouMean(matching.culprits().front(), names, matching.joints());
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
                           "; " + remedyOf(matching_, names, joints_option_));
    case JointMatching::Found::kRepeated:
      throw RecordingError(place(sample) + ": expected each joint once, got " + listed(names) +
                           "; repeated: " + listed(matching_.culprits()) +
                           "; do two drivers publish on this topic?");
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
  builder.finish(options.clock);
  if (progress) progress(1.0);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

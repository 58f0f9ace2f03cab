// SPDX-License-Identifier: Apache-2.0

#include "joint_state_cdr.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using inverse_dynamics_evaluation::JointStateNumbers;

constexpr std::size_t kEncapsulation = 4;  // bytes, from which alignment is counted
constexpr std::size_t kStamp = 4;          // offset of sec and nanosec
constexpr std::size_t kFrame = 12;         // offset of the frame's length
constexpr std::size_t kPaddingAtEnd = 3;   // bytes, at most
constexpr std::size_t kMessages = 4096;    // of a block, at most
constexpr std::size_t kNumbers = 1 << 18;  // of a field of a block, but for a single message
constexpr std::int64_t kSecond = 1'000'000'000;

std::size_t aligned(std::size_t offset, std::size_t size) {
  return kEncapsulation + (offset - kEncapsulation + size - 1) / size * size;
}

// Fields of a message, in either order of bytes.
class CdrFields {
 public:
  CdrFields(const std::uint8_t* message, std::size_t size, bool little_endian)
      : message_(message), size_(size), little_endian_(little_endian) {}

  std::size_t offset() const { return at_; }

  std::uint32_t number() {
    at_ = aligned(at_, 4);
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
    at_ = aligned(at_, 8);
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
  std::size_t at_ = kEncapsulation;
};

std::array<JointStateNumbers*, 3> fieldsOf(JointStateBlock& block) {
  return {&block.position, &block.velocity, &block.effort};
}

// Numbers of an array of a message, appended.
void appendNumbers(const std::uint8_t* from, std::size_t count, bool little_endian,
                   std::vector<double>& to) {
  if (count == 0) return;
  const std::size_t before = to.size();
  to.resize(before + count);
  auto* const bytes = reinterpret_cast<std::uint8_t*>(to.data() + before);
  std::memcpy(bytes, from, 8 * count);
  if (!little_endian) {
    for (std::size_t i = 0; i < count; ++i) std::reverse(bytes + 8 * i, bytes + 8 * i + 8);
  }
}

std::int64_t stampOf(const std::uint8_t* message, bool little_endian) {
  std::uint8_t bytes[8];
  std::copy_n(message + kStamp, 8, bytes);
  if (!little_endian) {
    std::reverse(bytes, bytes + 4);
    std::reverse(bytes + 4, bytes + 8);
  }
  const std::int64_t seconds = littleEndian<std::int32_t>(bytes);
  return seconds * kSecond + littleEndian<std::uint32_t>(bytes + 4);
}

}  // namespace

bool JointStateLayout::isLike(const JointStateLayout& other) const {
  return frame_id == other.frame_id && names == other.names &&
         std::equal(arrays.begin(), arrays.end(), other.arrays.begin(),
                    [](const CdrArray& a, const CdrArray& b) { return a.count == b.count; });
}

JointStateLayout layoutOf(const std::uint8_t* message, std::size_t size) {
  if (size < kEncapsulation || message[0] != 0 || message[1] > 1) {
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

bool JointStateDecoder::add(const std::uint8_t* message, std::size_t size, std::int64_t received,
                            JointStateBlock& block) {
  if (!repeatsLast(message, size)) {
    JointStateLayout layout = layoutOf(message, size);
    if (block.size() > 0 && !layout.isLike(layout_)) return false;
    remember(message, size, std::move(layout));
  }
  if (block.size() == 0) begin(block);
  std::size_t columns = 1;
  for (const CdrArray& array : layout_.arrays) columns = std::max(columns, array.count);
  if (block.size() >= std::min(kMessages, std::max<std::size_t>(1, kNumbers / columns))) {
    return false;
  }
  append(message, received, block);
  return true;
}

// Padding may make messages of one layout differ: those are taken apart.
bool JointStateDecoder::repeatsLast(const std::uint8_t* message, std::size_t size) const {
  if (size != size_ || head_.empty() || message[0] != 0 || message[1] != 1 ||
      std::memcmp(message + kFrame, head_.data() + kFrame, head_.size() - kFrame) != 0) {
    return false;
  }
  for (std::size_t i = 1; i < layout_.arrays.size(); ++i) {
    const CdrArray& before = layout_.arrays[i - 1];
    const std::size_t at = before.offset + 8 * before.count;
    if (littleEndian<std::uint32_t>(message + at) != layout_.arrays[i].count) return false;
  }
  return true;
}

void JointStateDecoder::remember(const std::uint8_t* message, std::size_t size,
                                 JointStateLayout layout) {
  layout_ = std::move(layout);
  size_ = size;
  head_.clear();
  if (layout_.little_endian) head_.assign(message, message + layout_.arrays[0].offset);
}

void JointStateDecoder::begin(JointStateBlock& block) const {
  block.joint_names = layout_.names;
  block.frame_id = layout_.frame_id;
  for (std::size_t i = 0; i < 3; ++i) fieldsOf(block)[i]->columns = layout_.arrays[i].count;
}

void JointStateDecoder::append(const std::uint8_t* message, std::int64_t received,
                               JointStateBlock& block) const {
  block.receive_stamps.push_back(received);
  block.header_stamps.push_back(stampOf(message, layout_.little_endian));
  const auto fields = fieldsOf(block);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    appendNumbers(message + layout_.arrays[i].offset, layout_.arrays[i].count,
                  layout_.little_endian, fields[i]->values);
  }
}

JointStateEncoder::JointStateEncoder(const std::vector<std::string>& names,
                                     const std::string& frame_id,
                                     const std::array<std::size_t, 3>& columns) {
  template_ = {0, 1, 0, 0};
  template_.resize(kFrame);
  const auto put_string = [this](const std::string& text) {
    template_.resize(aligned(template_.size(), 4));
    putNumber(template_, static_cast<std::uint32_t>(text.size() + 1));
    template_.insert(template_.end(), text.begin(), text.end());
    template_.push_back(0);
  };
  put_string(frame_id);
  template_.resize(aligned(template_.size(), 4));
  putNumber(template_, static_cast<std::uint32_t>(names.size()));
  for (const std::string& name : names) put_string(name);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    template_.resize(aligned(template_.size(), 4));
    putNumber(template_, static_cast<std::uint32_t>(columns[i]));
    if (columns[i] > 0) template_.resize(aligned(template_.size(), 8));
    arrays_[i] = {template_.size(), columns[i]};
    template_.resize(template_.size() + 8 * columns[i]);
  }
}

bool JointStateEncoder::fits(const std::array<const double*, 3>& numbers) const {
  return std::equal(arrays_.begin(), arrays_.end(), numbers.begin(),
                    [](const CdrArray& array, const double* from) {
                      return array.count == 0 || from != nullptr;
                    });
}

void JointStateEncoder::write(std::int64_t stamp, const std::array<const double*, 3>& numbers,
                              std::uint8_t* out) const {
  std::memcpy(out, template_.data(), template_.size());
  const bool before_zero = stamp % kSecond < 0;
  const auto sec = static_cast<std::uint32_t>(stamp / kSecond - (before_zero ? 1 : 0));
  const auto nanosec = static_cast<std::uint32_t>(stamp % kSecond + (before_zero ? kSecond : 0));
  std::memcpy(out + kStamp, &sec, 4);
  std::memcpy(out + kStamp + 4, &nanosec, 4);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (arrays_[i].count > 0) {
      std::memcpy(out + arrays_[i].offset, numbers[i], 8 * arrays_[i].count);
    }
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

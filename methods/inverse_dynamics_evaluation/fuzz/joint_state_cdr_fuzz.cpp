// SPDX-License-Identifier: Apache-2.0

/// @file
/// Any bytes as serialized joint states, one after another: each is read as it is by itself, what is
/// read is written and read again without a change, and the rest is refused.
///
/// A message of the input follows its size (2 bytes); the last one may be shorter.

#include <algorithm>
#include <climits>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "checks.hpp"
#include "joint_state_decoder.hpp"
#include "joint_state_encoder.hpp"

namespace inverse_dynamics_evaluation::fuzz {
namespace {

// Memory of just its size, so that reading beyond it is seen.
std::vector<Bytes> messagesOf(const std::uint8_t* data, std::size_t size) {
  std::vector<Bytes> messages;
  for (const std::uint8_t* const end = data + size; end - data >= 2;) {
    const std::size_t stated = littleEndian<std::uint16_t>(data);
    data += 2;
    const std::size_t there = std::min<std::size_t>(stated, end - data);
    messages.emplace_back(data, data + there);
    data += there;
  }
  return messages;
}

// The message as a block; none: it was refused.
std::optional<JointStateBlock> read(JointStateDecoder& decoder, const Bytes& message) {
  JointStateBlock block;
  try {
    block.add(decoder.decode(message.data(), message.size()));
  } catch (const DamageError& error) {
    requireText(error.what(), "");
    require(*error.what() != '\0', "an error without a text");
    return std::nullopt;
  }
  return block;
}

const double* numbersOf(const JointStateNumbers& field) {
  return field.columns == 0 ? nullptr : field.values.data();
}

void requireRoundTrip(const JointStateBlock& block) {
  const std::int64_t stamp = block.header_stamps[0];
  // A message may state more than a second of nanoseconds.
  if (stamp >= (std::int64_t{INT_MAX} + 1) * kSecond) return;
  const JointStateEncoder encoder(
      block.joint_names, block.frame_id,
      {block.position.columns, block.velocity.columns, block.effort.columns});
  Bytes message(encoder.size());
  encoder.write(stamp,
                {numbersOf(block.position), numbersOf(block.velocity), numbersOf(block.effort)},
                message.data());
  JointStateDecoder decoder;
  const auto again = read(decoder, message);
  require(again && isSame(*again, block), "a message written and read again");
}

Seeds seeds() {
  Seeds made;
  const double numbers[] = {0.5, -1.5};
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{}, {"a"}, {"joint_1", "bcd"}}) {
    const JointStateEncoder encoder(names, "base", {names.size(), names.size(), names.size()});
    Bytes sequence;
    for (const std::int64_t stamp : {1'500'000'000, -1}) {
      Bytes message(encoder.size() + (stamp < 0 ? 8 : 0));  // some end in bytes of no meaning
      encoder.write(stamp, {numbers, numbers, numbers}, message.data());
      putNumber(sequence, static_cast<std::uint16_t>(message.size()));
      sequence.insert(sequence.end(), message.begin(), message.end());
    }
    made.push_back(sequence);
    sequence[3] = 0;  // the other order of bytes: refused until more is changed
    made.push_back(sequence);
  }
  return made;
}

}  // namespace
}  // namespace inverse_dynamics_evaluation::fuzz

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  using namespace inverse_dynamics_evaluation::fuzz;
  writeSeedsIfAsked(*argc, *argv, &seeds);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace inverse_dynamics_evaluation;
  JointStateDecoder decoder;  // compares each message with the one before
  for (const Bytes& message : fuzz::messagesOf(data, size)) {
    JointStateDecoder fresh;
    const auto expected = fuzz::read(fresh, message);
    const auto got = fuzz::read(decoder, message);
    fuzz::require(expected.has_value() == got.has_value(), "a message after another is refused");
    if (!expected) continue;
    fuzz::require(fuzz::isSame(*expected, *got), "a message after another reads differently");
    fuzz::requireRoundTrip(*expected);
  }
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Records of MCAP files [https://mcap.dev/spec].
///
/// A record is its kind (1 byte), the size of its content (8 bytes), and the content. Numbers have
/// their least byte first; texts and lists begin with their size in bytes (4 bytes).
#pragma once

#include <cstdint>
#include <string>

#include "bytes.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// At the beginning and at the end of a file.
inline constexpr std::uint8_t kMcapMagic[] = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

inline constexpr std::uint64_t kMcapRecordHead = 1 + 8;
inline constexpr std::uint64_t kMcapFooterSize = 8 + 8 + 4;
inline constexpr std::uint64_t kMcapMessageHead = 2 + 4 + 8 + 8;

enum McapRecord : std::uint8_t {
  kMcapHeader = 0x01,
  kMcapFooter = 0x02,
  kMcapSchema = 0x03,
  kMcapChannel = 0x04,
  kMcapMessage = 0x05,
  kMcapChunk = 0x06,
  kMcapMessageIndex = 0x07,
  kMcapChunkIndex = 0x08,
  kMcapStatistics = 0x0b,
  kMcapMetadata = 0x0c,
  kMcapMetadataIndex = 0x0d,
  kMcapSummaryOffset = 0x0e,
  kMcapDataEnd = 0x0f,
};

/// Appends a text.
inline void putString(Bytes& out, const std::string& text) {
  putNumber(out, static_cast<std::uint32_t>(text.size()));
  out.insert(out.end(), text.begin(), text.end());
}

/// Appends a record.
inline void putRecord(Bytes& out, McapRecord kind, const Bytes& content) {
  out.push_back(kind);
  putNumber(out, std::uint64_t{content.size()});
  out.insert(out.end(), content.begin(), content.end());
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

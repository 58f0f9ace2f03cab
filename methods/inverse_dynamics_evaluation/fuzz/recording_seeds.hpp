// SPDX-License-Identifier: Apache-2.0

/// @file
/// Small recordings that the project's own writer makes, in every form that is read.

#pragma once

#include <cstdint>
#include <string>

#include "checks.hpp"

namespace inverse_dynamics_evaluation::fuzz {

/// What a fuzzed file is a part of; the first byte of an input says it.
enum class Part : std::uint8_t {
  kDatabase,
  kMcapFile,
  kMetadata,            ///< metadata.yaml beside an intact MCAP file
  kCompressedFile,      ///< a zstd file beside an intact metadata.yaml
  kCompressedMessages,  ///< an MCAP file of compressed messages beside an intact metadata.yaml
};
inline constexpr int kParts = 5;

/// The names of the files of recordings in a directory `bag`.
inline constexpr char kMcapName[] = "bag.mcap";
inline constexpr char kPackedName[] = "bag.mcap.zstd";

/// Messages of two joints on the topics `/joint_states` and `/other`.
std::string mcapFile();

/// metadata.yaml of it; compression: `FILE`, `MESSAGE` or none.
std::string metadataOf(const std::string& compression);

/// Inputs of the target.
Seeds recordingSeeds();

}  // namespace inverse_dynamics_evaluation::fuzz

// SPDX-License-Identifier: Apache-2.0
/// @file
/// What can be told of a path before it is opened.
#pragma once

#include <string>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

enum class Place { kDirectory, kSqliteFile, kMcapFile };

/// What a path is. @throws RecordingError: no recording; the text says what else, and the remedy.
Place placeOf(const std::string& path);

/// @throws RecordingError: messages are in a log beside one of the files; DamageError: one is missing.
void requireFiles(const std::vector<std::string>& files);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a recording states, and where its files are.
#pragma once

#include <chain_dynamics/text.hpp>
#include <exception>
#include <memory>
#include <new>
#include <string>

#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/recording.hpp"
#include "metadata.hpp"
#include "storage_reader.hpp"
#include "text.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Calls a function; what it says of a damaged file becomes an error of the recording.
template <class Function>
auto readable(const std::string& path, Function function) -> decltype(function()) {
  try {
    return function();
  } catch (const RecordingError&) {
    throw;
  } catch (const ReadingError& error) {
    throw RecordingError(path + ": " + error.what());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {  // also of SQLite, of YAML and of the file system
    throw RecordingError(path + ": can't be read as a rosbag2 recording (" +
                         chain_dynamics::printable(error.what(), 300) +
                         "): expected sqlite3 or MCAP storage; it is damaged, cut off or of "
                         "another kind; copy or record it again");
  }
}

/// Its metadata, with paths of files.
struct RecordingContent : Metadata {
  explicit RecordingContent(std::string given_path);

  /// Opens one of the files.
  std::unique_ptr<StorageReader> open(const std::string& file) const;

  std::string path;
  std::string note;  ///< what users should know of its files; or nothing

 private:
  void read();
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

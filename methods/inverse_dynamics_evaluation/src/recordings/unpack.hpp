// SPDX-License-Identifier: Apache-2.0
/// @file
/// Compressed data, unpacked within limits: a few kilobytes may unpack to many gigabytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "bytes.hpp"

struct ZSTD_DCtx_s;

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// How many bytes may come out of so many. @throws ReadingError: the variable isn't a number.
std::uint64_t mostUnpacked(std::uint64_t packed);

/// The error for something that would unpack to more.
ReadingError beyondLimit(const std::string& what, std::uint64_t packed, std::uint64_t most);

/// Unpacks zstd, reusing its memory.
class ZstdUnpacker {
 public:
  ZstdUnpacker();

  /// Frames one after another.
  ///
  /// what: the text's subject (`a message or chunk`). @throws DamageError, ReadingError
  void unpack(const std::uint8_t* packed, std::size_t size, const std::string& what, Bytes& out);

 private:
  struct Free {
    void operator()(ZSTD_DCtx_s* context) const;
  };
  std::unique_ptr<ZSTD_DCtx_s, Free> context_;
};

/// Unpacks LZ4 frames. @throws DamageError, ReadingError
void unpackLz4(const std::uint8_t* packed, std::size_t size, Bytes& out);

/// A compressed file (zstd), unpacked into a temporary file whose name goes with the object.
///
/// While it is unpacked it has no name where the file system knows such files, so that nothing is
/// left of a program that is killed. Whoever has opened it needs the name no longer.
class UnpackedFile {
 public:
  /// @throws DamageError, ReadingError
  explicit UnpackedFile(const std::string& packed_path);
  ~UnpackedFile();
  UnpackedFile(const UnpackedFile&) = delete;
  UnpackedFile& operator=(const UnpackedFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  void removeName() const;

  std::string path_;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Files of bytes, and fields in them, read within their bounds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "text.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

using Bytes = std::vector<std::uint8_t>;

#ifdef __BYTE_ORDER__
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are copied as they are stored");
#endif

/// A number that is stored with its least byte first.
template <class Number>
Number littleEndian(const std::uint8_t* from) {
  Number number;
  std::memcpy(&number, from, sizeof number);
  return number;
}

/// Appends a number, its least byte first.
template <class Number>
void putNumber(Bytes& out, Number number) {
  std::uint8_t bytes[sizeof number];
  std::memcpy(bytes, &number, sizeof number);
  out.insert(out.end(), bytes, bytes + sizeof number);
}

/// Fields one after another, in memory.
class Fields {
 public:
  Fields(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}

  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  const std::uint8_t* at() const { return at_; }

  /// The next bytes. @throws DamageError: fewer are left.
  const std::uint8_t* take(std::uint64_t size) {
    if (size > left()) {
      throw DamageError("a record is too short: expected " + std::to_string(size) +
                        " more bytes, got " + std::to_string(left()));
    }
    const std::uint8_t* const begin = at_;
    at_ += size;
    return begin;
  }

  template <class Number>
  Number number() {
    return littleEndian<Number>(take(sizeof(Number)));
  }

  /// A text, or any bytes, after its length in 4 bytes.
  std::string string() {
    const auto size = number<std::uint32_t>();
    const std::uint8_t* const begin = take(size);
    return {reinterpret_cast<const char*>(begin), size};
  }

 private:
  const std::uint8_t* at_;
  const std::uint8_t* end_;
};

/// A regular file, open for reading.
class InputFile {
 public:
  /// @throws ReadingError: it can't be opened; DamageError: it isn't a file.
  explicit InputFile(const std::string& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::uint64_t size() const { return size_; }

  /// Bytes from an offset on, into memory that is used again.
  ///
  /// @throws DamageError: the file ends before; then no memory is taken. ReadingError: of the disk.
  void read(std::uint64_t offset, std::uint64_t size, Bytes& out) const;

 private:
  int file_ = -1;
  std::uint64_t size_ = 0;
};

/// A file that is written from its beginning to its end. Its errors are std::system_error.
class OutputFile {
 public:
  /// The file must not exist.
  explicit OutputFile(const std::string& path);
  /// A file that is open already, and empty.
  explicit OutputFile(int descriptor) : file_(descriptor) {}
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* data, std::size_t size);

  /// How many bytes were written.
  std::uint64_t size() const { return size_; }

  void close();

 private:
  int file_;
  std::uint64_t size_ = 0;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

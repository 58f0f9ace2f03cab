// SPDX-License-Identifier: Apache-2.0

/// @file
/// Numbers and choices from the bytes that a fuzzer makes up; zeros once they are used up.
///
///     Bytes bytes(data, size);
///     const int joints = 1 + bytes.below(9);
///     const double length = bytes.number(2.0);

#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace chain_dynamics::fuzz {

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), end_(data + size) {}

  std::uint8_t byte() { return data_ == end_ ? 0 : *data_++; }

  /// 0 to count - 1.
  int below(int count) { return byte() % count; }

  /// A number from -range to range: often one that robots are made of (0, 1, range), else any.
  double number(double range) {
    const int kind = byte();
    if (kind < 64) return 0.0;
    if (kind < 80) return 1.0;
    if (kind < 96) return -1.0;
    if (kind < 112) return range;
    double fraction = 0;
    for (int k = 0; k < 4; ++k) fraction = (fraction + byte()) / 256;
    // small ones too: most of the range would never be below a thousandth of it
    if (kind < 144) fraction = std::pow(10.0, -12 * fraction);
    return kind % 2 == 0 ? range * fraction : -range * fraction;
  }

 private:
  const std::uint8_t* data_;
  const std::uint8_t* end_;
};

}  // namespace chain_dynamics::fuzz

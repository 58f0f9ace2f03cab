// SPDX-License-Identifier: Apache-2.0
/// @file
/// Makes serialized joint states [cdr.hpp] of one publisher.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "bytes.hpp"
#include "cdr.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Messages differ in their stamp and numbers only: the rest is copied.
class JointStateEncoder {
 public:
  /// @param columns  how many numbers position, velocity and effort have.
  JointStateEncoder(const std::vector<std::string>& names, const std::string& frame_id,
                    const std::array<std::size_t, 3>& columns) {
    zeros_ = {0, 1, 0, 0};
    zeros_.resize(kCdrFrame);
    putText(frame_id);
    putLength(names.size());
    for (const std::string& name : names) putText(name);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      putLength(columns[i]);
      if (columns[i] > 0) zeros_.resize(cdrAligned(zeros_.size(), 8));
      arrays_[i] = {zeros_.size(), columns[i]};
      zeros_.resize(zeros_.size() + 8 * columns[i]);
    }
  }

  /// Size of each message, in bytes.
  std::size_t size() const { return zeros_.size(); }

  /// Whether there are numbers for each field that messages have.
  bool fits(const std::array<const double*, 3>& numbers) const {
    return std::equal(arrays_.begin(), arrays_.end(), numbers.begin(),
                      [](const CdrArray& array, const double* from) {
                        return array.count == 0 || from != nullptr;
                      });
  }

  /// Writes size() bytes.
  ///
  /// @param stamp    ns; its seconds fit 32 bits.
  /// @param numbers  of position, velocity, effort; null where there are none.
  void write(std::int64_t stamp, const std::array<const double*, 3>& numbers,
             std::uint8_t* out) const {
    std::memcpy(out, zeros_.data(), zeros_.size());
    const bool before_zero = stamp % kSecond < 0;
    const auto sec = static_cast<std::uint32_t>(stamp / kSecond - (before_zero ? 1 : 0));
    const auto nanosec = static_cast<std::uint32_t>(stamp % kSecond + (before_zero ? kSecond : 0));
    std::memcpy(out + kCdrStamp, &sec, 4);
    std::memcpy(out + kCdrStamp + 4, &nanosec, 4);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (arrays_[i].count == 0) continue;
      std::memcpy(out + arrays_[i].offset, numbers[i], 8 * arrays_[i].count);
    }
  }

 private:
  void putLength(std::size_t length) {
    zeros_.resize(cdrAligned(zeros_.size(), 4));
    putNumber(zeros_, static_cast<std::uint32_t>(length));
  }

  void putText(const std::string& text) {
    putLength(text.size() + 1);
    zeros_.insert(zeros_.end(), text.begin(), text.end());
    zeros_.push_back(0);
  }

  Bytes zeros_;  // a message whose stamp and numbers are zero
  std::array<CdrArray, 3> arrays_;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

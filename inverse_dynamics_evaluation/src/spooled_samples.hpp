// SPDX-License-Identifier: Apache-2.0

/// @file
/// Samples whose first pass is slow, as of a database: a file has them for the passes after it.
///
///     SpooledSamples samples(recorded, "result");
///
/// The file has no name, so it is gone with the program, however that ends.

#pragma once

#include <cstdint>
#include <string>

#include "sample_stream.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

class SpooledSamples : public SampleStream {
 public:
  /// @param samples    must outlive it.
  /// @param directory  where the file is, about 200 bytes per sample of seven joints.
  /// @throws RecordingError: no file can be made there.
  SpooledSamples(SampleStream& samples, std::string directory);
  ~SpooledSamples() override;
  SpooledSamples(const SpooledSamples&) = delete;
  SpooledSamples& operator=(const SpooledSamples&) = delete;

  bool next(SampleBlock& block) override;
  void rewind() override;
  bool clockHasChanged() override;
  Clock clock() const override { return samples_.clock(); }
  std::string where() const override { return samples_.where(); }
  std::string frameId() const override { return samples_.frameId(); }

 private:
  void transfer(bool out, SampleBlock& block);
  void transfer(bool out, void* data, std::int64_t bytes);

  SampleStream& samples_;
  std::string directory_;
  int file_;
  std::int64_t place_ = 0;  // in the file
  std::int64_t size_ = 0;   // of it, once it is complete
  bool complete_ = false;   // whether it has all samples
  Eigen::Index first_ = 0;  // number of the next sample
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

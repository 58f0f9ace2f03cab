// SPDX-License-Identifier: Apache-2.0
/// @file
/// Joint states that are split over several topics, or over several messages of one, merged by time.
///
/// Messages of a topic with the same joints and fields are a stream. Samples have the times of the
/// slowest stream. Numbers of the others lie on straight lines between the two messages around that
/// time, unless these are more than 1.5 periods of the slowest stream apart: then the sample is left
/// out.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/joint_state_source.hpp"
#include "inverse_dynamics_evaluation/sample_table.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Messages of a topic with the same joints and fields, and the stamps of its first ones.
struct JointStream {
  std::string topic;
  std::vector<std::string> names;
  std::array<bool, 3> filled;  ///< position, velocity, effort
  std::vector<std::int64_t> header_stamps, receive_stamps;

  /// Whether it has the message.
  bool takes(const JointSample& sample) const;
};

/// Opens the joint states of a topic.
using OpenTopic = std::function<std::unique_ptr<JointStateSource>(const std::string& topic)>;

/// The streams at the beginning of some topics.
std::vector<JointStream> streamsOf(const std::vector<std::string>& topics, const OpenTopic& open);

/// Streams that together have each number of the joints once.
struct Complementary {
  std::vector<JointStream> streams;
  std::string missing;  ///< what no stream has; empty: nothing

  /// Whether one of them is of the topic.
  bool has(const std::string& topic) const;
};

/// @param path     for the text.
/// @param options  joints; none: those of all streams. Whether efforts are required.
/// @throws RecordingError: two topics have the same number.
Complementary complementary(const std::vector<JointStream>& streams,
                            const RecordingOptions& options, const std::string& path);

/// Merges what complementary() gave.
std::unique_ptr<JointStateSource> merged(std::vector<JointStream> streams, const OpenTopic& open,
                                         const RecordingOptions& options, const std::string& path);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

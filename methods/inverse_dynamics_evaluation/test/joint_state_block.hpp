// SPDX-License-Identifier: Apache-2.0

/// @file
/// Messages of the same joints, for tests.
///
///     JointStateBlock block;
///     for (JointSample sample; source.next(sample);) block.add(sample);
///     block.sample(2).position.data[0];

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/joint_state_source.hpp"

namespace inverse_dynamics_evaluation {

/// One field of N messages.
struct JointStateNumbers {
  std::vector<double> values;  ///< row-major
  std::size_t columns = 0;     ///< numbers per message
};

/// N messages that differ in stamps and numbers only.
struct JointStateBlock {
  std::vector<std::string> joint_names;
  std::string frame_id;
  std::vector<std::int64_t> header_stamps, receive_stamps;  ///< N
  JointStateNumbers position, velocity, effort;

  std::size_t size() const { return receive_stamps.size(); }

  /// The first sample says names and frame of all.
  void add(const JointSample& sample) {
    if (size() == 0) {
      joint_names = *sample.names;
      frame_id = sample.frame_id;
    }
    header_stamps.push_back(sample.header_stamp);
    receive_stamps.push_back(sample.receive_stamp);
    const auto append = [](JointStateNumbers& to, const JointSample::Numbers& from) {
      to.columns = from.size;
      if (from.size > 0) to.values.insert(to.values.end(), from.data, from.data + from.size);
    };
    append(position, sample.position);
    append(velocity, sample.velocity);
    append(effort, sample.effort);
  }

  /// Message i, which looks at this block.
  JointSample sample(std::size_t i) const {
    const auto row = [i](const JointStateNumbers& field) {
      return JointSample::Numbers{field.values.data() + i * field.columns, field.columns};
    };
    JointSample sample;
    sample.names = &joint_names;
    sample.frame_id = frame_id;
    sample.position = row(position);
    sample.velocity = row(velocity);
    sample.effort = row(effort);
    sample.header_stamp = header_stamps[i];
    sample.receive_stamp = receive_stamps[i];
    return sample;
  }
};

/// Everything that a source has left.
inline JointStateBlock rest(JointStateSource& source) {
  JointStateBlock all;
  for (JointSample sample; source.next(sample);) all.add(sample);
  return all;
}

}  // namespace inverse_dynamics_evaluation

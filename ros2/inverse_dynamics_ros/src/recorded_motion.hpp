// SPDX-License-Identifier: Apache-2.0

/// @file
/// A motion in a rosbag2 recording: joint states or joint trajectories.
///
/// The rules of sample_table.hpp. Each point of a joint trajectory is a sample; its stamp is that of
/// its message plus its time_from_start. Several messages are points of one motion, so each must
/// have one point; those without are left out. Efforts of trajectories may be absent.

#pragma once

#include <cstdint>
#include <inverse_dynamics_evaluation/recording.hpp>
#include <memory>
#include <string>
#include <trajectory_msgs/msg/joint_trajectory.hpp>
#include <vector>

namespace inverse_dynamics_ros {

/// Which messages are read, and of which joints.
struct MotionQuery {
  std::string topic;  ///< empty: usual_topic, else those of joint states with the joints, else
                      ///< the only one of trajectories
  std::string usual_topic;  ///< taken where the recording has it and none is named; or empty
  std::vector<std::string> joints;  ///< in the order wanted
  inverse_dynamics_evaluation::Clock clock = inverse_dynamics_evaluation::Clock::kAuto;
};

/// A message of a recording.
struct RecordedTrajectory {
  trajectory_msgs::msg::JointTrajectory message;
  std::int64_t received = 0;  ///< ns
};

/// An opened motion: its samples, and its trajectories for writing similar messages.
struct RecordedMotion {
  std::string topic;
  inverse_dynamics_evaluation::Storage storage = inverse_dynamics_evaluation::Storage::kSqlite3;
  inverse_dynamics_evaluation::RecordingOptions options;  ///< how the samples are to be read
  std::vector<RecordedTrajectory> trajectories;           ///< empty: joint states
  std::unique_ptr<inverse_dynamics_evaluation::JointStateSource> source;  ///< needs trajectories
};

/// Opens a recording: a directory with metadata.yaml, or a .db3 or .mcap file.
///
/// @throws UserError, inverse_dynamics_evaluation::RecordingError: no such recording, one that
///         can't be read, no such topic, another type; interrupted.
std::unique_ptr<RecordedMotion> openMotion(const std::string& path, const MotionQuery& query);

}  // namespace inverse_dynamics_ros

// SPDX-License-Identifier: Apache-2.0

/// @file
/// A motion from a rosbag2 recording: joint states or joint trajectories.
///
/// The rules of sample_table.hpp. Each point of a joint trajectory is a sample; its stamp is that of
/// its message plus its time_from_start. Several messages are points of one motion, so each must
/// have one point; those without are left out. Efforts of trajectories may be absent.

#pragma once

#include <inverse_dynamics_evaluation/sample_table.hpp>
#include <memory>
#include <std_msgs/msg/header.hpp>
#include <string>
#include <trajectory_msgs/msg/joint_trajectory.hpp>
#include <vector>

namespace inverse_dynamics_ros {

inline const std::string kJointState = "sensor_msgs/msg/JointState";
inline const std::string kJointTrajectory = "trajectory_msgs/msg/JointTrajectory";

/// Which messages are read, and of which joints.
struct MotionQuery {
  std::string topic;        ///< empty: usual_topic, else the only one of joint states, else of
                            ///< trajectories
  std::string usual_topic;  ///< taken where the recording has it and none is named; or empty
  std::vector<std::string> joints;  ///< in the order wanted
  inverse_dynamics_evaluation::Clock clock = inverse_dynamics_evaluation::Clock::kAuto;
};

/// Samples, and what is needed to write messages like theirs.
struct RecordedMotion {
  std::shared_ptr<inverse_dynamics_evaluation::SampleTable> log;
  std::string topic;
  std::string type;     ///< kJointState or kJointTrajectory
  std::string storage;  ///< sqlite3 or mcap

  std::vector<std::size_t> message;  ///< number of each sample's message

  // Of trajectories, by message; empty for joint states.
  std::vector<std_msgs::msg::Header> headers;
  std::vector<std::int64_t> receive_stamps;  ///< ns; those in log are later by time_from_start
};

/// Reads a recording: a directory with metadata.yaml, or a .db3 or .mcap file.
///
/// @throws UserError, inverse_dynamics_evaluation::RecordingError: no such recording, one that
///         can't be read, no such topic, another type, what TableBuilder says; interrupted.
RecordedMotion readMotion(const std::string& path, const MotionQuery& query);

}  // namespace inverse_dynamics_ros

// SPDX-License-Identifier: Apache-2.0

#include "recorded_motion.hpp"

#include <filesystem>
#include <rclcpp/serialization.hpp>
#include <rclcpp/time.hpp>
#include <rclcpp/utilities.hpp>
#include <rosbag2_cpp/reader.hpp>
#include <rosbag2_storage/storage_filter.hpp>
#include <rosbag2_storage/storage_options.hpp>
#include <sensor_msgs/msg/joint_state.hpp>

#include "interrupted.hpp"
#include "rosbag2_compatibility.hpp"
#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_evaluation::JointLogBuilder;
using inverse_dynamics_evaluation::JointSample;
using sensor_msgs::msg::JointState;
using trajectory_msgs::msg::JointTrajectory;
using trajectory_msgs::msg::JointTrajectoryPoint;

JointSample::Numbers numbers(const std::vector<double>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

std::int64_t nanoseconds(const builtin_interfaces::msg::Time& stamp) {
  return std::int64_t{stamp.sec} * 1'000'000'000 + stamp.nanosec;
}

std::int64_t nanoseconds(const builtin_interfaces::msg::Duration& duration) {
  return std::int64_t{duration.sec} * 1'000'000'000 + duration.nanosec;
}

// Throws unless there is something that may be a recording.
void requireRecording(const std::filesystem::path& path) {
  const std::string expected =
      "a rosbag2 recording: a directory with metadata.yaml, or a .db3 or .mcap file";
  if (!std::filesystem::exists(path)) {
    throw UserError(path.string(), expected, "no such file or directory", "correct 'input_bag'");
  }
  if (std::filesystem::is_directory(path)) {
    if (!std::filesystem::exists(path / "metadata.yaml")) {
      throw UserError(path.string(), expected, "a directory without metadata.yaml",
                      "is it another directory? `ros2 bag reindex` writes lost metadata");
    }
  } else if (path.extension() != ".db3" && path.extension() != ".mcap") {
    throw UserError(path.string(), expected, "another file",
                    path.extension() == ".bag" ? "convert the ROS 1 recording with rosbags-convert"
                                               : "correct 'input_bag'");
  }
}

// An opened recording; what can go wrong is a UserError.
class OpenRecording {
 public:
  explicit OpenRecording(const std::string& path) : path_(path) {
    requireRecording(path);
    rosbag2_storage::StorageOptions options;
    options.uri = path;
    if (!std::filesystem::is_directory(path)) {
      options.storage_id = std::filesystem::path(path).extension() == ".mcap" ? "mcap" : "sqlite3";
    }
    try {
      reader_.open(options);
      topics_ = reader_.get_metadata().topics_with_message_count;
      storage_ = reader_.get_metadata().storage_identifier;
      compression_ = reader_.get_metadata().compression_mode;
    } catch (const std::exception& error) {
      throw unreadable(error);
    }
    if (!compression_.empty() && compression_ != "NONE" && compression_ != "none") {
      throw UserError(path_, "a recording that isn't compressed by rosbag2",
                      "compression mode " + compression_, "decompress it with `ros2 bag convert`");
    }
  }

  const std::string& storage() const { return storage_; }

  /// The topic of that name, or the only one that can be read.
  rosbag2_storage::TopicInformation topic(const std::string& name) const {
    std::vector<rosbag2_storage::TopicInformation> found;
    std::string there;
    for (const auto& topic : topics_) {
      const bool readable = isReadable(topic.topic_metadata.type);
      if (name.empty() ? readable : topic.topic_metadata.name == name) {
        found.push_back(topic);
      }
      there += "\n  " + topic.topic_metadata.name + "  " + topic.topic_metadata.type + "  " +
               std::to_string(topic.message_count) + " messages";
    }
    const std::string types = kJointState + " or " + kJointTrajectory;
    const std::string remedy =
        "name it with 'input_topic'; the recording has" + (there.empty() ? " no topic" : there);
    if (found.size() != 1) {
      throw name.empty()
          ? UserError(path_, "one topic of type " + types, std::to_string(found.size()), remedy)
          : UserError(path_ + ": topic " + name, "to be in the recording", "no such topic", remedy);
    }
    if (!isReadable(found[0].topic_metadata.type)) {
      throw UserError(path_ + ": topic " + name, "type " + types, found[0].topic_metadata.type,
                      remedy);
    }
    return found[0];
  }

  /// Calls `take(message, receive stamp, number)` with all messages of the topic.
  template <class Message, class Take>
  void forEach(const rosbag2_storage::TopicInformation& topic, Take take) {
    rosbag2_storage::StorageFilter filter;
    filter.topics = {topic.topic_metadata.name};
    rclcpp::Serialization<Message> serialization;
    Message message;
    std::size_t number = 0;
    std::shared_ptr<rosbag2_storage::SerializedBagMessage> next;
    try {
      for (reader_.set_filter(filter); reader_.has_next(); ++number) {
        requireNoInterrupt();
        next = reader_.read_next();
        const rclcpp::SerializedMessage serialized(*next->serialized_data);
        serialization.deserialize_message(&serialized, &message);
        take(message, receiveStamp(*next), static_cast<Eigen::Index>(number));
      }
    } catch (const inverse_dynamics_evaluation::RecordingError&) {
      throw;
    } catch (const Interrupted&) {
      throw;
    } catch (const std::exception& error) {
      throw unreadable(error);
    }
    if (number < topic.message_count) {
      throw UserError(path_ + ": " + topic.topic_metadata.name,
                      std::to_string(topic.message_count) + " messages, as its metadata say",
                      std::to_string(number), "the file is cut off; copy or record it again");
    }
  }

 private:
  static bool isReadable(const std::string& type) {
    return type == kJointState || type == kJointTrajectory;
  }

  UserError unreadable(const std::exception& error) const {
    return {path_, "a rosbag2 recording that this ROS 2 can read",
            "an error (" + std::string(error.what()) + ")",
            "it is damaged, cut off, of another kind or from a later release; copy, record or "
            "convert it again"};
  }

  std::string path_;
  rosbag2_cpp::Reader reader_;
  std::vector<rosbag2_storage::TopicInformation> topics_;
  std::string storage_, compression_;
};

void readJointStates(OpenRecording& recording, const rosbag2_storage::TopicInformation& topic,
                     JointLogBuilder& builder, RecordedMotion& motion) {
  recording.forEach<JointState>(
      topic, [&](const JointState& state, std::int64_t received, Eigen::Index number) {
        builder.add({state.name, numbers(state.position), numbers(state.velocity),
                     numbers(state.effort), numbers({}), nanoseconds(state.header.stamp), received,
                     number});
        if (motion.frame_id.empty()) {
          motion.frame_id = state.header.frame_id;
        }
      });
}

void readTrajectories(OpenRecording& recording, const rosbag2_storage::TopicInformation& topic,
                      JointLogBuilder& builder, RecordedMotion& motion) {
  recording.forEach<JointTrajectory>(
      topic, [&](const JointTrajectory& trajectory, std::int64_t received, Eigen::Index number) {
        const std::int64_t stamp = nanoseconds(trajectory.header.stamp);
        Eigen::Index k = 0;
        for (const JointTrajectoryPoint& point : trajectory.points) {
          const std::int64_t from_start = nanoseconds(point.time_from_start);
          builder.add({trajectory.joint_names, numbers(point.positions), numbers(point.velocities),
                       numbers(point.effort), numbers(point.accelerations),
                       (stamp == 0 ? received : stamp) + from_start, received + from_start, number,
                       k++});
        }
        motion.headers.push_back(trajectory.header);
        motion.receive_stamps.push_back(received);
      });
}

}  // namespace

RecordedMotion readMotion(const std::string& path, const MotionQuery& query) {
  OpenRecording recording(path);
  const auto topic = recording.topic(query.topic);
  RecordedMotion motion;
  motion.topic = topic.topic_metadata.name;
  motion.type = topic.topic_metadata.type;
  motion.storage = recording.storage();
  JointLogBuilder builder(path + ": " + motion.topic, query.joints,
                          {motion.type == kJointState, "the parameter 'joints'"});
  if (motion.type == kJointState) {
    readJointStates(recording, topic, builder, motion);
  } else {
    readTrajectories(recording, topic, builder, motion);
  }
  motion.log = builder.finish(query.clock);
  return motion;
}

}  // namespace inverse_dynamics_ros

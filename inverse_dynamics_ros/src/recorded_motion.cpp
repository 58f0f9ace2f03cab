// SPDX-License-Identifier: Apache-2.0

#include "recorded_motion.hpp"

#include <algorithm>
#include <filesystem>
#include <rclcpp/serialization.hpp>
#include <rclcpp/time.hpp>
#include <rclcpp/utilities.hpp>
#include <rosbag2_cpp/reader.hpp>
#include <rosbag2_storage/storage_filter.hpp>
#include <rosbag2_storage/storage_options.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <set>

#include "interrupted.hpp"
#include "rosbag2_compatibility.hpp"
#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_evaluation::Clock;
using inverse_dynamics_evaluation::JointSample;
using inverse_dynamics_evaluation::RecordingOptions;
using inverse_dynamics_evaluation::SampleTable;
using inverse_dynamics_evaluation::TableBuilder;
using sensor_msgs::msg::JointState;
using trajectory_msgs::msg::JointTrajectory;
using trajectory_msgs::msg::JointTrajectoryPoint;

JointSample::Numbers numbers(const std::vector<double>& values) {
  return {values.data(), values.size()};
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

  /// Whether it has messages of that topic.
  bool has(const std::string& name) const {
    return std::any_of(topics_.begin(), topics_.end(), [&name](const auto& topic) {
      return topic.topic_metadata.name == name && topic.message_count > 0;
    });
  }

  /// The topic of that name, or the only one of joint states, else the only one of trajectories.
  rosbag2_storage::TopicInformation topic(const std::string& name) const {
    std::vector<rosbag2_storage::TopicInformation> found;
    for (const std::string& type : {kJointState, kJointTrajectory}) {
      for (const auto& topic : topics_) {
        const auto& metadata = topic.topic_metadata;
        if (name.empty() ? metadata.type == type && topic.message_count > 0
                         : metadata.name == name && found.empty()) {
          found.push_back(topic);
        }
      }
      if (!found.empty()) {
        break;
      }
    }
    const std::string types = kJointState + " or " + kJointTrajectory;
    const std::string remedy = "name it with 'input_topic'; the recording has" + listedTopics();
    if (!name.empty() && found.empty()) {
      throw UserError(path_, "a topic " + name, "none of that name", remedy);
    }
    if (found.size() != 1) {
      throw UserError(path_, "one topic of type " + types, std::to_string(found.size()), remedy);
    }
    const std::string& type = found[0].topic_metadata.type;
    if (type != kJointState && type != kJointTrajectory) {
      throw UserError(path_ + ": topic " + name, "type " + types, type, remedy);
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
        take(message, receiveStamp(*next), number);
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
  std::string listedTopics() const {
    std::string text;
    for (const auto& topic : topics_) {
      text += "\n  " + topic.topic_metadata.name + "  " + topic.topic_metadata.type + "  " +
              std::to_string(topic.message_count) + " messages";
    }
    return text.empty() ? " no topic" : text;
  }

  UserError unreadable(const std::exception& error) const {
    return {path_, "a rosbag2 recording that this ROS 2 can read",
            "an error (" + std::string(error.what()) + ")",
            "it is damaged, cut off or of another kind: copy or record it again; or its metadata "
            "are those of a later release: give the .db3 or .mcap file in it"};
  }

  std::string path_;
  rosbag2_cpp::Reader reader_;
  std::vector<rosbag2_storage::TopicInformation> topics_;
  std::string storage_, compression_;
};

void readJointStates(OpenRecording& recording, const rosbag2_storage::TopicInformation& topic,
                     TableBuilder& builder, RecordedMotion& motion) {
  recording.forEach<JointState>(
      topic, [&](const JointState& state, std::int64_t received, std::size_t number) {
        JointSample sample;
        sample.names = &state.name;
        sample.position = numbers(state.position);
        sample.velocity = numbers(state.velocity);
        sample.effort = numbers(state.effort);
        sample.header_stamp = nanoseconds(state.header.stamp);
        sample.receive_stamp = received;
        sample.message = static_cast<std::int64_t>(number);
        sample.frame_id = state.header.frame_id;
        if (builder.add(sample)) motion.message.push_back(number);
      });
}

void readTrajectories(OpenRecording& recording, const rosbag2_storage::TopicInformation& topic,
                      TableBuilder& builder, RecordedMotion& motion) {
  std::size_t most = 0;  // points in a message
  recording.forEach<JointTrajectory>(
      topic, [&](const JointTrajectory& trajectory, std::int64_t received, std::size_t number) {
        JointSample sample;
        sample.names = &trajectory.joint_names;
        sample.frame_id = trajectory.header.frame_id;
        sample.message = static_cast<std::int64_t>(number);
        for (const JointTrajectoryPoint& point : trajectory.points) {
          const std::int64_t from_start = nanoseconds(point.time_from_start);
          sample.position = numbers(point.positions);
          sample.velocity = numbers(point.velocities);
          sample.effort = numbers(point.effort);
          sample.acceleration = numbers(point.accelerations);
          sample.header_stamp = nanoseconds(trajectory.header.stamp) + from_start;
          sample.receive_stamp = received + from_start;
          ++sample.point;
          if (builder.add(sample)) motion.message.push_back(number);
        }
        most = std::max(most, trajectory.points.size());
        motion.headers.push_back(trajectory.header);
        motion.receive_stamps.push_back(received);
      });
  if (most > 1 && motion.headers.size() > 1) {
    throw UserError(topic.topic_metadata.name, "one trajectory, or messages of one point each",
                    std::to_string(motion.headers.size()) + " messages with up to " +
                        std::to_string(most) + " points",
                    "which of them belong together isn't known; `ids torques` takes any number");
  }
}

// Stamps of trajectories: the headers', unless several trajectories have none.
Clock clockOf(const RecordedMotion& motion, Clock asked, std::vector<std::string>& notes) {
  const bool stamped =
      motion.headers.size() < 2 ||
      std::any_of(motion.headers.begin(), motion.headers.end(),
                  [](const auto& header) { return nanoseconds(header.stamp) > 0; });
  if (asked != Clock::kAuto || stamped) {
    return asked;
  }
  notes.emplace_back("no header has a stamp: the time of reception is used");
  return Clock::kReceive;
}

// How many trajectories have no points.
void countEmpty(const RecordedMotion& motion, std::vector<std::string>& notes) {
  const std::size_t all = motion.headers.size();
  const std::size_t filled =
      std::set<std::size_t>(motion.message.begin(), motion.message.end()).size();
  if (filled < all) {
    notes.push_back(std::to_string(all - filled) + " of " + std::to_string(all) +
                    " messages left out: no points of the joints");
  }
}

}  // namespace

RecordedMotion readMotion(const std::string& path, const MotionQuery& query) {
  OpenRecording recording(path);
  const bool usual = query.topic.empty() && recording.has(query.usual_topic);
  const auto topic = recording.topic(usual ? query.usual_topic : query.topic);
  RecordedMotion motion;
  motion.topic = topic.topic_metadata.name;
  motion.type = topic.topic_metadata.type;
  motion.storage = recording.storage();
  motion.log = std::make_shared<SampleTable>();
  RecordingOptions options;
  options.joints = query.joints;
  options.effort_required = motion.type == kJointState;
  options.joints_option = "the parameter 'joints'";
  TableBuilder builder(path + ": " + motion.topic, options, *motion.log);
  if (motion.type == kJointState) {
    readJointStates(recording, topic, builder, motion);
    builder.finish(query.clock);
  } else {
    readTrajectories(recording, topic, builder, motion);
    std::vector<std::string> notes;
    builder.finish(clockOf(motion, query.clock, notes));
    countEmpty(motion, notes);
    motion.log->notes.insert(motion.log->notes.end(), notes.begin(), notes.end());
  }
  return motion;
}

}  // namespace inverse_dynamics_ros

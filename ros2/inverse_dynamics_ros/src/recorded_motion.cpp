// SPDX-License-Identifier: Apache-2.0

#include "recorded_motion.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <inverse_dynamics_evaluation/error.hpp>
#include <inverse_dynamics_evaluation/joint_state_source.hpp>
#include <inverse_dynamics_evaluation/recording.hpp>
#include <memory>
#include <rclcpp/serialization.hpp>
#include <rclcpp/serialized_message.hpp>
#include <string>
#include <trajectory_msgs/msg/joint_trajectory.hpp>
#include <trajectory_msgs/msg/joint_trajectory_point.hpp>
#include <utility>
#include <vector>

#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_evaluation::JointSample;
using inverse_dynamics_evaluation::JointStateSource;
using inverse_dynamics_evaluation::kJointState;
using inverse_dynamics_evaluation::Message;
using inverse_dynamics_evaluation::Recording;
using inverse_dynamics_evaluation::RecordingError;
using inverse_dynamics_evaluation::Topic;
using trajectory_msgs::msg::JointTrajectory;

const char* const kJointTrajectory = "trajectory_msgs/msg/JointTrajectory";

// Of a time or a duration in a message.
template <class Time>
std::int64_t nanoseconds(const Time& time) {
  return std::int64_t{time.sec} * 1'000'000'000 + time.nanosec;
}

// The points of trajectories, which must stay, one after the other.
class Points : public JointStateSource {
 public:
  Points(const std::vector<RecordedTrajectory>& trajectories, std::string where)
      : trajectories_(trajectories), where_(std::move(where)) {}

  bool next(JointSample& sample) override {
    while (message_ < trajectories_.size() && point_ == pointsOf(message_).size()) {
      ++message_;
      point_ = 0;
    }
    if (message_ == trajectories_.size()) return false;
    fill(trajectories_[message_], sample);
    sample.message = static_cast<std::int64_t>(message_);
    sample.point = static_cast<std::int64_t>(point_++);
    return true;
  }

  void rewind() override { message_ = point_ = 0; }
  std::int64_t expectedMessages() const override {
    return static_cast<std::int64_t>(trajectories_.size());
  }
  std::string where() const override { return where_; }

  std::string note() const override {
    const auto empty =
        std::count_if(trajectories_.begin(), trajectories_.end(),
                      [](const auto& trajectory) { return trajectory.message.points.empty(); });
    if (empty == 0) return "";
    return std::to_string(empty) + " of " + std::to_string(trajectories_.size()) +
           " messages left out: no points";
  }

 private:
  static JointSample::Numbers numbers(const std::vector<double>& values) {
    return {values.data(), values.size()};
  }
  const std::vector<trajectory_msgs::msg::JointTrajectoryPoint>& pointsOf(std::size_t k) const {
    return trajectories_[k].message.points;
  }

  // Points of several trajectories without stamps have none either.
  void fill(const RecordedTrajectory& trajectory, JointSample& sample) const {
    const auto& point = trajectory.message.points[point_];
    const std::int64_t from_start = nanoseconds(point.time_from_start);
    const std::int64_t stamp = nanoseconds(trajectory.message.header.stamp);
    sample.names = &trajectory.message.joint_names;
    sample.position = numbers(point.positions);
    sample.velocity = numbers(point.velocities);
    sample.effort = numbers(point.effort);
    sample.acceleration = numbers(point.accelerations);
    sample.header_stamp = stamp == 0 && trajectories_.size() > 1 ? 0 : stamp + from_start;
    sample.receive_stamp = trajectory.received + from_start;
    sample.frame_id = trajectory.message.header.frame_id;
  }

  const std::vector<RecordedTrajectory>& trajectories_;
  std::string where_;
  std::size_t message_ = 0, point_ = 0;  // the next one
};

JointTrajectory decoded(const Message& message, const std::string& where) {
  rclcpp::SerializedMessage serialized(message.size);
  auto& bytes = serialized.get_rcl_serialized_message();
  std::copy_n(message.data, message.size, bytes.buffer);
  bytes.buffer_length = message.size;
  JointTrajectory trajectory;
  try {
    rclcpp::Serialization<JointTrajectory>().deserialize_message(&serialized, &trajectory);
  } catch (const std::exception& error) {
    throw UserError(where, "messages of type " + std::string(kJointTrajectory),
                    "an error (" + std::string(error.what()) + ")",
                    "the recording is damaged: copy or record it again");
  }
  return trajectory;
}

std::vector<RecordedTrajectory> readTrajectories(const Recording& recording,
                                                 const std::string& topic) {
  const std::string where = recording.path() + ": " + topic;
  std::vector<RecordedTrajectory> trajectories;
  std::size_t most = 0;  // points in a message
  const auto source = recording.messages(topic);
  for (Message message; source->next(message);) {
    requireNoInterrupt();
    trajectories.push_back({decoded(message, where), message.received});
    most = std::max(most, trajectories.back().message.points.size());
  }
  if (most > 1 && trajectories.size() > 1) {
    throw UserError(where, "one trajectory, or messages of one point each",
                    std::to_string(trajectories.size()) + " messages with up to " +
                        std::to_string(most) + " points",
                    "which of them belong together isn't known; `ids torques` takes any number");
  }
  return trajectories;
}

// Chooses the topic; whether it is one of trajectories.
bool chooseTopic(const Recording& recording, const MotionQuery& query, RecordedMotion& motion) {
  std::string topic = query.topic;
  for (const Topic& there : recording.topics()) {
    const bool usual = there.name == query.usual_topic && there.messages > 0;
    if (query.topic.empty() && usual) topic = query.usual_topic;
  }
  bool has_states = false, has_trajectories = false;
  for (const Topic& there : recording.topics()) {
    if (topic.empty() ? there.messages == 0 : there.name != topic) continue;
    has_states = has_states || there.type == kJointState;
    has_trajectories = has_trajectories || there.type == kJointTrajectory;
  }
  const bool is_trajectory = has_trajectories && !has_states;
  if (query.topic.empty() && has_states) topic = recording.topicsWithJoints(topic, motion.options);
  motion.topic = recording.topicOfType(is_trajectory ? kJointTrajectory : kJointState, topic);
  return is_trajectory;
}

void open(const std::string& path, const MotionQuery& query, RecordedMotion& motion) {
  const Recording recording(path);
  motion.storage = recording.storage();
  motion.options.joints = query.joints;
  motion.options.clock = query.clock;
  motion.options.joints_option = "the parameter 'joints'";
  if (chooseTopic(recording, query, motion)) {
    motion.options.effort_required = false;
    motion.trajectories = readTrajectories(recording, motion.topic);
    motion.source = std::make_unique<Points>(motion.trajectories, path + ": " + motion.topic);
  } else {
    motion.source = recording.jointStates(motion.topic, motion.options);
  }
}

}  // namespace

std::unique_ptr<RecordedMotion> openMotion(const std::string& path, const MotionQuery& query) {
  auto motion = std::make_unique<RecordedMotion>();
  try {
    open(path, query, *motion);
  } catch (const RecordingError& error) {
    const std::string option = "--topic";  // of `ids`
    std::string text = error.what();
    const std::size_t at = text.find(option);
    if (at == std::string::npos) throw;
    throw UserError(text.replace(at, option.size(), "the parameter 'input_topic'"));
  }
  return motion;
}

}  // namespace inverse_dynamics_ros

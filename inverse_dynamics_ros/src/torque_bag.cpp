// SPDX-License-Identifier: Apache-2.0

#include "torque_bag.hpp"

#include <rclcpp/duration.hpp>
#include <rclcpp/time.hpp>
#include <sensor_msgs/msg/joint_state.hpp>

#include "interrupted.hpp"
#include "output_bag.hpp"

namespace inverse_dynamics_ros {
namespace {

using Eigen::Index;
using inverse_dynamics_evaluation::JointLog;
using sensor_msgs::msg::JointState;
using trajectory_msgs::msg::JointTrajectory;
using trajectory_msgs::msg::JointTrajectoryPoint;

std::vector<double> numbers(const Eigen::Ref<const Eigen::MatrixXd>& matrix, Index k) {
  const auto column = matrix.col(k);
  return {column.data(), column.data() + column.size()};
}

JointState jointState(const RecordedMotion& motion, const Eigen::MatrixXd& effort, Index k) {
  const JointLog& log = motion.log;
  JointState state;
  state.header.stamp = rclcpp::Time(log.header_stamps[k]);
  state.header.frame_id = motion.frame_id;
  state.name = log.joint_names;
  state.position = numbers(log.q, k);
  state.velocity = numbers(log.qd, k);
  state.effort = numbers(effort, k);
  return state;
}

// The trajectory whose first sample is k; k then is the first of the next one.
JointTrajectory trajectory(const RecordedMotion& motion,
                           const Eigen::Ref<const Eigen::MatrixXd>& qdd,
                           const Eigen::MatrixXd& effort, Index& k) {
  const JointLog& log = motion.log;
  const Index message = log.message[static_cast<std::size_t>(k)];
  JointTrajectory result;
  result.header = motion.headers[static_cast<std::size_t>(message)];
  result.joint_names = log.joint_names;
  for (; k < log.q.cols() && log.message[static_cast<std::size_t>(k)] == message; ++k) {
    JointTrajectoryPoint point;
    point.positions = numbers(log.q, k);
    point.velocities = numbers(log.qd, k);
    point.accelerations = numbers(qdd, k);
    point.effort = numbers(effort, k);
    point.time_from_start = rclcpp::Duration::from_nanoseconds(
        log.receive_stamps[k] - motion.receive_stamps[static_cast<std::size_t>(message)]);
    result.points.push_back(point);
  }
  return result;
}

}  // namespace

void writeTorques(const std::string& target, const std::string& storage, const std::string& topic,
                  const RecordedMotion& motion, const Evaluation& evaluation) {
  OutputBag bag(target, storage);
  const JointLog& log = motion.log;
  const bool measured = evaluation.measured.size() > 0;
  for (Index k = 0; k < log.q.cols();) {
    requireNoInterrupt();
    if (motion.type == kJointState) {
      bag.write(jointState(motion, evaluation.computed, k), topic, log.receive_stamps[k]);
      if (measured) {
        bag.write(jointState(motion, evaluation.measured, k), topic + "_gt", log.receive_stamps[k]);
      }
      ++k;
      continue;
    }
    const std::int64_t received =
        motion.receive_stamps[static_cast<std::size_t>(log.message[static_cast<std::size_t>(k)])];
    Index next = k;
    const Eigen::Ref<const Eigen::MatrixXd> qdd = evaluation.accelerations.qdd;
    if (measured) {
      bag.write(trajectory(motion, qdd, evaluation.measured, next = k), topic + "_gt", received);
    }
    bag.write(trajectory(motion, qdd, evaluation.computed, k), topic, received);
  }
  bag.finish();
}

}  // namespace inverse_dynamics_ros

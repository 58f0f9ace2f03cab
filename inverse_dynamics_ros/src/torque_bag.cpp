// SPDX-License-Identifier: Apache-2.0

#include "torque_bag.hpp"

#include <inverse_dynamics_evaluation/joint_state_writer.hpp>
#include <rclcpp/duration.hpp>

#include "interrupted.hpp"
#include "output_bag.hpp"

namespace inverse_dynamics_ros {
namespace {

using Eigen::Index;
using inverse_dynamics_evaluation::SampleTable;
using trajectory_msgs::msg::JointTrajectory;
using trajectory_msgs::msg::JointTrajectoryPoint;

std::vector<double> numbers(const Eigen::Ref<const Eigen::MatrixXd>& matrix, Index k) {
  const auto column = matrix.col(k);
  return {column.data(), column.data() + column.size()};
}

// The trajectory whose first sample is k; k then is the first of the next one.
JointTrajectory trajectory(const RecordedMotion& motion,
                           const Eigen::Ref<const Eigen::MatrixXd>& qdd,
                           const Eigen::Ref<const Eigen::MatrixXd>& effort, Index& k) {
  const SampleTable& log = *motion.log;
  const std::size_t message = motion.message[static_cast<std::size_t>(k)];
  JointTrajectory result;
  result.header = motion.headers[message];
  result.joint_names = log.joint_names;
  for (; k < log.size() && motion.message[static_cast<std::size_t>(k)] == message; ++k) {
    JointTrajectoryPoint point;
    point.positions = numbers(log.q, k);
    point.velocities = numbers(log.qd, k);
    point.accelerations = numbers(qdd, k);
    point.effort = numbers(effort, k);
    point.time_from_start =
        rclcpp::Duration::from_nanoseconds(log.receive_stamps[k] - motion.receive_stamps[message]);
    result.points.push_back(point);
  }
  return result;
}

// As `ids` writes them.
void writeJointStates(const std::string& target, const std::string& storage,
                      const std::string& topic, const RecordedMotion& motion,
                      const SampleTable& table) {
  namespace recordings = inverse_dynamics_evaluation;
  OutputBag bag(target);
  recordings::writeTorques(
      bag.path().string(),
      storage == "mcap" ? recordings::Storage::kMcap : recordings::Storage::kSqlite3,
      {topic, motion.log->joint_names, motion.log->frame_id},
      {static_cast<std::size_t>(table.size()), table.header_stamps.data(),
       table.receive_stamps.data(), table.q.data(), table.qd.data(), table.computed.data()},
      table.measured.data(), [](double) { requireNoInterrupt(); });
  bag.finish();
}

void writeTrajectories(const std::string& target, const std::string& storage,
                       const std::string& topic, const RecordedMotion& motion,
                       const SampleTable& table) {
  OutputBag bag(target, storage);
  for (Index k = 0; k < table.size();) {
    requireNoInterrupt();
    const std::size_t message = motion.message[static_cast<std::size_t>(k)];
    const std::int64_t received = motion.receive_stamps[message];
    Index next = k;
    if (table.measured.size() > 0) {
      bag.write(trajectory(motion, table.qdd, table.measured, next), topic + "_gt", received);
    }
    bag.write(trajectory(motion, table.qdd, table.computed, k), topic, received);
  }
  bag.finish();
}

}  // namespace

void writeTorques(const std::string& target, const std::string& storage, const std::string& topic,
                  const RecordedMotion& motion, const Evaluation& evaluation) {
  const auto write = motion.type == kJointState ? writeJointStates : writeTrajectories;
  write(target, storage, topic, motion, *evaluation.table);
}

}  // namespace inverse_dynamics_ros

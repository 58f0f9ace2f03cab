// SPDX-License-Identifier: Apache-2.0

#include "torque_bag.hpp"

#include <cstddef>
#include <inverse_dynamics_evaluation/joint_matching.hpp>
#include <inverse_dynamics_evaluation/joint_state_writer.hpp>
#include <inverse_dynamics_evaluation/recording.hpp>
#include <inverse_dynamics_evaluation/sample_table.hpp>
#include <string>
#include <trajectory_msgs/msg/joint_trajectory.hpp>
#include <trajectory_msgs/msg/joint_trajectory_point.hpp>
#include <vector>

#include "output_bag.hpp"
#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using Eigen::Index;
using inverse_dynamics_evaluation::SampleTable;
using inverse_dynamics_evaluation::Storage;
using trajectory_msgs::msg::JointTrajectory;
using trajectory_msgs::msg::JointTrajectoryPoint;

std::vector<double> numbers(const Eigen::Ref<const Eigen::MatrixXd>& matrix, Index k) {
  const auto column = matrix.col(k);
  return {column.data(), column.data() + column.size()};
}

// The joints of a trajectory whose first point is sample k of the table, with other efforts.
JointTrajectory trajectory(const JointTrajectory& given, const SampleTable& table,
                           const Eigen::Ref<const Eigen::MatrixXd>& effort, Index k) {
  JointTrajectory result;
  result.header = given.header;
  result.joint_names = table.joint_names;
  for (const JointTrajectoryPoint& original : given.points) {
    JointTrajectoryPoint point;
    point.positions = numbers(table.q, k);
    point.velocities = numbers(table.qd, k);
    point.accelerations = numbers(table.qdd, k);
    point.effort = numbers(effort, k++);
    point.time_from_start = original.time_from_start;
    result.points.push_back(point);
  }
  return result;
}

// By the writer of `ids`.
void writeJointStates(const std::string& target, Storage storage, const std::string& topic,
                      const SampleTable& table) {
  OutputBag bag(target);
  inverse_dynamics_evaluation::writeTorques(
      bag.path().string(), storage, {topic, table.joint_names, table.frame_id},
      {static_cast<std::size_t>(table.size()), table.header_stamps.data(),
       table.receive_stamps.data(), table.q.data(), table.qd.data(), table.computed.data()},
      table.measured.data(), [](double) { requireNoInterrupt(); });
  bag.finish();
}

void writeTrajectories(const std::string& target, Storage storage, const std::string& topic,
                       const std::vector<RecordedTrajectory>& trajectories,
                       const SampleTable& table) {
  OutputBag bag(target, name(storage));
  inverse_dynamics_evaluation::JointMatching matching(table.joint_names);
  Index k = 0;  // the first sample of a trajectory
  for (const auto& [given, received] : trajectories) {
    requireNoInterrupt();
    const auto found = matching.match(given.joint_names);
    if (given.points.empty() || found == inverse_dynamics_evaluation::JointMatching::Found::kNone) {
      continue;  // left out
    }
    if (table.measured.size() > 0) {
      bag.write(trajectory(given, table, table.measured, k), topic + "_gt", received);
    }
    bag.write(trajectory(given, table, table.computed, k), topic, received);
    k += static_cast<Index>(given.points.size());
  }
  bag.finish();
}

}  // namespace

void writeTorques(const std::string& target, Storage storage, const std::string& topic,
                  const RecordedMotion& motion, const Evaluation& evaluation) {
  const SampleTable& table = *evaluation.table;
  if (motion.trajectories.empty()) return writeJointStates(target, storage, topic, table);
  writeTrajectories(target, storage, topic, motion.trajectories, table);
}

}  // namespace inverse_dynamics_ros

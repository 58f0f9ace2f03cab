// SPDX-License-Identifier: Apache-2.0

#include "retiming.hpp"

#include <algorithm>
#include <cstddef>
#include <inverse_dynamics_control/joint_parameters.hpp>
#include <inverse_dynamics_evaluation/joint_matching.hpp>
#include <rclcpp/duration.hpp>

#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using inverse_dynamics_evaluation::listed;
using inverse_dynamics_timing::Path;
using inverse_dynamics_timing::Retimed;
using inverse_dynamics_timing::Trajectory;

constexpr double kRounding = 1e-6;  // rad

void copy(const VectorXd& from, std::vector<double>& to) { to.assign(from.begin(), from.end()); }

}  // namespace

Retiming::Retiming(const NodeRobot& robot, const std::string& description,
                   const retime::Params& params)
    : solver_(robot.makeSolver(description)),
      load_(solver_, {}, 0.0),
      tip_(robot.tipLink(description)),
      joints_(
          inverse_dynamics_evaluation::recordedNames(robot.configuration(), solver_->jointNames())),
      params_(params) {
  describeLimits(description);
}

void Retiming::describeLimits(const std::string& description) {
  const auto described =
      inverse_dynamics_control::describedLimits(description, solver_->jointNames());
  const auto chosen = [this](const std::string& name, const std::vector<double>& given,
                             const chain_dynamics::OwnedVector& otherwise) {
    return inverse_dynamics_control::jointNumbers("limits." + name, given, joints_, otherwise);
  };
  limits_.torque = chosen("torque", params_.limits.torque, described.effort);
  if (!limits_.torque.allFinite()) {
    throw UserError("parameter 'limits.torque'",
                    "limits of torque [N m], here or in the robot description",
                    "neither for all joints", "set it");
  }
  const auto stated = [](const Eigen::VectorXd& limit) -> chain_dynamics::OwnedVector {
    if (!limit.array().isFinite().any()) return {};
    return limit.cwiseMin(1e6);
  };
  const auto& [lower, upper, velocity, acceleration, deceleration] = described.reference;
  lower_ = lower, upper_ = upper;
  limits_.velocity = chosen("velocity", params_.limits.velocity, velocity).cwiseMin(1e6);
  limits_.acceleration = chosen("acceleration", params_.limits.acceleration,
                                stated(acceleration.cwiseMin(deceleration)));
  limits_.jerk = chosen("jerk", params_.limits.jerk, stated(described.jerk));
}

void Retiming::carry(const inverse_dynamics_control::RigidBody& body) {
  load_.aimAt(body);
  load_.advance(0.0);
}

Retiming::JointTrajectory Retiming::timed(const JointTrajectory& path,
                                          const PathOptions& options) const {
  if (!(options.slower >= 1.0)) {
    throw UserError("slower", "a number of at least 1", std::to_string(options.slower),
                    "limits of velocity and acceleration are parameters");
  }
  const Eigen::MatrixXd points = waypoints(path);
  const double deviation = options.deviation.value_or(params_.deviation);
  const Path way = deviation < 0 ? Path::spline(points, options.stops)
                                 : Path::lines(points, deviation, options.stops);
  checkRanges(way);
  inverse_dynamics_timing::RetimeOptions choices;
  choices.margin = params_.margin;
  const Retimed fastest = inverse_dynamics_timing::retime(*solver_, way, limits_, choices);
  if (!fastest) throw UserError(inverse_dynamics_timing::text(fastest.refusal, joints_));
  JointTrajectory result =
      sampled(inverse_dynamics_timing::slowed(fastest.trajectory, options.slower));
  result.header = path.header;
  return result;
}

// n x m, rad
Eigen::MatrixXd Retiming::waypoints(const JointTrajectory& path) const {
  const auto& names = path.joint_names;
  if (names.size() != joints_.size() ||
      !std::is_permutation(names.begin(), names.end(), joints_.begin())) {
    throw UserError("path", "the joints " + listed(joints_), listed(names),
                    "see the parameter 'joints'");
  }
  Eigen::MatrixXd points(names.size(), path.points.size());
  for (std::size_t k = 0; k < path.points.size(); ++k) {
    const std::vector<double>& q = path.points[k].positions;
    if (q.size() != names.size()) {
      throw UserError("path: point " + std::to_string(k), "a position for each joint",
                      std::to_string(q.size()), "complete it");
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto joint = std::find(joints_.begin(), joints_.end(), names[i]) - joints_.begin();
      points(joint, static_cast<Index>(k)) = q[i];
    }
  }
  return points;
}

// A spline may leave them between waypoints.
void Retiming::checkRanges(const Path& path) const {
  const Eigen::MatrixXd ranges = path.positionRanges();
  for (Index j = 0; j < ranges.rows(); ++j) {
    const double least = ranges(j, 0), most = ranges(j, 1);
    if (least >= lower_[j] - kRounding && most <= upper_[j] + kRounding) continue;
    throw UserError(
        "path: joint " + joints_[static_cast<std::size_t>(j)],
        "positions from " + std::to_string(lower_[j]) + " to " + std::to_string(upper_[j]) + " rad",
        std::to_string(least) + " to " + std::to_string(most),
        "move waypoints, or set deviation for straight lines between them");
  }
}

Retiming::JointTrajectory Retiming::sampled(const Trajectory& motion) const {
  JointTrajectory result;
  result.joint_names = joints_;
  const VectorXd times = inverse_dynamics_timing::sampleTimes(motion.duration(), params_.rate);
  result.points.resize(static_cast<std::size_t>(times.size()));
  VectorXd q(lower_.size()), qd(q), qdd(q);
  for (Index k = 0; k < times.size(); ++k) {
    motion.evaluate(times[k], q, qd, qdd);
    auto& point = result.points[static_cast<std::size_t>(k)];
    point.time_from_start = rclcpp::Duration::from_seconds(times[k]);
    copy(q, point.positions);
    copy(qd, point.velocities);
    copy(qdd, point.accelerations);
    copy(solver_->getTorques(q, qd, qdd), point.effort);
  }
  return result;
}

}  // namespace inverse_dynamics_ros

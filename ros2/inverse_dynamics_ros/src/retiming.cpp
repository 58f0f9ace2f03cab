// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_ros/retiming.hpp"

#include <algorithm>
#include <cstddef>
#include <inverse_dynamics_control/joint_parameters.hpp>
#include <inverse_dynamics_evaluation/joint_matching.hpp>
#include <inverse_dynamics_ros/retime_parameters.hpp>
#include <inverse_dynamics_ros/robot_parameters.hpp>
#include <inverse_dynamics_solver/friction_memory.hpp>
#include <rclcpp/duration.hpp>

#include "robot_parameters.hpp"
#include "user_error.hpp"

namespace inverse_dynamics_ros {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using inverse_dynamics_evaluation::listed;
using inverse_dynamics_timing::MotionLimits;
using inverse_dynamics_timing::Path;
using inverse_dynamics_timing::Retimed;
using inverse_dynamics_timing::Trajectory;

constexpr double kRounding = 1e-6;  // rad

void copy(const VectorXd& from, std::vector<double>& to) { to.assign(from.begin(), from.end()); }

}  // namespace

Retiming Retiming::ofNode(rclcpp::Node& node, const std::string& prefix) {
  const robot_parameters::ParamListener of_robot(&node, prefix);
  const retime::ParamListener of_paths(&node, prefix);
  const NodeRobot robot(givenParameters(node, prefix));
  std::string description = robot.description();
  if (description.empty()) node.get_parameter("robot_description", description);
  return Retiming(robot, description, of_paths.get_params());
}

Retiming::Retiming(const NodeRobot& robot, const std::string& description,
                   const retime::Params& params)
    : solver_(robot.makeSolver(description)),
      load_(solver_, {}, 0.0),
      tip_(robot.tipLink(description, solver_->tipNames())),
      joints_(
          inverse_dynamics_evaluation::recordedNames(robot.configuration(), solver_->jointNames())),
      deviation_(params.deviation),
      rate_(params.rate),
      margin_(params.margin) {
  describeLimits(description, params);
}

void Retiming::describeLimits(const std::string& description, const retime::Params& params) {
  const auto described =
      inverse_dynamics_control::describedLimits(description, solver_->jointNames());
  const auto chosen = [this](const std::string& name, const std::vector<double>& given,
                             const chain_dynamics::OwnedVector& otherwise) {
    return inverse_dynamics_control::jointNumbers("limits." + name, given, joints_, otherwise);
  };
  limits_.torque = chosen("torque", params.limits.torque, described.effort);
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
  limits_.velocity = chosen("velocity", params.limits.velocity, velocity).cwiseMin(1e6);
  limits_.acceleration = chosen("acceleration", params.limits.acceleration,
                                stated(acceleration.cwiseMin(deceleration)));
  limits_.jerk = chosen("jerk", params.limits.jerk, stated(described.jerk));
}

void Retiming::carry(const inverse_dynamics_control::RigidBody& body) {
  load_.aimAt(body);
  load_.advance(0.0);
}

Path Retiming::path(const JointTrajectory& waypoints, const std::vector<Index>& stops,
                    std::optional<double> deviation) const {
  const Eigen::MatrixXd points = pointsOf(waypoints);
  const double rounding = deviation.value_or(deviation_);
  Path path = rounding < 0 ? Path::spline(points, stops) : Path::lines(points, rounding, stops);
  checkRanges(path);
  return path;
}

MotionLimits Retiming::limits(const std::vector<std::string>& joints,
                              const PathLimits& given) const {
  const std::vector<Index> places = placesOf(joints);
  MotionLimits limits = limits_;
  const auto replace = [&](const std::string& name, const std::vector<double>& numbers,
                           chain_dynamics::OwnedVector& limit) {
    if (numbers.empty()) return;
    const auto in_order = inverse_dynamics_control::jointNumbers(name, numbers, joints);
    if (!(in_order.array() > 0).all()) {
      throw UserError(name, "numbers above 0", std::to_string(in_order.minCoeff()), "correct it");
    }
    limit.resize(in_order.size());
    for (Index i = 0; i < in_order.size(); ++i)
      limit[places[static_cast<std::size_t>(i)]] = in_order[i];
  };
  replace("torque_limits", given.torque, limits.torque);
  replace("velocity_limits", given.velocity, limits.velocity);
  replace("acceleration_limits", given.acceleration, limits.acceleration);
  replace("jerk_limits", given.jerk, limits.jerk);
  return limits;
}

Retiming::JointTrajectory Retiming::timed(const Path& path, const MotionLimits& limits,
                                          double slower) const {
  inverse_dynamics_timing::RetimeOptions choices;
  choices.margin = margin_;
  const Retimed fastest = inverse_dynamics_timing::retime(*solver_, path, limits, choices);
  if (!fastest) throw UserError(inverse_dynamics_timing::text(fastest.refusal, joints_));
  return sampled(inverse_dynamics_timing::slowed(fastest.trajectory, slower));
}

// Where the joints of the names are in the chain.
std::vector<Index> Retiming::placesOf(const std::vector<std::string>& names) const {
  if (names.size() != joints_.size() ||
      !std::is_permutation(names.begin(), names.end(), joints_.begin())) {
    throw UserError("path", "the joints " + listed(joints_), listed(names),
                    "see the parameter 'joints'");
  }
  std::vector<Index> places;
  for (const std::string& name : names) {
    places.push_back(std::find(joints_.begin(), joints_.end(), name) - joints_.begin());
  }
  return places;
}

// n x m, rad
Eigen::MatrixXd Retiming::pointsOf(const JointTrajectory& waypoints) const {
  const std::vector<Index> places = placesOf(waypoints.joint_names);
  Eigen::MatrixXd points(places.size(), waypoints.points.size());
  for (std::size_t k = 0; k < waypoints.points.size(); ++k) {
    const std::vector<double>& q = waypoints.points[k].positions;
    if (q.size() != places.size()) {
      throw UserError("path: point " + std::to_string(k), "a position for each joint",
                      std::to_string(q.size()), "complete it");
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
      points(places[i], static_cast<Index>(k)) = q[i];
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
  const VectorXd times = inverse_dynamics_timing::sampleTimes(motion.duration(), rate_);
  result.points.resize(static_cast<std::size_t>(times.size()));
  VectorXd q(lower_.size()), qd(q), qdd(q), tau(q);
  auto friction = inverse_dynamics_solver::frictionState(*solver_);
  for (Index k = 0; k < times.size(); ++k) {
    motion.evaluate(times[k], q, qd, qdd);
    solver_->getTorques(q, qd, qdd, tau);
    friction.move(q);
    friction.addTo(qd, tau);
    auto& point = result.points[static_cast<std::size_t>(k)];
    point.time_from_start = rclcpp::Duration::from_seconds(times[k]);
    copy(q, point.positions);
    copy(qd, point.velocities);
    copy(qdd, point.accelerations);
    copy(tau, point.effort);
  }
  return result;
}

}  // namespace inverse_dynamics_ros

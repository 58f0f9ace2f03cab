// SPDX-License-Identifier: Apache-2.0

/// @file
/// Diagnostics of the live node.

#pragma once

#include <chrono>
#include <cstdint>
#include <diagnostic_updater/diagnostic_updater.hpp>
#include <rclcpp/node.hpp>
#include <string>
#include <utility>

namespace inverse_dynamics_ros {

/// Numbers of messages by outcome.
struct LiveCounts {
  std::int64_t received = 0;       ///< messages of the joints
  std::int64_t computed = 0;       ///< torques published
  std::int64_t other_joints = 0;   ///< messages of other joints
  std::int64_t missing = 0;        ///< messages without some of the joints
  std::int64_t no_velocities = 0;  ///< messages without positions or velocities
  std::int64_t not_finite = 0;     ///< messages with a NaN or infinity
  std::int64_t no_efforts = 0;     ///< messages without measured efforts to compare with
  std::int64_t repeated = 0;       ///< messages with the stamp of the one before
  std::int64_t clock_jumps = 0;    ///< stamps that went back
  std::int64_t gaps = 0;           ///< pauses that the filter can't bridge
};

/// Thresholds of diagnostics.
struct LiveLimits {
  double max_age = 1.0;   ///< s
  double min_rate = 0.0;  ///< Hz
};

/// Tasks of a diagnostic_updater: the solver, the joint states, and others. Their names begin with the
/// node's full name, `/left/live: solver`.
class LiveDiagnostics {
 public:
  LiveDiagnostics(rclcpp::Node& node, std::string topic, LiveLimits limits);

  /// A further task.
  template <class Report>
  void add(const std::string& name, Report report) {
    updater_.add(name, std::move(report));
  }

  LiveCounts& counts() { return counts_; }

  /// Notes a message; `latency` [s] from its stamp to now.
  void arrived(double latency);

  /// Sets the solver's report. @param ready  whether torques can be computed.
  void setSolver(bool ready, const std::string& text) {
    ready_ = ready;
    solver_text_ = text;
  }

  /// Sets the hardware's id: the node's namespace and the robot.
  void setRobot(const std::string& robot) { updater_.setHardwareID(namespace_ + robot); }

  /// Joints that are missing, or empty.
  void setMissing(const std::string& joints) { missing_ = joints; }

 private:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;
  using SteadyClock = std::chrono::steady_clock;

  void reportSolver(Status& status) const;
  void reportJointStates(Status& status);
  void summarize(Status& status, double age, double rate) const;

  std::string namespace_;  // with a slash at its end
  std::string topic_;
  LiveLimits limits_;
  LiveCounts counts_, reported_;  // now, and at the last report
  SteadyClock::time_point reported_at_ = SteadyClock::now();
  SteadyClock::time_point arrived_at_ = SteadyClock::now();
  double latency_ = 0;  // s
  bool ready_ = false;
  std::string solver_text_, missing_;
  diagnostic_updater::Updater updater_;  // last: calls the tasks as soon as it is there
};

}  // namespace inverse_dynamics_ros

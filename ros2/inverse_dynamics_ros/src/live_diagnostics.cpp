// SPDX-License-Identifier: Apache-2.0

#include "live_diagnostics.hpp"

#include <diagnostic_msgs/msg/diagnostic_status.hpp>
#include <string>
#include <utility>

namespace inverse_dynamics_ros {

using diagnostic_msgs::msg::DiagnosticStatus;

LiveDiagnostics::LiveDiagnostics(rclcpp::Node& node, std::string topic, LiveLimits limits)
    : namespace_(node.get_namespace()),
      topic_(std::move(topic)),
      limits_(limits),
      updater_((node.declare_parameter("diagnostic_updater.use_fqn", true), &node)) {
  if (namespace_.back() != '/') namespace_ += '/';
  setRobot("unknown");
  updater_.add("solver", [this](Status& status) { reportSolver(status); });
  updater_.add("joint states", [this](Status& status) { reportJointStates(status); });
}

void LiveDiagnostics::arrived(double latency) {
  arrived_at_ = SteadyClock::now();
  latency_ = latency;
  ++counts_.received;
}

void LiveDiagnostics::reportSolver(Status& status) const {
  status.summary(ready_ ? DiagnosticStatus::OK : DiagnosticStatus::WARN, solver_text_);
}

void LiveDiagnostics::reportJointStates(Status& status) {
  const auto now = SteadyClock::now();
  const auto seconds = [now](SteadyClock::time_point begin) {
    return std::chrono::duration<double>(now - begin).count();
  };
  const double age = seconds(arrived_at_);
  const double rate =
      static_cast<double>(counts_.received - reported_.received) / seconds(reported_at_);
  summarize(status, age, rate);
  status.add("topic", topic_);
  status.add("rate [Hz]", rate);
  status.add("age of the latest [s]", age);
  status.add("stamp to reception [s]", latency_);
  status.add("missing joints", missing_.empty() ? "none" : missing_);
  status.add("joint states", counts_.received);
  status.add("torques computed", counts_.computed);
  status.add("messages of other joints", counts_.other_joints);
  status.add("without some joints", counts_.missing);
  status.add("without positions or velocities", counts_.no_velocities);
  status.add("not finite", counts_.not_finite);
  status.add("without efforts", counts_.no_efforts);
  status.add("repeated stamps", counts_.repeated);
  status.add("clock jumps back", counts_.clock_jumps);
  status.add("gaps", counts_.gaps);
  reported_ = counts_;
  reported_at_ = now;
}

// The worst of what happened since the last report.
void LiveDiagnostics::summarize(Status& status, double age, double rate) const {
  status.summary(DiagnosticStatus::OK, "joint states arrive");
  if (counts_.no_efforts > reported_.no_efforts) {
    status.mergeSummary(DiagnosticStatus::WARN, "no efforts to compare with");
  }
  if (counts_.clock_jumps > reported_.clock_jumps) {
    status.mergeSummary(DiagnosticStatus::WARN, "the clock jumped back");
  }
  if (rate < limits_.min_rate) status.mergeSummary(DiagnosticStatus::WARN, "slower than min_rate");
  if (counts_.not_finite > reported_.not_finite) {
    status.mergeSummary(DiagnosticStatus::WARN, "positions or velocities that aren't finite");
  }
  if (counts_.no_velocities > reported_.no_velocities) {
    status.mergeSummary(DiagnosticStatus::ERROR, "no positions or velocities");
  }
  if (!missing_.empty()) {
    status.mergeSummary(DiagnosticStatus::ERROR, "missing joints: " + missing_);
  }
  if (counts_.received == 0) {
    status.mergeSummary(age > limits_.max_age ? DiagnosticStatus::ERROR : DiagnosticStatus::WARN,
                        "no joint states yet on " + topic_);
  } else if (age > limits_.max_age) {
    status.mergeSummary(DiagnosticStatus::ERROR, "no joint states any more on " + topic_);
  }
}

}  // namespace inverse_dynamics_ros

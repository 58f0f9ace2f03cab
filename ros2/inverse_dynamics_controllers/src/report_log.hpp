// SPDX-License-Identifier: Apache-2.0
/// @file
/// Sentences for the log, written by another thread than the control loop, which may not log.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>

namespace inverse_dynamics_controllers {

/// Counters of the control loop need no memory order.
constexpr auto kRelaxed = std::memory_order_relaxed;

/// A sentence for the log.
struct ReportLine {
  bool is_error;  ///< else a warning
  std::string text;
};

/// Logs a report's lines, once a second.
///
/// @tparam Report  takeLines(): what happened since the last call, as ReportLine.
template <class Report>
rclcpp::TimerBase::SharedPtr logEverySecond(
    const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
    const std::shared_ptr<Report>& report) {
  const rclcpp::Logger logger = node->get_logger();
  return node->create_wall_timer(std::chrono::seconds(1), [logger, report] {
    for (const ReportLine& line : report->takeLines()) {
      if (line.is_error) {
        RCLCPP_ERROR(logger, "%s", line.text.c_str());
      } else {
        RCLCPP_WARN(logger, "%s", line.text.c_str());
      }
    }
  });
}

}  // namespace inverse_dynamics_controllers

// SPDX-License-Identifier: Apache-2.0
/// @file
/// References of a chainable controller: from the controller before it, or from a topic.
#pragma once

#include <algorithm>
#include <inverse_dynamics_control/reference_guard.hpp>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "reference_layout.hpp"
#include "reference_topic.hpp"
#include "update_report.hpp"

namespace inverse_dynamics_controllers {

/// Reads references, guards them, and stops for good where they are lost. Not thread-safe.
///
/// Real time: all methods but the constructor: no allocation, lock, exception or
/// system call.
class ReferenceInput {
 public:
  /// @param timeout  how long a motion from the topic is good [s].
  ReferenceInput(const std::shared_ptr<rclcpp_lifecycle::LifecycleNode>& node,
                 const ReferenceLayout& layout, const std::vector<std::string>& joints,
                 inverse_dynamics_control::ReferenceGuard guard, double timeout)
      : layout_(layout),
        topic_(node, layout, joints, timeout),
        guard_(std::move(guard)),
        desired_(static_cast<Eigen::Index>(joints.size())),
        timeout_(timeout) {}

  const ReferenceLayout& layout() const noexcept { return layout_; }

  /// A stop from the measured state until a reference is written; forgets an earlier stop.
  void start(const inverse_dynamics_control::JointState& state,
             std::vector<double>& values) noexcept {
    topic_.read(values);  // discards an old message
    std::fill(values.begin(), values.end(), std::numeric_limits<double>::quiet_NaN());
    guard_.start(state.q, state.qd);
    motion_written_ = effort_written_ = false;
    motion_ = nullptr;
    age_ = std::numeric_limits<double>::infinity();  // of none
  }

  /// The newest message of the topic, for a controller that nothing precedes.
  void readTopic(std::vector<double>& values) noexcept {
    if (topic_.read(values)) restartAge();
  }

  /// Counts the cycle's time, and stops where the topic has been silent for too long.
  ///
  /// @param state   measured.
  /// @param period  s since the last cycle.
  void advance(const std::vector<double>& values, bool chained,
               const inverse_dynamics_control::JointState& state, double period,
               UpdateReport& report) noexcept {
    using inverse_dynamics_control::StopReason;
    const bool was_stopped = guard_.stopped(), was_ramping = guard_.ramping();
    motion_written_ = motion_written_ || !layout_.motionIsUntouched(values);
    effort_written_ = effort_written_ || !layout_.effortIsUntouched(values);
    if (period > 0) age_ += period;
    if (!chained && age_ > timeout_ && (guard_.isMoving() || effort_written_)) {
      guard_.stop(StopReason::kStale);
    }
    if (motion_written_) {
      if (layout_.readMotion(values, desired_) && chained) restartAge();
      // After a pause a motion begins where the last one ended.
      const double interval = interval_ > timeout_ ? period : std::max(interval_, period);
      motion_ = &guard_.next(desired_, period, interval, state);
    } else {
      motion_ = &guard_.again(period);
    }
    if (guard_.stopped() && !was_stopped) report.noteStop(guard_.reason(), guard_.joint());
    if (guard_.ramping() && !was_ramping) report.noteRamp();
  }

  /// The motion to follow in this cycle; null before the first advance() and without a motion among
  /// the references.
  const inverse_dynamics_control::Reference* motion() const noexcept {
    return layout_.hasMotion() ? motion_ : nullptr;
  }

  /// The effort of the controller before; zero before it has written any.
  void effort(const std::vector<double>& values, Eigen::VectorXd& effort) const noexcept {
    effort.setZero();
    if (effort_written_ && !stopped()) layout_.readEffort(values, effort);
  }

  /// Whether references are ignored until the next start().
  bool stopped() const noexcept { return guard_.stopped(); }

 private:
  void restartAge() noexcept {
    interval_ = age_;
    age_ = 0.0;
  }

  ReferenceLayout layout_;
  ReferenceTopic topic_;
  inverse_dynamics_control::ReferenceGuard guard_;
  inverse_dynamics_control::Reference desired_;
  const inverse_dynamics_control::Reference* motion_ = nullptr;  // of the guard, from advance() on
  bool motion_written_ = false, effort_written_ = false;
  double timeout_;                     // s
  double age_ = 0.0, interval_ = 0.0;  // of the newest reference, and between it and the one before
};

}  // namespace inverse_dynamics_controllers

// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a controller commanded last, for the one that takes over from it: its limits.effort_rate
/// goes on from there.
#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_control/signals.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace inverse_dynamics_controllers {

/// The last efforts of a robot, shared by its controllers, which a manager switches in one thread.
class HandOver {
 public:
  explicit HandOver(Eigen::Index joints) : state_(joints), tau_(Eigen::VectorXd::Zero(joints)) {}

  /// @param robot  the same text for controllers that command the same joints in the same order.
  static std::shared_ptr<HandOver> of(const std::string& robot, Eigen::Index joints) {
    static std::mutex mutex;
    static std::map<std::string, std::weak_ptr<HandOver>> all;
    const std::lock_guard<std::mutex> lock(mutex);
    std::shared_ptr<HandOver> found = all[robot].lock();
    if (!found) all[robot] = found = std::make_shared<HandOver>(joints);
    return found;
  }

  /// A controller ends. Real time, as take(): no allocation, lock, exception or system call.
  void leave(const inverse_dynamics_control::JointState& state,
             const Eigen::VectorXd& tau) noexcept {
    state_ = state;
    tau_ = tau;
    left_ = true;
  }

  /// What the controller before has left at this measured state, in the same cycle; null: nothing,
  /// or at another one, from which the robot has been moved since.
  const Eigen::VectorXd* take(const inverse_dynamics_control::JointState& state) noexcept {
    const bool same = state.q == state_.q && state.qd == state_.qd;
    return std::exchange(left_, false) && same ? &tau_ : nullptr;
  }

 private:
  inverse_dynamics_control::JointState state_;
  Eigen::VectorXd tau_;
  bool left_ = false;
};

}  // namespace inverse_dynamics_controllers

// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a controller commanded last, and the positions that it knew, for the one that takes over.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <inverse_dynamics_control/control_law.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace inverse_dynamics_controllers {

/// The last efforts of a robot, shared by its controllers, which a manager switches in one thread.
class HandOver {
 public:
  explicit HandOver(Eigen::Index joints)
      : state_(joints), tau_(Eigen::VectorXd::Zero(joints)), position_(tau_) {}

  /// @param robot  the same text for controllers that command the same joints in the same order.
  static std::shared_ptr<HandOver> of(const std::string& robot, Eigen::Index joints) {
    static std::mutex mutex;
    static std::map<std::string, std::weak_ptr<HandOver>> all;
    const std::lock_guard<std::mutex> lock(mutex);
    std::shared_ptr<HandOver> found = all[robot].lock();
    if (!found) all[robot] = found = std::make_shared<HandOver>(joints);
    return found;
  }

  /// A controller ends. Real time, as start(): no allocation, lock, exception or system call.
  void leave(const inverse_dynamics_control::JointState& state, const Eigen::VectorXd& tau,
             const Eigen::VectorXd& position) noexcept {
    state_ = state;
    tau_ = tau;
    position_ = position;
    left_at_ = Clock::now();
  }

  /// Starts the law of the next one: from these efforts where another one has ended at this measured
  /// state, in the same cycle; not where the robot may have been moved since.
  ///
  /// @param[out] tau  the efforts, where it takes over.
  /// @return whether it takes over.
  bool start(const inverse_dynamics_control::JointState& state,
             inverse_dynamics_control::ControlLaw& law, Eigen::VectorXd& tau) const noexcept {
    const bool takes_over = Clock::now() - left_at_ < kLongestCycle && areSame(state.q, state_.q) &&
                            areSame(state.qd, state_.qd);
    if (!takes_over) {
      law.start();
      return false;
    }
    law.start(tau_, position_);
    tau = tau_;
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kLongestCycle{1};

  // What is lost in both is the same.
  static bool areSame(const Eigen::VectorXd& a, const Eigen::VectorXd& b) noexcept {
    return (a.array() == b.array() || (a.array().isNaN() && b.array().isNaN())).all();
  }

  inverse_dynamics_control::JointState state_;
  Eigen::VectorXd tau_, position_;
  Clock::time_point left_at_{};  // the start of the computer
};

}  // namespace inverse_dynamics_controllers

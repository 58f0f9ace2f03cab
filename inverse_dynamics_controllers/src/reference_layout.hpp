// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a chainable controller's reference interfaces mean, and the numbers behind them.
#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_control/signals.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {

/// The order of a controller's references: joint by joint, interface by interface.
class ReferenceLayout {
 public:
  ReferenceLayout() = default;

  /// @param interfaces  position and velocity, with acceleration or without; effort; or both.
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: another combination.
  ReferenceLayout(const std::vector<std::string>& interfaces,
                  const std::vector<std::string>& joints);

  /// Names below the controller's: `joint/position`, ...
  const std::vector<std::string>& names() const noexcept { return names_; }
  std::size_t size() const noexcept { return names_.size(); }

  bool hasMotion() const noexcept { return position_ >= 0; }
  bool hasAcceleration() const noexcept { return acceleration_ >= 0; }
  bool hasEffort() const noexcept { return effort_ >= 0; }

  /// Whether no motion, or no effort, has been written since all numbers were NaN.
  /// Real time, as all that follow: no allocation, lock, exception or system call.
  bool motionIsUntouched(const std::vector<double>& values) const noexcept;
  bool effortIsUntouched(const std::vector<double>& values) const noexcept;

  /// Motion of the references; zero acceleration where there is none among them.
  void readMotion(const std::vector<double>& values,
                  inverse_dynamics_control::Reference& reference) const noexcept;

  /// Effort of the references [N m].
  void readEffort(const std::vector<double>& values, Eigen::VectorXd& effort) const noexcept;

  /// Puts a number of joint j into place: position, velocity, acceleration or effort, if it is
  /// among the references.
  void setPosition(std::size_t j, double q, std::vector<double>& values) const noexcept;
  void setVelocity(std::size_t j, double qd, std::vector<double>& values) const noexcept;
  void setAcceleration(std::size_t j, double qdd, std::vector<double>& values) const noexcept;
  void setEffort(std::size_t j, double effort, std::vector<double>& values) const noexcept;

 private:
  double at(const std::vector<double>& values, Eigen::Index j, int offset) const noexcept;
  void set(std::size_t j, int offset, double value, std::vector<double>& values) const noexcept;
  bool isUntouched(const std::vector<double>& values, int offset) const noexcept;

  std::vector<std::string> names_;
  std::size_t joints_ = 0, stride_ = 0;
  int position_ = -1, velocity_ = -1, acceleration_ = -1, effort_ = -1;  // among a joint's, or -1
};

}  // namespace inverse_dynamics_controllers

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Meaning and order of a chainable controller's reference interfaces.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <inverse_dynamics_control/signals.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {

/// The order of a controller's references: joint by joint, interface by interface.
class ReferenceLayout {
 public:
  enum Interface { kPosition, kVelocity, kAcceleration, kEffort };

  ReferenceLayout() = default;

  /// @param interfaces  position and velocity, with acceleration or without; effort; or both.
  /// Throws inverse_dynamics_solver::InvalidParameterValueException: another combination.
  ReferenceLayout(const std::vector<std::string>& interfaces,
                  const std::vector<std::string>& joints);

  /// Names below the controller's: `joint/position`, ...
  const std::vector<std::string>& names() const noexcept { return names_; }
  std::size_t size() const noexcept { return names_.size(); }

  bool hasMotion() const noexcept { return has(kPosition); }
  bool hasEffort() const noexcept { return has(kEffort); }

  /// Whether no motion, or no effort, has been written since all numbers were NaN.
  /// Real time, as all that follow: no allocation, lock, exception or system call.
  bool motionIsUntouched(const std::vector<double>& values) const noexcept;
  bool effortIsUntouched(const std::vector<double>& values) const noexcept;

  /// Motion of the references; zero acceleration where there is none among them.
  ///
  /// @return whether it is another one than `reference` was.
  bool readMotion(const std::vector<double>& values,
                  inverse_dynamics_control::Reference& reference) const noexcept;

  /// Effort of the references [N m].
  void readEffort(const std::vector<double>& values, Eigen::VectorXd& effort) const noexcept;

  /// Puts a number of joint j into place, if it is among the references.
  void set(Interface interface, std::size_t j, double number,
           std::vector<double>& values) const noexcept {
    if (has(interface)) values[place(interface, j)] = number;
  }

 private:
  bool has(Interface interface) const noexcept { return places_[interface] >= 0; }
  std::size_t place(Interface interface, std::size_t j) const noexcept {
    return j * stride_ + static_cast<std::size_t>(places_[interface]);
  }
  bool isUntouched(const std::vector<double>& values, Interface interface) const noexcept;

  std::vector<std::string> names_;
  std::size_t joints_ = 0, stride_ = 0;
  std::array<int, 4> places_{-1, -1, -1, -1};  // of each interface among a joint's; -1: none
};

}  // namespace inverse_dynamics_controllers

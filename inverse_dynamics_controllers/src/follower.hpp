// SPDX-License-Identifier: Apache-2.0
/// @file
/// A law with the references it follows and the loop it runs in: what configuring makes.
#pragma once

#include <inverse_dynamics_controllers/reference_parameters.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "arm.hpp"
#include "control_loop.hpp"
#include "reference_input.hpp"

namespace inverse_dynamics_controllers {

/// One thread at a time. Real time: update(): no allocation, lock, exception or system call.
class Follower {
 public:
  Follower(ControlLoop loop, ReferenceInput input)
      : loop_(std::move(loop)), input_(std::move(input)) {}
  virtual ~Follower() = default;
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;

  ControlLoop& loop() noexcept { return loop_; }
  ReferenceInput& input() noexcept { return input_; }
  virtual inverse_dynamics_control::ControlLaw& law() noexcept = 0;

  /// Efforts tau of a cycle of dt seconds; the references have been read.
  virtual inverse_dynamics_control::Status update(const inverse_dynamics_control::JointState& state,
                                                  const std::vector<double>& references, double dt,
                                                  Eigen::VectorXd& tau) noexcept = 0;

 private:
  ControlLoop loop_;
  ReferenceInput input_;
};

/// References within the limits of the parameters, or of the robot description.
ReferenceInput referenceInput(const Setup& setup, const ReferenceLayout& layout,
                              const reference_parameters::Params& params);

}  // namespace inverse_dynamics_controllers

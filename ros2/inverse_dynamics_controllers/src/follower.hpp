// SPDX-License-Identifier: Apache-2.0
/// @file
/// A law with its references and its loop, made when a controller is configured.
#pragma once

#include <inverse_dynamics_control/pd_gravity_compensation.hpp>
#include <inverse_dynamics_controllers/reference_parameters.hpp>
#include <utility>
#include <vector>

#include "arm.hpp"
#include "changing_gains.hpp"
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

/// A law whose gains change while it runs, following a motion. Real time: as Follower.
///
/// @tparam Law      made from solver, gains and options; has setGains().
/// @tparam Numbers  its gains.
template <class Law, class Numbers>
class FollowerWithGains : public Follower {
 public:
  FollowerWithGains(const Setup& setup, ReferenceInput input, ChangingGains<Numbers> gains,
                    const inverse_dynamics_control::LawOptions& options)
      : Follower(ControlLoop(setup), std::move(input)),
        gains_(std::move(gains)),
        law_(setup.arm.solver, gains_.initial(), options) {}

  inverse_dynamics_control::ControlLaw& law() noexcept override { return law_; }

  inverse_dynamics_control::Status update(const inverse_dynamics_control::JointState& state,
                                          const std::vector<double>&, double dt,
                                          Eigen::VectorXd& tau) noexcept override {
    if (const Numbers* const changed = gains_.changed()) law_.setGains(*changed);
    return law_.update(state, *input().motion(), dt, tau);
  }

 private:
  ChangingGains<Numbers> gains_;
  Law law_;
};

/// Gains of joint torques, from the parameters gains.p and gains.d.
///
/// Throws inverse_dynamics_solver::InvalidParameterValueException: neither one number nor one per
/// joint.
ChangingGains<inverse_dynamics_control::PdGains> pdGains(const Setup& setup);

/// References within the limits of the parameters, or of the robot description.
ReferenceInput referenceInput(const Setup& setup, const ReferenceLayout& layout,
                              const reference_parameters::Params& params);

}  // namespace inverse_dynamics_controllers

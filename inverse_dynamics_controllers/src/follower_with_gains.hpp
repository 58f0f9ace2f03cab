// SPDX-License-Identifier: Apache-2.0
/// @file
/// A law whose gains change while it runs, following a motion.
#pragma once

#include <utility>
#include <vector>

#include "changing_gains.hpp"
#include "follower.hpp"

namespace inverse_dynamics_controllers {

/// Real time: as Follower.
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

}  // namespace inverse_dynamics_controllers

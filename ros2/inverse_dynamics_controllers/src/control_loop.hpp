// SPDX-License-Identifier: Apache-2.0
/// @file
/// A cycle of any controller: read the joints, ask the law, write efforts, note what happened.
///
///     ControlLoop loop(setup);
///     loop.start(law, state_interfaces_, command_interfaces_, false);  // when activated
///     return loop.cycle(law, state_interfaces_, command_interfaces_, period,
///                       [&](const JointState& state, double dt, Eigen::VectorXd& tau) {
///                         return law.update(state, dt, tau);
///                       });
#pragma once

#include <chain_dynamics/text.hpp>
#include <cmath>
#include <cstddef>
#include <exception>
#include <inverse_dynamics_control/control_law.hpp>
#include <inverse_dynamics_control/fault_latch.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <memory>
#include <rclcpp/duration.hpp>

#include "arm.hpp"
#include "arm_interfaces.hpp"
#include "carried_body.hpp"
#include "changing_damping.hpp"
#include "hand_over.hpp"
#include "state_publisher.hpp"
#include "update_report.hpp"

namespace inverse_dynamics_controllers {

/// The common part of the controllers' cycles. One thread at a time.
class ControlLoop {
 public:
  explicit ControlLoop(const Setup& setup)
      : interfaces_(setup.arm.joints, setup.arm.commands),
        state_(setup.arm.solver->jointCount()),
        tau_(Eigen::VectorXd::Zero(state_.q.size())),
        fault_(setup.parameters.tolerated_fault_time),
        has_fallback_(setup.has_fallback),
        hand_over_(
            HandOver::of(setup.node->get_namespace() + chain_dynamics::joined(setup.arm.commands),
                         state_.q.size())),
        report_(std::make_shared<UpdateReport>(setup.arm.joints)),
        timer_(logEverySecond(setup.node, report_)),
        carried_(setup),
        damping_(changingDamping(setup)),
        publisher_(setup.node, setup.arm.joints, setup.arm.solver->jointTypes(),
                   setup.parameters.state_publish_rate) {}

  const ArmInterfaces& interfaces() const noexcept { return interfaces_; }
  UpdateReport& report() noexcept { return *report_; }

  /// The measured state of the last cycle, or of start().
  const inverse_dynamics_control::JointState& state() const noexcept { return state_; }

  /// Finds the interfaces, and restarts, with the efforts of the controller that it takes over from,
  /// else with the law's safe torque: what is written now may be the hardware's for a cycle before
  /// the first update.
  ///
  /// @param carries_on  whether it takes over without a measured state, too.
  /// Throws inverse_dynamics_solver::Exception: one is missing; the hardware doesn't know where its
  /// joints are; the solver doesn't give gravity there.
  void start(inverse_dynamics_control::ControlLaw& law, const StateInterfaces& states,
             CommandInterfaces& commands, bool carries_on) {
    interfaces_.bind(states, commands);
    interfaces_.read(states, state_);
    const bool takes_over = hand_over_->start(state_, law, tau_);
    for (Eigen::Index j = 0; !(takes_over && carries_on) && j < state_.q.size(); ++j) {
      if (std::isfinite(state_.q[j]) && std::isfinite(state_.qd[j])) continue;
      throw inverse_dynamics_solver::Exception(
          "joint " + interfaces_.joints()[static_cast<std::size_t>(j)], "no measured state",
          "a finite position and velocity", "NaN or infinity",
          "see that the hardware component is active, and activate the controller again");
    }
    fault_.reset();
    const auto status =
        takes_over ? inverse_dynamics_control::Status::kOk : law.hold(state_, 0.0, tau_);
    if (isRefusal(status)) {
      throw inverse_dynamics_solver::Exception(
          "activation", "no safe torque", "a solver that gives gravity at the measured position",
          text(status), "see the solver's own messages");
    }
    interfaces_.write(tau_, commands);
  }

  /// One cycle; once a fault has lasted, of the law's safe torque. Real time: no allocation, lock,
  /// exception or system call.
  ///
  /// @param update  (state, period [s], tau) -> Status; not called once a fault has lasted.
  /// @return ERROR once a fault has lasted, so that the manager activates fallback controllers; OK
  ///         without any, as it would leave the arm without effort.
  template <class Law, class Update>
  controller_interface::return_type cycle(Law& law, const StateInterfaces& states,
                                          CommandInterfaces& commands,
                                          const rclcpp::Duration& period,
                                          const Update& update) noexcept {
    using controller_interface::return_type;
    const double dt = static_cast<double>(period.nanoseconds()) * 1e-9;
    interfaces_.read(states, state_);
    if (const Damping* const changed = damping_.changed()) {
      law.setDamping(changed->of_joints, changed->rate);
    }
    const auto status = fault_.latched() ? law.hold(state_, dt, tau_) : update(state_, dt, tau_);
    if (!interfaces_.write(tau_, commands)) report_->noteNotWritten();

    const bool was_latched = fault_.latched();
    fault_.note(status, dt);
    if (fault_.latched() && !was_latched) report_->noteGivenUp(fault_.why());
    report_->note(status, law.saturated(), law.rateLimited());
    return fault_.latched() && has_fallback_ ? return_type::ERROR : return_type::OK;
  }

  /// Hands the last cycle's numbers to ~/controller_state. Real time: as cycle().
  ///
  /// @param reference  what was followed; null: nothing.
  void publish(const rclcpp::Time& time,
               const inverse_dynamics_control::Reference* reference) noexcept {
    publisher_.note(time, state_, reference, tau_);
  }

  /// Commands zero effort when a controller is deactivated: without feedback no other effort is
  /// safe. A controller that is activated in the same switch overwrites it before the hardware acts.
  void stop(const inverse_dynamics_control::ControlLaw& law, const StateInterfaces& states,
            CommandInterfaces& commands) noexcept {
    interfaces_.read(states, state_);
    hand_over_->leave(state_, tau_, law.lastPosition());
    tau_.setZero();
    interfaces_.write(tau_, commands);
  }

 private:
  ArmInterfaces interfaces_;
  inverse_dynamics_control::JointState state_;
  Eigen::VectorXd tau_;
  inverse_dynamics_control::FaultLatch fault_;
  bool has_fallback_;
  std::shared_ptr<HandOver> hand_over_;
  std::shared_ptr<UpdateReport> report_;
  rclcpp::TimerBase::SharedPtr timer_;
  CarriedBody carried_;
  ChangingGains<Damping> damping_;
  StatePublisher publisher_;
};

/// No interfaces: a controller claims none before it is configured.
inline controller_interface::InterfaceConfiguration nothing() {
  return {controller_interface::interface_configuration_type::NONE, {}};
}

/// Throws inverse_dynamics_solver::Exception unless a controller is configured.
inline void requireConfigured(bool configured) {
  if (configured) return;
  throw inverse_dynamics_solver::Exception("activation", "the controller has no solver",
                                           "a controller that is configured", "one that isn't",
                                           "configure it first, and see that this succeeds");
}

/// Runs a transition; an exception is logged, and fails it.
template <class Work>
controller_interface::CallbackReturn transition(const rclcpp::Logger& logger, const Work& work) {
  try {
    work();
    return controller_interface::CallbackReturn::SUCCESS;
  } catch (const std::exception& error) {
    RCLCPP_ERROR(logger, "%s", error.what());
    return controller_interface::CallbackReturn::FAILURE;
  }
}

}  // namespace inverse_dynamics_controllers

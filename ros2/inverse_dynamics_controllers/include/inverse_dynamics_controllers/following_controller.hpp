// SPDX-License-Identifier: Apache-2.0
/// @file
/// Base of the controllers that follow references: everything but their law.
///
///     class MyController : public FollowingController {
///       MakeFollower declareParameters() override;   // its own; what makes law and references of them
///     };
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "inverse_dynamics_controllers/ros2_control_compatibility.hpp"

namespace reference_parameters {
class ParamListener;
struct Params;
}  // namespace reference_parameters

namespace inverse_dynamics_controllers {

class ArmSource;
class Follower;
struct Setup;

/// A chainable controller around a law that follows references.
///
/// Real time: update(): no allocation, lock, exception or system call of its own.
class FollowingController : public ChainableController {
 public:
  FollowingController();
  ~FollowingController() override;

  controller_interface::InterfaceConfiguration command_interface_configuration() const override;
  controller_interface::InterfaceConfiguration state_interface_configuration() const override;

  controller_interface::CallbackReturn on_init() override;
  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State& state) override;
  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State& state) override;
  controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State& state) override;
  controller_interface::CallbackReturn on_cleanup(const rclcpp_lifecycle::State& state) override;

 protected:
  /// Makes law and references when configured. An exception fails that transition.
  using MakeFollower =
      std::function<std::unique_ptr<Follower>(const Setup&, const reference_parameters::Params&)>;

  /// Declares the controller's own parameters. @return called when configured.
  virtual MakeFollower declareParameters() = 0;

  std::vector<std::string> referenceNames() const override;
  bool on_set_chained_mode(bool chained_mode) override;
  void readReferenceTopic() noexcept override;
  controller_interface::return_type update_and_write_commands(
      const rclcpp::Time& time, const rclcpp::Duration& period) override;

 private:
  std::unique_ptr<ArmSource> arm_source_;
  std::shared_ptr<reference_parameters::ParamListener> reference_parameters_;
  MakeFollower make_follower_;
  std::unique_ptr<Follower> follower_;  // null until configured
  std::vector<double> references_;      // newest, in the order of referenceNames()
};

}  // namespace inverse_dynamics_controllers

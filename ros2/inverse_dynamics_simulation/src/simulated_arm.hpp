// SPDX-License-Identifier: Apache-2.0
/// @file
/// A hardware component of ros2_control with MuJoCo behind it, to try controllers without a robot.
///
///     <ros2_control name="ur10" type="system">
///       <hardware>
///         <plugin>inverse_dynamics_simulation/SimulatedArm</plugin>
///         <param name="payload">2.0</param>                  <!-- kg; none by default -->
///         <param name="payload_link">tool0</param>
///       </hardware>
///       <joint name="elbow_joint">
///         <command_interface name="effort"/>
///         <state_interface name="position"><param name="initial_value">1.2</param>
///         </state_interface>
///         <state_interface name="velocity"/>
///         <state_interface name="effort"/>
///       </joint>
///
/// The robot is what the rest of the same URDF describes, and a payload as a point mass in a link's
/// frame, of which the solvers know nothing. It goes on by the control loop's period
/// at every write; efforts that aren't finite are an error, and the arm keeps the last ones. Brakes
/// hold it at rest while no controller has claimed an effort.
#pragma once

#include <hardware_interface/system_interface.hpp>
#include <memory>
#include <string>
#include <vector>

#include "mujoco_arm.hpp"

#if __has_include(<hardware_interface/types/hardware_component_interface_params.hpp>)
#include <hardware_interface/types/hardware_component_interface_params.hpp>
#define INVERSE_DYNAMICS_SIMULATION_HAS_COMPONENT_PARAMS
#endif

namespace inverse_dynamics_simulation {

/// An arm of effort-controlled joints: state interfaces position, velocity, acceleration, effort;
/// command interface effort.
class SimulatedArm : public hardware_interface::SystemInterface {
 public:
#ifdef INVERSE_DYNAMICS_SIMULATION_HAS_COMPONENT_PARAMS
  hardware_interface::CallbackReturn on_init(
      const hardware_interface::HardwareComponentInterfaceParams& params) override;
#else
  hardware_interface::CallbackReturn on_init(const hardware_interface::HardwareInfo& info) override;
#endif
  std::vector<hardware_interface::StateInterface> export_state_interfaces() override;
  std::vector<hardware_interface::CommandInterface> export_command_interfaces() override;
  hardware_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State& state) override;
  hardware_interface::return_type perform_command_mode_switch(
      const std::vector<std::string>& start, const std::vector<std::string>& stop) override;
  hardware_interface::return_type read(const rclcpp::Time& time,
                                       const rclcpp::Duration& period) override;
  hardware_interface::return_type write(const rclcpp::Time& time,
                                        const rclcpp::Duration& period) override;

 private:
  struct Joint {
    std::string name;
    double position = 0.0, velocity = 0.0, acceleration = 0.0, effort = 0.0, command = 0.0;
    bool claimed = false;  // by a controller
  };

  bool isBraked() const;
  hardware_interface::CallbackReturn initialize(const hardware_interface::HardwareInfo& info);

  std::vector<Joint> joints_;  // not resized any more once interfaces are exported
  Eigen::VectorXd tau_;
  std::unique_ptr<MujocoArm> arm_;
};

}  // namespace inverse_dynamics_simulation

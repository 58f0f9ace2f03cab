// SPDX-License-Identifier: Apache-2.0

/// @file
/// What a URDF says about motors: rotor inertia of its transmissions, and `<ros2_control>`.

#pragma once

#include <tinyxml2.h>

#include "chain_dynamics/robot_description.hpp"
#include "urdf_element.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Adds it to the joints of the robot [RobotDescription::Joint::rotor_inertia].
///
/// Transmissions are for simulators and hardware, so one that can't be understood is a finding, and
/// no error.
void readRotorInertia(const tinyxml2::XMLElement& robot_element, RobotDescription& robot,
                      Findings& findings);

/// Takes `<mimic>` from joints that a `<ros2_control>` states with `mimic="false"`, and adds its
/// transmissions to the robot.
void readRos2Control(const tinyxml2::XMLElement& robot_element, RobotDescription& robot,
                     Findings& findings);

}  // namespace v2
}  // namespace chain_dynamics

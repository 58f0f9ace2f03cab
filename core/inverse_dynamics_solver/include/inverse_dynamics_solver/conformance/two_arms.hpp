// SPDX-License-Identifier: Apache-2.0
/// @file
/// A robot that is no chain, as a robot description: a torso that slides and turns, two arms, and a gripper
/// whose second finger mimics the first.
#pragma once

#include <string>

namespace inverse_dynamics_solver::conformance {

/// A link and the joint that moves it.
inline std::string movedLink(const std::string& name, const std::string& type,
                             const std::string& parent, const std::string& origin,
                             const std::string& axis, const std::string& more = "") {
  return "<link name='" + name + "'><inertial><origin xyz='0.05 -0.02 0.1'/><mass value='1.5'/>" +
         "<inertia ixx='0.03' ixy='0.002' ixz='-0.001' iyy='0.04' iyz='0.003' izz='0.02'/>" +
         "</inertial></link><joint name='" + name + "_joint' type='" + type + "'><parent link='" +
         parent + "'/><child link='" + name + "'/><origin " + origin + "/><axis xyz='" + axis +
         "'/><limit lower='-2' upper='1.5' effort='300' velocity='2'/>" +
         "<dynamics damping='0.4' friction='0.3'/>" + more + "</joint>\n";
}

inline std::string armOf(const std::string& side, const std::string& y) {
  return movedLink(side + "_shoulder", "revolute", "chest", "xyz='0 " + y + " 0.4' rpy='0.3 0 0.1'",
                   "0 1 0") +
         movedLink(side + "_elbow", "continuous", side + "_shoulder", "xyz='0.3 0 0.05'",
                   "0.6 0 0.8") +
         movedLink(side + "_hand", "revolute", side + "_elbow", "xyz='0.25 0 0' rpy='0 0.4 0'",
                   "1 0 0") +
         "<link name='" + side + "_tool'/><joint name='" + side +
         "_flange' type='fixed'><parent link='" + side + "_hand'/><child link='" + side +
         "_tool'/><origin xyz='0.1 0 0' rpy='0 1.2 0'/></joint>\n";
}

/// @param mimic  what the second finger of the left hand does.
inline std::string twoArms(
    const std::string& mimic =
        "<mimic joint='left_finger_joint' multiplier='-1.5' offset='0.1'/>") {
  return "<robot name='two_arms'><link name='base'/>\n" +
         movedLink("lift", "prismatic", "base", "xyz='0 0 0.2'", "0 0 1") +
         movedLink("chest", "revolute", "lift", "xyz='0 0 0.3'", "0 0 1") + armOf("left", "0.2") +
         armOf("right", "-0.2") +
         movedLink("left_finger", "prismatic", "left_hand", "xyz='0.1 0.02 0'", "0 1 0") +
         movedLink("left_other_finger", "prismatic", "left_hand", "xyz='0.1 -0.02 0'", "0 1 0",
                   mimic) +
         "</robot>\n";
}

}  // namespace inverse_dynamics_solver::conformance

// SPDX-License-Identifier: Apache-2.0

/// @file
/// URDFs of small robots, put together by hand, for tests.
///
///     robot(link("base") + link("a") + joint("j", "continuous", "base", "a", ""))

#pragma once

#include <Eigen/Core>
#include <string>

#include "chain_dynamics/torques.hpp"

namespace chain_dynamics {

inline Eigen::VectorXd someTorques(const Chain& chain) {
  const Eigen::Index n = chain.jointCount();
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(n, 0.3, 1.1);
  const Eigen::VectorXd qd = Eigen::VectorXd::LinSpaced(n, -1.2, 2.0);
  const Eigen::VectorXd qdd = Eigen::VectorXd::LinSpaced(n, 3.0, -2.0);
  Eigen::VectorXd tau(n);
  torques(chain, q, qd, qdd, tau);
  return tau;
}

inline const char* const kLimit = R"(<limit lower="-1" upper="2" effort="3" velocity="4"/>)";

inline std::string inertial(const std::string& mass = "2", const std::string& ixx = "0.1",
                            const std::string& origin = "<origin xyz='0.1 0.2 0.3'/>") {
  return "<inertial>" + origin + "<mass value='" + mass + "'/><inertia ixx='" + ixx +
         "' ixy='0.01' ixz='0.02' iyy='0.2' iyz='0.03' izz='0.15'/></inertial>";
}

inline std::string link(const std::string& name, const std::string& content = inertial()) {
  return "<link name='" + name + "'>" + content + "</link>\n";
}

inline std::string joint(const std::string& name, const std::string& type,
                         const std::string& parent, const std::string& child,
                         const std::string& content = kLimit) {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent +
         "'/><child link='" + child + "'/>" + content + "</joint>\n";
}

inline std::string robot(const std::string& content) {
  return "<?xml version='1.0'?>\n<robot name='arm'>\n" + content + "</robot>\n";
}

/// base -shoulder-> upper -elbow-> lower -weld-> tool, with axes and offsets of every kind.
inline std::string arm(const std::string& elbow_axis = "<axis xyz='0.6 0 -0.8'/>",
                       const std::string& more = "") {
  return robot(link("base") + link("upper") + link("lower") + link("tool", inertial("0.5")) +
               joint("shoulder", "revolute", "base", "upper",
                     "<origin xyz='0.1 0 0.4' rpy='0.3 -0.2 0.1'/><axis xyz='0 1 0'/>" +
                         std::string(kLimit)) +
               joint("elbow", "continuous", "upper", "lower",
                     "<origin xyz='0 0.2 0.5' rpy='1 2 3'/>" + elbow_axis) +
               joint("weld", "fixed", "lower", "tool", "<origin xyz='0 0 0.3' rpy='0 0.5 0'/>") +
               more);
}

}  // namespace chain_dynamics

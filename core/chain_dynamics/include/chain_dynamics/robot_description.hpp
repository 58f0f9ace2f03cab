// SPDX-License-Identifier: Apache-2.0

/// @file
/// A URDF robot description as data: a tree of links and joints, read strictly.
///
///     const RobotDescription robot = robotFromUrdf(urdf_xml);
///     for (const auto& joint : robot.joints) { print(joint.name, robot.links[joint.child].name); }
///     for (const std::string& warning : robot.warnings) { print(warning); }
///
/// What is missing, malformed or not a finite number is an error that names line and joint or link;
/// what isn't understood is a warning. What URDF allows to be left out has URDF's meaning: no
/// `<origin>` is the identity, no `<axis>` is x, no `<inertial>` is no mass.
///
/// Read are the links and joints of URDF 1.0 to 1.2 [https://wiki.ros.org/urdf/XML], the rotor
/// inertia of `<transmission>`, and of `<ros2_control>` the transmissions and the joints with
/// `mimic="false"`, whose `<mimic>` isn't used. As in urdfdom, `quat_xyzw` counts where the URDF states
/// version 1.1 or later, limits of acceleration, deceleration and jerk from 1.2 on; elsewhere they are
/// ignored, and a warning says so. Known, and left to others: visual and collision shapes, materials,
/// sensors, calibration, safety controllers, extensions of simulators, all else of transmissions, and
/// elements of another XML namespace. Any other element or attribute gives a warning, with the name that
/// was probably meant. A Chain is made from this tree by chainFromRobot() [urdf.hpp], a tree by
/// mechanismFromRobot() [mechanism.hpp].

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/error.hpp"
#include "chain_dynamics/spatial.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// A robot as its description states it. Links and joints refer to each other by index.
struct RobotDescription {
  /// What stands for no link or joint.
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  /// How a joint moves its child link.
  enum class JointType { kFixed, kRevolute, kContinuous, kPrismatic, kPlanar, kFloating };

  /// Mass and moment of inertia of a link.
  struct Inertial {
    int line = 0;
    /// Pose of the frame of `inertia` in the link's frame; its origin is the center of mass.
    Transform<double> placement = Transform<double>::identity();
    double mass = 0;  ///< kg, >= 0
    /// About the center of mass; kg m^2. Symmetric, else as given: see inertiaDefect().
    Matrix3<double> inertia = Matrix3<double>::Zero();
  };

  struct Link {
    std::string name;
    int line = 0;
    std::optional<Inertial> inertial;
    std::size_t parent_joint = kNone;       ///< kNone: the root
    std::vector<std::size_t> child_joints;  ///< in the order of their names
  };

  /// `position = multiplier * position of joint + offset`.
  struct Mimic {
    std::size_t joint = kNone;
    double multiplier = 1;
    double offset = 0;  ///< rad; m
  };

  struct Joint {
    std::string name;
    int line = 0;
    JointType type = JointType::kFixed;
    std::size_t parent = kNone;  ///< link
    std::size_t child = kNone;   ///< link
    /// Pose of the child link's frame in the parent link's frame at position 0.
    Transform<double> placement = Transform<double>::identity();
    /// Roll, pitch, yaw of `placement` as stated; rad.
    Eigen::Vector3d rpy = Eigen::Vector3d::Zero();
    /// Of any length but 0, in the frame of the child link. A fixed joint's isn't read, nor are its
    /// limits, mimic and dynamics.
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
    JointLimits limits = {};  ///< 0 in a URDF: none; a continuous joint has no range
    double damping = 0;       ///< N m s/rad; prismatic N s/m. 0: not stated.
    double friction = 0;      ///< N m; prismatic N. 0: not stated.
    /// Reflected to the joint: `<motorInertia>` times the square of `<mechanicalReduction>`, or
    /// `<drake:rotor_inertia>` and `<drake:gear_ratio>`, of transmissions to this joint alone (the
    /// sum of several). A ratio that isn't stated is 1. kg m^2; prismatic kg. 0: not stated.
    double rotor_inertia = 0;
    std::optional<Mimic> mimic;
  };

  /// A `<transmission>` of `<ros2_control>`: `q_joints = M q_motors + offset`.
  struct Transmission {
    std::string name;
    int line = 0;
    std::vector<std::string> joints;
    std::vector<std::string> motors;  ///< `<actuator>`s, as many as joints
    std::vector<double> M;            ///< row by row
    std::vector<double> offset;       ///< of each joint; rad; prismatic m
    std::string fault;                ///< empty; or why motors, M and offset can't be used
  };

  std::string name;
  std::vector<Link> links;    ///< in the order of the text
  std::vector<Joint> joints;  ///< in the order of the text
  std::vector<Transmission> transmissions;
  std::size_t root = 0;  ///< link

  /// What isn't understood or hardly meant, a sentence each: `URDF:12: joint elbow: ...`.
  std::vector<std::string> warnings;

  /// The link or joint of a name; kNone if there is none.
  std::size_t linkIndex(const std::string& link) const;
  std::size_t jointIndex(const std::string& joint) const;

  /// The links below one, itself first, every parent before its children.
  std::vector<std::size_t> linksBelow(std::size_t link) const;
};

/// Reads a robot description.
///
/// @param urdf_xml  text of the URDF (not a file name), up to 64 MiB. Of xacro elements that are
///     left in it, none is read: one of `warnings`.
/// @throws ModelError  `URDF:line: joint or link: what: expected ..., got ...; remedy`: no URDF or
///     a broken one, names that aren't unique, links that aren't a tree, unknown joint type, zero
///     axis, missing, malformed or non-finite number, a number beyond 1e50, negative mass.
/// Threads: safe.
RobotDescription robotFromUrdf(const std::string& urdf_xml);

/// Whether the joint moves: any but a fixed one.
inline bool isMovable(const RobotDescription::Joint& joint) {
  return joint.type != RobotDescription::JointType::kFixed;
}

}  // namespace v2
}  // namespace chain_dynamics

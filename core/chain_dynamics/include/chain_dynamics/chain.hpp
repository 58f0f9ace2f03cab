// SPDX-License-Identifier: Apache-2.0

/// @file
/// A serial chain of rigid links as constant data: what the algorithms of this package compute
/// with.
///
///     Joint hinge{"hinge", JointType::kRevolute};          // turns about z of the root frame
///     Chain pendulum("pendulum", {hinge}, {I_1}, Eigen::Vector3d(0, -9.81, 0));
///     torques(pendulum, q, qd, qdd, tau);                  // torques.hpp
///
/// Frames [docs/notation.md]: frame 0 is the root link. Frame i is fixed to link i, and joint i
/// moves link i relative to link i - 1 about (revolute) or along (prismatic) **the z axis of
/// frame i**. In C++ joint and link number i stand at index i - 1.
///
///     X_(i-1)i = placement_i * RotZ(q_i)     revolute, continuous
///     X_(i-1)i = placement_i * TransZ(q_i)   prismatic

#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/spatial.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// How a joint moves. A continuous joint is a revolute one without position limits: positions that
/// differ by whole turns are the same one, and drivers report any of them.
enum class JointType { kRevolute, kContinuous, kPrismatic };

/// The position nearest to `reference` that equals q: of a continuous joint q and whole turns, of
/// any other q itself.
///
/// Every difference of positions is `unwrapped(type, q, reference) - reference`: of a continuous
/// joint the short way, within [-pi, pi]. Where |q - reference| < pi, q is returned bit for bit.
///
/// @param q,reference  rad (prismatic m); what isn't finite gives a result that isn't.
/// Real time: no allocation, lock, exception or system call. Threads: safe.
inline double unwrapped(JointType type, double q, double reference) noexcept {
  constexpr double kTurn = 6.283185307179586;  // rad
  return type == JointType::kContinuous ? q - kTurn * std::round((q - reference) / kTurn) : q;
}

/// unwrapped() of n joints, in place; sizes are the caller's responsibility.
inline void unwrap(const std::vector<JointType>& types,
                   const Eigen::Ref<const Eigen::VectorXd>& reference,
                   Eigen::Ref<Eigen::VectorXd> q) noexcept {
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    q[j] = unwrapped(types[static_cast<std::size_t>(j)], q[j], reference[j]);
  }
}

/// Limits as the robot's maker states them; what isn't stated is infinite. No algorithm reads them.
struct JointLimits {
  double lower = -std::numeric_limits<double>::infinity();    ///< rad; m
  double upper = std::numeric_limits<double>::infinity();     ///< rad; m
  double velocity = std::numeric_limits<double>::infinity();  ///< rad/s; m/s
  double effort = std::numeric_limits<double>::infinity();    ///< N m; N
  /// Of speeding up and of slowing down; rad/s^2; m/s^2.
  double acceleration = std::numeric_limits<double>::infinity();
  double deceleration = std::numeric_limits<double>::infinity();
  double jerk = std::numeric_limits<double>::infinity();  ///< rad/s^3; m/s^3
};

/// One movable joint, and where it sits on its parent link.
struct Joint {
  std::string name;
  JointType type = JointType::kRevolute;
  /// Pose of this joint's frame in the previous link's frame at q = 0.
  Transform<double> placement = Transform<double>::identity();
  JointLimits limits = {};
  /// Inertia of motor and gear, reflected to the joint (gear ratio squared); kg m^2, prismatic kg.
  /// Adds to the diagonal of H; the rotor's gyroscopic effects are neglected.
  double rotor_inertia = 0;
  /// Viscous damping as the robot description states it; N m s/rad, prismatic N s/m. 0: not stated.
  /// No algorithm reads it, nor `friction`: for the torques of friction see friction.hpp.
  double damping = 0;
  /// Coulomb friction as the robot description states it; N m, prismatic N. 0: not stated.
  double friction = 0;
};

/// The ten parameters `[m, mc, I]` of one link, in the link's frame, I about its origin.
using LinkParameters = SpatialInertia<double>;

/// Constant data of a serial chain: joints, links, gravity.
///
/// Threads: safe; nothing changes after construction, copies are independent.
class Chain {
 public:
  /// A chain from root to tip: links[i] is moved by joints[i].
  ///
  /// @param name     what messages call it.
  /// @param joints   at least one; names unique, not empty and printable.
  /// @param links    as many as joints, in link frames; numbers up to 1e50 with mass >= 0.
  /// @param gravity  where things fall, in the root frame; m/s^2, usually (0, 0, -9.81).
  /// @param tip      pose of the tip frame in the last link's frame; no algorithm needs it.
  /// @throws ModelError  naming the joint, where the data can't be a robot. Parameters that can't
  ///     be a rigid body's (identified models, real makers' files) only give warnings().
  Chain(std::string name, std::vector<Joint> joints, std::vector<LinkParameters> links,
        const Eigen::Vector3d& gravity,
        const Transform<double>& tip = Transform<double>::identity());

  /// The same chain under another gravity (mounted on a wall, or in free fall).
  ///
  /// @throws ModelError  where gravity isn't finite.
  Chain withGravity(const Eigen::Vector3d& gravity) const;

  /// The same chain with other warnings(): its file's reader can say more, and where.
  Chain withWarnings(std::vector<std::string> warnings) const;

  const std::string& name() const { return name_; }
  Eigen::Index jointCount() const { return static_cast<Eigen::Index>(joints_.size()); }
  const std::vector<Joint>& joints() const { return joints_; }
  const std::vector<LinkParameters>& links() const { return links_; }
  const Eigen::Vector3d& gravity() const { return gravity_; }
  const Transform<double>& tip() const { return tip_; }

  /// Names from root to tip: the order of every vector and matrix of this package.
  std::vector<std::string> jointNames() const;

  /// How each of them moves.
  std::vector<JointType> jointTypes() const;

  /// One line for each link whose parameters no rigid body can have, and what a reader adds; empty
  /// for a sound chain.
  ///
  /// Inertia about the center of mass that isn't positive or breaks the triangle inequality,
  /// inertia without mass. Inverse dynamics is well defined all the same.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  std::string name_;
  std::vector<Joint> joints_;
  std::vector<LinkParameters> links_;
  Eigen::Vector3d gravity_;
  Transform<double> tip_;
  std::vector<std::string> warnings_;
};

/// Moment of inertia about the center of mass, in parallel axes: `I_c = I + m [c]x [c]x`
/// [Featherstone 2008, sec. 2.13]. Without mass, the moment of inertia as it is.
Matrix3<double> inertiaAboutCenter(const LinkParameters& link);

/// Why a rigid body can't have these parameters, in words; empty if one can.
///
/// Mass >= 0 and, about the center of mass, principal moments that are positive and of which each
/// two together are no less than the third (triangle inequality); to 1e-9 of the greatest moment.
std::string inertiaDefect(const LinkParameters& link);

/// Whether the joint slides; otherwise it turns.
inline bool isPrismatic(const Joint& joint) { return joint.type == JointType::kPrismatic; }

}  // namespace v2
}  // namespace chain_dynamics

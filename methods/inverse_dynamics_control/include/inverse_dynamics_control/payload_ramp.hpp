// SPDX-License-Identifier: Apache-2.0
/// @file
/// A rigid body at the tip that may change while a control loop runs, without a jump of torques.
///
///     PayloadRamp carried(solver, RigidBody(), 1.0);    // nothing yet; a change takes 1 s
///     carried.aimAt(part);                              // a message, a parameter
///     carried.advance(0.01);                            // every 10 ms, in any thread but the loop's
#pragma once

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace inverse_dynamics_control {
inline namespace v2 {

using inverse_dynamics_solver::InverseDynamicsSolver;
using inverse_dynamics_solver::RigidBody;

/// The body between two others: all inertial parameters change linearly, so that torques do too.
///
/// @param from,to  possible bodies, with the tip frame as theirs.
/// @param part     0: from; 1: to.
RigidBody between(const RigidBody& from, const RigidBody& to, double part);

/// A body from numbers, in the tip frame.
///
/// @param mass            kg.
/// @param center_of_mass  3; m.
/// @param inertia         6, about the center of mass: ixx ixy ixz iyy iyz izz; kg m^2.
/// @param where           what error texts begin with: `parameter payload.`
/// Throws inverse_dynamics_solver::InvalidParameterValueException: another number of numbers, what
/// no rigid body can have.
RigidBody bodyOf(double mass, const std::vector<double>& center_of_mass,
                 const std::vector<double>& inertia, const std::string& where);

/// The body of a geometry_msgs/msg/InertiaStamped, in the tip frame. No header of ROS is needed.
///
/// @param tip  name of the tip link; empty: not known.
/// Throws inverse_dynamics_solver::InvalidParameterValueException: what no rigid body can have, a
/// header.frame_id that is neither empty nor the tip.
template <class InertiaStamped>
RigidBody bodyOf(const InertiaStamped& message, const std::string& tip);

/// The body of that name that a solver carries, changed linearly in time.
///
/// Threads: all methods may be called from several threads, while others compute. Not real time: the
/// methods lock and allocate. The solver is kept.
class PayloadRamp {
 public:
  /// @param first  what is carried from now on.
  /// @param time   of a change, s; 0: none.
  /// Throws what requireCarrier() throws for the first body.
  PayloadRamp(std::shared_ptr<InverseDynamicsSolver> solver, const RigidBody& first, double time);

  /// Throws inverse_dynamics_solver::InvalidParameterValueException if the solver can't carry the
  /// body: it hasn't the capability Payload. A body without mass is nothing to carry.
  void requireCarrier(const RigidBody& body) const;

  /// Changes from what is carried now to another body. Throws what requireCarrier() throws: nothing
  /// has changed.
  void aimAt(const RigidBody& body);

  /// Goes on with the change. @param seconds  since the last call.
  void advance(double seconds);

  /// The body at the end of the change.
  RigidBody target() const;

 private:
  void set(const RigidBody& body);

  std::shared_ptr<InverseDynamicsSolver> solver_;
  inverse_dynamics_solver::Payload* carrier_;  // the solver; null: it has none
  double time_;                                // s
  mutable std::mutex mutex_;
  RigidBody from_, to_;
  double part_ = 1.0;
};

/// Throws inverse_dynamics_solver::InvalidParameterValueException unless the frame of a message is
/// the one that is expected, or empty.
///
/// @param frame    header.frame_id.
/// @param link     name of the link; empty: not known.
/// @param role     `tip`, `root`: what the link is.
void requireFrame(const std::string& frame, const std::string& link, const std::string& role);

template <class InertiaStamped>
RigidBody bodyOf(const InertiaStamped& message, const std::string& tip) {
  requireFrame(message.header.frame_id, tip, "tip");
  const auto& i = message.inertia;
  return bodyOf(i.m, {i.com.x, i.com.y, i.com.z}, {i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz},
                "inertia.");
}

}  // namespace v2
}  // namespace inverse_dynamics_control

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Capability of solvers whose robot can carry something: tools and gripped parts that come and go
/// while a control loop computes.
///
///     if (auto* carrier = dynamic_cast<Payload*>(solver.get())) {
///       RigidBody part{2.0};                            // a point mass of 2 kg ...
///       part.center_of_mass = Eigen::Vector3d(0, 0, 0.1);   // ... 10 cm in front of the tip
///       carrier->setPayload("part", part);
///       tau = solver->getTorques(q, qd, qdd);           // with it
///       carrier->removePayload("part");                 // the same numbers as before, bit by bit
///     }
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "chain_dynamics/spatial.hpp"
#include "inverse_dynamics_solver/capability.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// A rigid body that is fixed to the tip of a robot.
struct RigidBody {
  /// kg; >= 0. Without mass there is no inertia: such a body changes nothing.
  double mass = 0.0;

  /// In the body's frame; m.
  Eigen::Vector3d center_of_mass = Eigen::Vector3d::Zero();

  /// About the center of mass, in the axes of the body's frame; kg m^2. Off-diagonal entries are
  /// those of the tensor, `Ixy = -integral of x y dm`. Zero: a point mass.
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();

  /// Pose of the body's frame in the tip frame: the link `tip` of a URDF, `tip` of a model file.
  chain_dynamics::Transform<double> frame = chain_dynamics::Transform<double>::identity();

  /// Which of tipNames() carries it; empty: the first.
  std::string tip = {};
};

bool operator==(const RigidBody& a, const RigidBody& b);

/// The ten inertial parameters of a body in the tip frame.
chain_dynamics::SpatialInertia<double> inTipFrame(const RigidBody& body);

/// Why a body is impossible, for errorText(): the field, and the rest of the message.
struct BodyDefect {
  std::string field;  ///< "mass", "center_of_mass", "inertia" or "frame"
  std::string expected, got, remedy;
};

/// Nothing if a rigid body can be so: finite numbers up to 1e15, mass >= 0, a symmetric inertia
/// with principal moments >= 0 of which each two together are no less than the third (triangle
/// inequality, to 1e-9 of the greatest), a frame that is a rotation (to 1e-9).
std::optional<BodyDefect> defectOf(const RigidBody& body);

/// Bodies by name.
using Payloads = std::map<std::string, RigidBody>;

/// The bodies that the parameters state, below the namespace:
///
/// | parameter              | type      | default                                              |
/// |------------------------|-----------|------------------------------------------------------|
/// | payload.mass           | double    | none: it makes the body                              |
/// | payload.center_of_mass | 3 doubles | zero                                                 |
/// | payload.inertia        | 6 doubles | zero; ixx ixy ixz iyy iyz izz about center_of_mass   |
/// | payload.frame.xyz      | 3 doubles | zero                                                 |
/// | payload.frame.rpy      | 3 doubles | zero; about the fixed x, y, z axes, in this order    |
/// | payload.tip            | string    | "": the first tip                                    |
///
/// are of the body named "payload"; `payload.NAME.mass` and so on of the body NAME, which has no
/// dot, where the source can list its parameters.
///
/// Throws InvalidParameterValueException: wrong type, length or value.
/// ParameterUninitializedException: a body without mass.
Payloads readPayloads(const Configuration& configuration);

/// Bodies that the robot's tip carries, in addition to what the robot description or the model has
/// there. All terms of the dynamics are those of robot and bodies; without friction, the torques that
/// two bodies add are the sum of those that each adds alone.
///
/// Threads: all methods may be called while other threads compute: a call computes with all bodies
/// from before a change, or all from after it, and one that begins when the method has returned has
/// the change. Not real time: the methods lock and allocate. They take microseconds of one solver,
/// up to milliseconds of one that has a pool of workspaces [real_time.md]. initialize() makes the
/// bodies those of its parameters.
class Payload : public Capability {
 public:
  ~Payload() override;

  /// Adds a body, or replaces the one of that name.
  ///
  /// @param name  not empty, printable.
  /// @throws UninitializedException before a successful initialize(); InvalidParameterValueException
  ///   for a body that can't be [defectOf()], or a tip that the robot hasn't: nothing has changed.
  void setPayload(const std::string& name, const RigidBody& body);

  /// Takes a body away; false if there is none of that name. Throws UninitializedException.
  bool removePayload(const std::string& name);

  /// Takes all bodies away. Throws UninitializedException.
  void clearPayloads();

  /// The bodies that are set. Throws UninitializedException.
  Payloads payloads() const;

 protected:
  /// @name What a solver implements
  /// @{

  /// Computes with the bodies that `change` makes of the current ones, from the next call on; all or
  /// nothing, by one thread at a time.
  virtual void changePayloads(const std::function<void(Payloads&)>& change) = 0;

  virtual Payloads currentPayloads() const = 0;
  /// @}
};

}  // namespace v2
}  // namespace inverse_dynamics_solver

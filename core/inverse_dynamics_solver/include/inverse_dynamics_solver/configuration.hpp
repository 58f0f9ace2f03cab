// SPDX-License-Identifier: Apache-2.0
/// @file
/// The parameters that all solvers share.
///
///     JointInfo MySolver::configure(const Configuration& configuration) {
///       auto chain = chainFromDescription(configuration);   // URDF, root, tip, gravity, attached
///       auto threads = configuration.get<std::int64_t>("max_threads");   // a parameter of its own
///       configuration.rejectOthers();                       // all is read, nothing changed yet
///       ...
///     }
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/friction.hpp"
#include "chain_dynamics/friction_laws/viscous_coulomb_offset.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/model.hpp"
#include "inverse_dynamics_solver/parameters.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// The parameters every solver understands, read and checked, and a reader for a solver's own.
///
// clang-format off
/// | parameter below the namespace | type      | default                                     |
/// |-------------------------------|-----------|---------------------------------------------|
/// | root                          | string    | "": the URDF's root link                    |
/// | tip                           | string(s) | "": its leaf, if that leaves no choice      |
/// | gravity                       | 3 doubles | [0, 0, -9.81]                               |
/// | attached                      | string    | "lump"                                      |
/// | locked_joints.<joint>         | double    | 0                                           |
/// | rotor_inertia                 | bool      | false: `<transmission>` isn't used          |
/// | rotor_inertia.<joint>         | double    | none; >= 0, reflected to the joint [kg m^2] |
/// | motors                        | doubles   | none: q = M q_motors, a row per joint       |
/// | motors: "description"         | string    | those of ros2_control's transmissions       |
/// | motor_names                   | strings   | those of joints, or motor_1, ...            |
/// | springs.<joint>.stiffness     | double    | none [N m/rad; prismatic N/m]               |
/// | springs.<joint>.rest          | double    | 0: position of the spring at rest           |
/// | springs.<joint>.lever_sin     | double    | 0: a of the torque a sin q + b cos q [N m]  |
/// | springs.<joint>.lever_cos     | double    | 0: b of a spring that pulls a lever         |
/// | allow_massless                | bool      | false                                       |
/// | friction                      | bool      | true                                        |
/// | urdf_friction                 | bool      | false: `<dynamics>` of the URDF isn't used  |
/// | batch_threads                 | integer   | 1: the library starts no thread             |
// clang-format on
///
/// Several tips, as a list or a text with commas, or "*" for all leaves, `motors` and `springs` are for
/// solvers of trees [chain_dynamics/mechanism.hpp]. With `motors`, these are the joints of the solver, and of
/// `rotor_inertia` and `springs`.
struct Configuration {
  /// URDF text; empty if there is none.
  std::string robot_description;

  /// First and last link of the chain; empty: the URDF's root link and its leaf. Several tips stand with
  /// commas between them.
  std::string root, tip;

  /// Where things fall, in the frame of the root link [m/s^2]. Where it isn't given and the
  /// description mounts that link turned, chainFromDescription() warns.
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};

  /// Whether `gravity` was given: a model file may state a default of its own.
  bool gravity_given = false;

  /// Whether bodies attached beside the chain or beyond the tip are included (`attached`: "lump" or
  /// "ignore").
  bool lump_attached = true;

  /// Whether a movable body without any mass is taken even where H isn't proved positive definite.
  bool allow_massless = false;

  /// Whether a solver adds its friction model: false where the robot's controller compensates
  /// friction.
  bool friction = true;

  /// Whether `<dynamics damping friction>` of a robot description is used: descriptionFriction().
  bool urdf_friction = false;

  /// Up to how many threads share a large batch, the caller's one of them (1 to 4096).
  std::int64_t batch_threads = 1;

  /// Position [rad or m] at which a movable joint beside or beyond the chain is held, by joint
  /// name; nothing: at zero.
  std::function<std::optional<double>(const std::string&)> locked_position;

  /// All parameters, and the namespace that the ones above were read from.
  Parameters parameters;
  std::string param_namespace;

  /// Names that have been asked for since readConfiguration(): those that the solver knows.
  std::shared_ptr<const std::set<std::string>> asked = std::make_shared<std::set<std::string>>();

  /// Name of a parameter with the namespace, as find() and error texts want it: `ids.max_threads`.
  std::string fullName(const std::string& name) const {
    return param_namespace.empty() ? name : param_namespace + "." + name;
  }

  /// A solver's own parameter below the namespace, or nothing if absent. See Parameters::get().
  template <class T>
  std::optional<T> get(const std::string& name) const {
    return parameters.get<T>(fullName(name));
  }

  /// A solver's own parameter that has no default. See Parameters::require().
  template <class T>
  T require(const std::string& name) const {
    return parameters.require<T>(fullName(name));
  }

  /// @throws InvalidParameterValueException  always: a parameter below the namespace has a value that
  ///         can't be used.
  [[noreturn]] void refuse(const std::string& name, const std::string& expected,
                           const std::string& got, const std::string& remedy) const;

  /// Warnings of the parameters below the namespace that are set, but weren't read.
  ///
  /// Without a namespace, a node's own parameters are beside the solver's: there only a name that
  /// is near to one of the solver's counts.
  std::vector<std::string> unknownParameters() const;

  /// Where the parameters are strict [Parameters::strict()]: throws InvalidParameterValueException
  /// if there are unknown ones.
  ///
  /// A solver calls it when it has read all of its parameters and changed nothing yet. Otherwise
  /// such an error leaves it uninitialized, instead of as it was.
  void rejectOthers() const;
};

/// Reads and checks the parameters of the table above.
///
/// @param robot_description  URDF text; if empty, the parameter `robot_description`, without
///                           namespace.
///
/// Throws InvalidParameterValueException: wrong type, length or value.
Configuration readConfiguration(const Parameters& parameters, const std::string& param_namespace,
                                const std::string& robot_description);

/// The chain of the robot description between root and tip, any two of its links [urdf.hpp]: with
/// the rotor inertia of its joints that `rotor_inertia` asks for.
///
/// Throws ParameterUninitializedException: no robot description. InvalidParameterValueException: several
/// tips. InvalidRobotDescriptionException: not a URDF, no such link, no chain, a joint or link that can't
/// be computed with.
chain_dynamics::Chain chainFromDescription(const Configuration& configuration);

/// The same between root and all tips, behind its motors: a tree, or a chain, which has no branches.
///
/// Throws InvalidParameterValueException: motors that aren't a matrix of a row for each joint.
chain_dynamics::Mechanism mechanismFromDescription(const Configuration& configuration);

/// Gives a robot the springs that `springs` states, in place of its own.
///
/// Throws InvalidParameterValueException: a spring without stiffness, or of a joint that can't have one.
void setSprings(const Configuration& configuration, chain_dynamics::Model& model);

/// Throws InvalidParameterValueException where `motors` or `springs` are stated: for solvers that take none.
void refuseMotorsAndSprings(const Configuration& configuration);

/// Friction that a robot description states.
struct DescriptionFriction {
  /// One law per joint, `f = damping qd + friction sign(qd)`; empty: no friction.
  std::vector<chain_dynamics::ViscousCoulombOffset> laws;
  /// A sentence if what the description states isn't used, or if it states nothing to use.
  std::vector<std::string> warnings;
};

/// The friction of a chain from chainFromDescription(): `<dynamics damping friction>` of its joints
/// where `urdf_friction` and `friction` are true.
DescriptionFriction descriptionFriction(const Configuration& configuration,
                                        const chain_dynamics::Chain& chain);

}  // namespace v2
}  // namespace inverse_dynamics_solver

// SPDX-License-Identifier: Apache-2.0

/// @file
/// A robot as it was identified: a chain, and what was measured beyond rigid bodies.
///
///     Model ur10 = modelFromFile("ur10_identified.yaml");   // model_file.hpp
///     torques(ur10, q, qd, qdd, tau);                       // tau = H qdd + C qd + g
///     frictionVector(ur10, q, qd, f);                       // what the motors need is tau + f
///
/// An identified robot need not be one system of rigid bodies [parameter_sets.hpp]: rows of the
/// torque may have parameters of their own, and so may gravity. The functions below have the names,
/// meanings and arguments of those for a Chain [torques.hpp, inertia_matrix.hpp, ...] and take that
/// into account.
///
/// Arguments: q, qd, qdd n each; rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2); order of
/// model.chain.jointNames(). Real time (up to 64 joints): no allocation, lock, exception or system
/// call. Threads: safe.
///
/// A model identified in motor currents is kept in torques: its parameters and friction have been
/// multiplied by the drive gains, so the current of joint j is the torque divided by
/// `drive_gains[j]`.

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/friction.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/owned.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// From the least to the greatest of some numbers.
struct Interval {
  double lower = 0;
  double upper = 0;
};

/// Where one joint was while the robot was identified.
struct SeenRange {
  Interval q;    ///< rad (prismatic m)
  Interval qd;   ///< rad/s (prismatic m/s)
  Interval qdd;  ///< rad/s^2 (prismatic m/s^2)
};

/// A chain with identified parameters, friction and drive gains. Plain data; see checkModel().
struct Model {
  /// A chain as it is: one parameter set, no friction.
  explicit Model(Chain chain_of_model) : chain(std::move(chain_of_model)), name(chain.name()) {}

  /// A mechanism as it is: no friction.
  explicit Model(Mechanism mechanism)
      : chain(std::move(mechanism.coordinates)),
        branches(std::move(mechanism.branches)),
        motor_inertia(Eigen::Map<const Eigen::VectorXd>(
            mechanism.motor_inertia.data(),
            static_cast<Eigen::Index>(mechanism.motor_inertia.size()))),
        tip(std::move(mechanism.tip)),
        name(chain.name()) {}

  Chain chain;

  /// Empty: the robot is the chain. Otherwise it is the sum of these branches, and the chain only has
  /// name, type and limits of each coordinate [mechanism.hpp]: n is the number of coordinates, and
  /// there are no row parameters and gravity parameters.
  std::vector<Branch> branches = {};

  /// Empty: none. Otherwise the mechanism's motor_inertia, which is on the diagonal of H.
  OwnedVector motor_inertia = {};

  /// Without branches: name of the link whose frame is chain.tip(); empty: not known.
  std::string tip = {};

  /// Empty: no springs. Otherwise, for each coordinate, the stiffness k of a spring [N m/rad; prismatic
  /// N/m] and the position at which it is at rest [rad; m]. Its torque `k (q - rest)` is part of
  /// gravityVector(): g is the gradient of the potential energy of gravity and springs. Not of continuous
  /// joints, nor with row_parameters or gravity_parameters.
  OwnedVector stiffness = {};
  OwnedVector rest = {};

  /// Empty: none. Otherwise 2 x n: the torque `a sin(q) + b cos(q)` of a spring that pulls a lever around,
  /// a and b of each coordinate [N m; prismatic N]. As of springs, but of continuous joints, too.
  OwnedMatrix levers = {};

  /// Empty: chain.links() for every row of H, C qd, g. Otherwise n sets of n links, and row j is
  /// that of a chain with set j; chain.links() are then without meaning.
  std::vector<std::vector<LinkParameters>> row_parameters = {};

  /// Empty: gravity has the same parameters. Otherwise n links, whose masses and first moments are
  /// those of gravity.
  std::vector<LinkParameters> gravity_parameters = {};

  /// Empty: no friction is known. Otherwise one law per joint, and then one per place of friction_places;
  /// N m (prismatic N).
  std::vector<FrictionLaw> friction = {};

  /// Names of places beside the joints where friction acts, too: the bearing between two bars of a
  /// parallelogram, a joint that several motors turn.
  std::vector<std::string> friction_places = {};

  /// Empty: each law is of its joint. Otherwise r x n, a row for each of r laws, as of motors that joints
  /// share: laws act at the velocities `v = coupling qd`, and friction of the joints is `coupling' f(v)`,
  /// f_k by law k. A law has a load term only where its row is that of its joint alone.
  OwnedMatrix coupling = {};

  /// Empty: nothing is known about motors. Otherwise torque per motor current of each joint; N m/A.
  OwnedVector drive_gains = {};

  /// Empty: not known. Otherwise, for each joint, half the width of the band that holds 95 % of the
  /// differences between measured and computed torque, of data that weren't used to identify; N m
  /// (prismatic N). For the robot without payload, within `seen`.
  OwnedVector torque_deviation = {};

  /// Empty: not known. Otherwise, for each joint, the range of the data of identification.
  std::vector<SeenRange> seen = {};

  std::string name;           ///< what messages call it
  std::string source = {};    ///< where the numbers come from
  std::string validity = {};  ///< what they are good for

  /// Whether H is proved to be symmetric positive definite for every q.
  ///
  /// It is where H has one parameter set, no link's kinetic energy can be negative (mass >= 0, no
  /// negative moment about the center of mass), and each joint, or each group of joints with
  /// massless links between them, has inertia of its own at every position: a shoulder of two
  /// crossing axes has, a wrist of three that meet in one point hasn't unless its links have mass.
  /// The proof is in src/definite_inertia.hpp. Where this is false, torques are still those of the
  /// model, but nobody should invert H or feed back through it.
  bool inertiaIsPhysical() const;
};

/// Names of the tips: those of the branches, or the chain's one, which is empty where it isn't known.
std::vector<std::string> tipNames(const Model& model);

/// Rejects a model whose parts don't fit together [also checkMechanism()]: wrong sizes, non-finite
/// numbers, gains <= 0, coefficients that a friction law can't have.
///
/// Call it once where a model was made by hand; the functions below only assert sizes.
///
/// @throws ModelError  naming part and joint.
void checkModel(const Model& model);

/// The model with a rigid body welded to its tip: the body is added to the last link of the chain,
/// of every row's parameters and of those of gravity.
///
/// @param body  in the frame of model.chain.tip(), or of the tip of that branch.
/// @throws ModelError  a body with which the last link can't be: mass below zero, a NaN.
Model withBodyAtTip(const Model& model, const LinkParameters& body, std::size_t branch = 0);

/// The same model under another gravity [Chain::withGravity()].
Model withGravity(const Model& model, const Eigen::Vector3d& gravity);

using ConstVectorRef = Eigen::Ref<const Eigen::VectorXd>;
using VectorRef = Eigen::Ref<Eigen::VectorXd>;
using MatrixRef = Eigen::Ref<Eigen::MatrixXd>;

/// Joint torques of a given motion, without friction: `tau = H(q) qdd + C(q, qd) qd + g(q)`.
///
/// Recursive Newton-Euler, O(n), or once per row [parameter_sets.hpp], O(n^2).
///
/// @param[out] tau  n; N m (prismatic N).
void torques(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
             const ConstVectorRef& qdd, VectorRef tau);

/// Joint-space inertia matrix: `H(q)`; with row parameters neither symmetric nor definite.
///
/// @param[out] H  n x n; kg m^2 (prismatic kg, mixed kg m).
void inertiaMatrix(const Model& model, const ConstVectorRef& q, MatrixRef H);

/// Coriolis and centrifugal torques: `C(q, qd) qd`.
///
/// @param[out] c  n; N m (prismatic N).
void coriolisVector(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                    VectorRef c);

/// Coriolis matrix of Christoffel's symbols: `C(q, qd)`; row j with the parameters of row j.
///
/// `C qd` is that of coriolisVector(). `dH/dt = C + C'` without row parameters; with them, H isn't
/// symmetric either. By dual numbers [coriolis_matrix.hpp], O(n^2), or once per row.
///
/// @param[out] C  n x n; kg m^2/s (prismatic kg/s, mixed kg m/s).
void coriolisMatrix(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                    MatrixRef C);

/// Gravity torques, and those of springs: `g(q)`.
///
/// @param[out] g  n; N m (prismatic N).
void gravityVector(const Model& model, const ConstVectorRef& q, VectorRef g);

/// Inertia matrix, Coriolis and gravity torques in one pass: `H(q)`, `C(q, qd) qd`, `g(q)`.
///
/// @param[out] H  n x n; kg m^2 (prismatic kg, mixed kg m).
/// @param[out] c  n; N m (prismatic N).
/// @param[out] g  n; N m (prismatic N).
void dynamicComponents(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                       MatrixRef H, VectorRef c, VectorRef g);

/// Kinetic energy [J]: `T(q, qd) = 1/2 qd' H qd`, rotors included; for models without row parameters.
double kineticEnergy(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd);

/// Potential energy of gravity and springs [J]: `U(q)`, zero where all mass is at the root frame's origin
/// and all springs are at rest; its gradient is gravityVector(). For models without row parameters, or
/// with some for gravity.
double potentialEnergy(const Model& model, const ConstVectorRef& q);

/// Whether friction depends on the gravity torques, and so on q: a law has a load coefficient.
bool frictionDependsOnLoad(const Model& model);

/// Friction torques: `f(q, qd)`; zero where the model has no friction, but NaN for NaN.
///
/// The load of a joint is its gravityVector(), of the model as it is.
///
/// @param q       n; rad (prismatic m); may be empty where frictionDependsOnLoad() is false.
/// @param[out] f  n; N m (prismatic N).
void frictionVector(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                    VectorRef f);

/// Adds the derivatives of the friction torques: `df/dq` to `dtau_dq`, `df/dqd` to `dtau_dqd`.
///
/// `df_j/dq = df_j/dg_j dg_j/dq`; where a gravity torque is zero, |g_j| has no derivative, which
/// counts as zero.
///
/// @param[in,out] dtau_dq  n x n; N m/rad (prismatic N, m).
/// @param[in,out] dtau_dqd n x n; N m s/rad (prismatic N, m).
void addFrictionDerivatives(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                            MatrixRef dtau_dq, MatrixRef dtau_dqd);

/// Derivatives of the joint torques without friction: `dtau/dq`, `dtau/dqd`, `dtau/dqdd = H(q)`.
/// Those of friction are added by addFrictionDerivatives().
///
/// By dual numbers [torque_derivatives.hpp], O(n^2), or once per row, O(n^3).
///
/// @param[out] dtau_dq    n x n: entry (i, j) is that of tau_i by q_j; N m/rad (prismatic N, m).
/// @param[out] dtau_dqd   n x n; N m s/rad (prismatic N, m).
/// @param[out] dtau_dqdd  n x n; kg m^2 (prismatic kg, mixed kg m).
void torqueDerivatives(const Model& model, const ConstVectorRef& q, const ConstVectorRef& qd,
                       const ConstVectorRef& qdd, MatrixRef dtau_dq, MatrixRef dtau_dqd,
                       MatrixRef dtau_dqdd);

}  // namespace v2
}  // namespace chain_dynamics

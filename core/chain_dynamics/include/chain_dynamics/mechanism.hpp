// SPDX-License-Identifier: Apache-2.0

/// @file
/// A tree of rigid bodies whose joints follow its coordinates, as constant data: two arms on a torso,
/// a gripper whose second finger mimics the first.
///
///     const RobotDescription robot = robotFromUrdf(urdf_xml);
///     const Model torso{mechanismFromRobot(robot, {}, {"left_tool", "right_tool"})};
///     torques(torso, q, qd, qdd, tau);                       // model.hpp; FastModel takes it, too
///
/// Energy is the sum of the energies of all links. So a tree is a **sum of chains**, its branches: one
/// from the root to each tip, where a link that several branches move has mass in the first of them
/// only. The joints of branch b stand at `q_b = S_b q + s_b`, where q are the coordinates: a joint is a
/// coordinate itself, or follows some (`<mimic>`: a multiplier and an offset). By the chain rule
///
///     tau = sum of S_b' tau_b(q_b, S_b qd, S_b qdd)      H = sum of S_b' H_b S_b
///
/// and likewise every other term of the dynamics. Rotor inertia stands in the branches, as mass does.
/// Friction, limits and types are of coordinates.
///
/// Coordinates may be motors that move several joints: withMotors().

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/owned.hpp"
#include "chain_dynamics/robot_description.hpp"
#include "chain_dynamics/urdf.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// An entry of S that isn't zero: the joint moves by `factor` times the coordinate.
struct Follow {
  Eigen::Index joint = 0;       ///< of the branch
  Eigen::Index coordinate = 0;  ///< of the mechanism
  double factor = 1;
};

/// @name Between coordinates and joints, by the entries of S
/// Numbers by `[i]`, matrices by `(i, j)`. Real time: no allocation, lock, exception or system call.
/// @{

/// `joints += S x`: velocities, accelerations; positions where `joints` begins as s.
template <class Coordinates, class Joints>
void addMotion(const std::vector<Follow>& S, const Coordinates& x, Joints&& joints) {
  for (const Follow& entry : S) joints[entry.joint] += entry.factor * x[entry.coordinate];
}

/// `tau += S' of_joints`.
template <class Joints, class Coordinates>
void addTorques(const std::vector<Follow>& S, const Joints& of_joints, Coordinates&& tau) {
  for (const Follow& entry : S) tau[entry.coordinate] += entry.factor * of_joints[entry.joint];
}

/// `H += S' of_joints S`.
template <class Joints, class Coordinates>
void addMatrix(const std::vector<Follow>& S, const Joints& of_joints, Coordinates&& H) {
  for (const Follow& column : S) {
    for (const Follow& row : S) {
      H(row.coordinate, column.coordinate) +=
          row.factor * column.factor * of_joints(row.joint, column.joint);
    }
  }
}

/// `J += of_joints S`.
template <class Joints, class Coordinates>
void addJacobian(const std::vector<Follow>& S, const Joints& of_joints, Coordinates&& J) {
  for (const Follow& entry : S) {
    J.col(entry.coordinate) += entry.factor * of_joints.col(entry.joint);
  }
}
/// @}

/// One of the chains whose sum a mechanism is.
struct Branch {
  std::string tip;        ///< name of the link whose frame is chain.tip()
  Chain chain;            ///< without the mass and rotors of links in earlier branches
  std::vector<Follow> S;  ///< each entry once
  std::vector<double> s;  ///< positions of its joints where all coordinates are zero; rad; m
  std::vector<Eigen::Index> link;  ///< of its joints: number of the link that each moves, from 0
};

/// Most coordinates; joints of one branch; joints, each counted once.
constexpr std::size_t kMostCoordinates = 64;
constexpr std::size_t kMostBranchJoints = 64;
constexpr std::size_t kMostMovingJoints = 128;

/// @name What branches compute, and its sum
/// On the stack. Real time: no allocation, lock, exception or system call.
/// @{

/// Of the joints of a branch, or of coordinates.
using BranchVector =
    Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostBranchJoints, 1>;
using BranchMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                   kMostBranchJoints, kMostBranchJoints>;

/// `S x`: velocities of the joints of a branch, or accelerations.
inline BranchVector motionOf(const Branch& branch, const Eigen::Ref<const Eigen::VectorXd>& x) {
  BranchVector result = BranchVector::Zero(branch.chain.jointCount());
  addMotion(branch.S, x, result);
  return result;
}

/// `S q + s`.
inline BranchVector positionsOf(const Branch& branch, const Eigen::Ref<const Eigen::VectorXd>& q) {
  BranchVector result = Eigen::Map<const BranchVector>(branch.s.data(), branch.chain.jointCount());
  addMotion(branch.S, q, result);
  return result;
}

/// `sum of S' v`, of vectors that `compute(branch, v)` gives; the sum may stand where an input does.
template <class Compute>
void sumOfVectors(const std::vector<Branch>& branches, Eigen::Ref<Eigen::VectorXd> result,
                  const Compute& compute) {
  BranchVector sum = BranchVector::Zero(result.size());
  for (const Branch& branch : branches) {
    BranchVector of_branch(branch.chain.jointCount());
    compute(branch, of_branch);
    addTorques(branch.S, of_branch, sum);
  }
  result = sum;
}

/// `sum of S' A S`, of matrices that `compute(branch, A)` gives.
template <class Compute>
void sumOfMatrices(const std::vector<Branch>& branches, Eigen::Ref<Eigen::MatrixXd> result,
                   const Compute& compute) {
  result.setZero();
  for (const Branch& branch : branches) {
    const Eigen::Index m = branch.chain.jointCount();
    BranchMatrix of_branch(m, m);
    compute(branch, of_branch);
    addMatrix(branch.S, of_branch, result);
  }
}
/// @}

/// Coordinates, and the branches whose joints follow them.
struct Mechanism {
  /// One joint per coordinate, with name, type and limits; its rotor inertia, damping and friction are
  /// those of all joints that follow it, seen from the coordinate. Without branches, this is the robot.
  /// With branches, placements and links are without meaning.
  Chain coordinates;

  /// Joints of the same name are one joint: it moves one link, in the same way in all branches.
  std::vector<Branch> branches;

  /// Empty: none. Otherwise rotor inertia of each coordinate that isn't among that of the branches; kg m^2
  /// (prismatic kg).
  std::vector<double> motor_inertia = {};

  /// Without branches: name of the link whose frame is coordinates.tip(); empty: not known.
  std::string tip = {};
};

/// Number of links of all branches, each counted once.
Eigen::Index linkCount(const std::vector<Branch>& branches);

/// Parameters of each link, by its number; of a chain those of its links.
std::vector<LinkParameters> linksOf(const Mechanism& mechanism);

/// The mechanism with other links and rotors. Each link has mass in the first of the branches that move
/// it. A rotor stands in a joint that follows its coordinate alone, or else in motor_inertia.
///
/// @param links          as many as linksOf() gives.
/// @param rotor_inertia  of each coordinate, seen from it, instead of all that it had; kg m^2 (prismatic kg).
/// @throws ModelError  another number of links or rotors.
Mechanism withLinks(const Mechanism& mechanism, const std::vector<LinkParameters>& links,
                    const Eigen::Ref<const Eigen::VectorXd>& rotor_inertia);

/// Rejects branches that don't fit the coordinates: wrong sizes, numbers that aren't finite, too many
/// joints, or a coordinate that moves no joint of its own (S without full column rank).
///
/// @throws ModelError  naming branch, joint or coordinate.
void checkMechanism(const Mechanism& mechanism);

/// The mechanism between root and tips of a robot description.
///
/// Joints between root and tips move, each follows its `<mimic>`; all others are held or lumped as in
/// chainFromRobot(). Coordinates are the joints that mimic no other, in the order of the description.
/// Limits of a joint that mimics restrict its coordinate. One tip without a joint that mimics is the
/// chain of chainFromRobot(), without branches unless `branches_of_chains` asks for one.
///
/// @param options  `tip` isn't read.
/// @param tips     links, the first of which is the tip where only one is asked for. Empty: the tip of
///     chainFromRobot(). "*": all leaves below root that a joint moves, in the order of the
///     description; of leaves that the same joint moves, the one with most joints (fixed ones too)
///     above it, and none where a joint beyond it leads to another leaf.
/// @throws ModelError  as chainFromRobot(), and naming tip or joint: no such tip, a tip twice, a tip
///     that no joint moves, a `<mimic>` that follows itself or a joint that isn't between root and tips.
/// Threads: safe.
Mechanism mechanismFromRobot(const RobotDescription& robot, const UrdfOptions& options,
                             const std::vector<std::string>& tips, bool branches_of_chains = false);

/// Motors that move the joints which were coordinates: `q = M q_motors + offset`.
struct Motors {
  OwnedMatrix M;       ///< joints x motors, of full column rank; rad per rad (prismatic m)
  OwnedVector offset;  ///< of each joint; rad (prismatic m); empty: zero
  /// Of each motor. Empty: a motor that is a joint itself (a row of M with only a 1 in its column) has the
  /// joint's name, others are `motor_1`, ..., by their column.
  std::vector<std::string> names = {};
  std::vector<double> rotor_inertia = {};  ///< of each motor; kg m^2 (prismatic kg); empty: none
};

/// The mechanism with motors for coordinates: torques and H are those of motors.
///
/// A motor that is a joint itself has its type and limits. Limits, damping and friction of a joint that one
/// motor moves are that motor's, as those of joints that mimic; the other joints' aren't used. A motor's
/// effort is limited where it moves one joint alone.
///
/// @param mechanism  with branches.
/// @throws ModelError  no branches, M or names of another size, numbers that aren't finite, a motor without a
///     motion of its own.
Mechanism withMotors(const Mechanism& mechanism, const Motors& motors);

/// The motors of a description: those of its transmissions [RobotDescription::Transmission], and each other
/// joint itself; in the order of the joints.
///
/// @param joints  names of the coordinates.
/// @throws ModelError  a transmission of these joints that can't be computed, or that has other joints, too;
///     a joint of two transmissions.
Motors motorsFromRobot(const RobotDescription& robot, const std::vector<std::string>& joints);

/// The tips that a text names: one, several with commas between them, "*"; none if it is empty.
std::vector<std::string> tipsNamed(const RobotDescription& robot, const std::string& text);

/// mechanismFromRobot() of a URDF and of the tips that `options.tip` names.
Mechanism mechanismFromUrdf(const std::string& urdf_xml, const UrdfOptions& options = {});

}  // namespace v2
}  // namespace chain_dynamics

// SPDX-License-Identifier: Apache-2.0

/// @file
/// Other libraries, by their fastest calls, on the same states: benchmarks
/// `ROBOT/QUANTITY/LIBRARY`. Pinocchio, MuJoCo and CasADi are optional: without them their functions
/// are declared only.
///
/// Each of these functions compares the torques of one state with `expected` first, and throws
/// std::runtime_error if the library computes something else.
#pragma once

#include <Eigen/Core>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/robot_description.hpp>
#include <optional>
#include <string>

namespace inverse_dynamics_benchmarks {

/// A robot as the other libraries get it.
struct PeerRobot {
  std::string name;
  std::string urdf;
  chain_dynamics::Chain chain;  ///< of the URDF
  Eigen::VectorXd expected;     ///< torques of the first state [N m]
  /// Nothing: the chain. Otherwise the tree, whose coordinates are the joints of the chain.
  std::optional<chain_dynamics::RobotDescription> tree = {};
};

/// Throws unless torques equal the expected ones to 1e-9 of the greatest.
void requireSameTorques(const PeerRobot& robot, const std::string& library,
                        const Eigen::VectorXd& torques);

/// KDL::ChainIdSolver_RNE and KDL::ChainDynParam; of arms also KDL::ChainJntToJacSolver.
void registerKdl(const PeerRobot& robot);

/// rnea, crba (LOCAL convention), nonLinearEffects, computeGeneralizedGravity; `components` is
/// these last three. Of arms also aba (LOCAL), computeJointTorqueRegressor, computeRNEADerivatives,
/// computeCoriolisMatrix and computeJointJacobians, beside registerEngine().
void registerPinocchio(const PeerRobot& robot);

/// Kinematics, then mj_rne or mj_makeM: what mj_inverse does for an arm without contacts.
void registerMujoco(const PeerRobot& robot);

/// Of UR10 and Panda: C that CasADi generated from two expressions, libraries `casadi_templates` and
/// `casadi_textbook`.
void registerCasadi(const PeerRobot& robot);

/// Versions, as text.
std::string kdlVersion();
std::string pinocchioVersion();
std::string mujocoVersion();
std::string casadiVersion();

}  // namespace inverse_dynamics_benchmarks

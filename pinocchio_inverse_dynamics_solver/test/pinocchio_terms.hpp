// SPDX-License-Identifier: Apache-2.0
/// @file
/// What Pinocchio computes of a chain, without its headers, whose algorithms take long to compile.
#pragma once

#include <Eigen/Core>
#include <chain_dynamics/chain.hpp>

namespace pinocchio_inverse_dynamics_solver {

/// Pinocchio's terms of one state of a chain with n joints.
struct PinocchioTerms {
  Eigen::Index nq;            ///< positions: n
  Eigen::VectorXd torques;    ///< n
  Eigen::MatrixXd inertia;    ///< n x n, its upper triangle
  Eigen::MatrixXd regressor;  ///< n x 10 n, moments of inertia in the order Ixx Ixy Iyy Ixz Iyz Izz
  Eigen::VectorXd qdd;        ///< n, forward dynamics
  Eigen::MatrixXd dtau_dq;    ///< n x n
  Eigen::MatrixXd dtau_dqd;   ///< n x n
};

/// Terms at q, qd and qdd; accelerations that the torques tau cause at q and qd.
PinocchioTerms pinocchioTerms(const chain_dynamics::Chain& chain, const Eigen::VectorXd& q,
                              const Eigen::VectorXd& qd, const Eigen::VectorXd& qdd,
                              const Eigen::VectorXd& tau);

}  // namespace pinocchio_inverse_dynamics_solver

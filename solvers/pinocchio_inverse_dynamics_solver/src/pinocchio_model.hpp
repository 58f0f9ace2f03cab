// SPDX-License-Identifier: Apache-2.0
/// @file
/// A chain, or a tree, as Pinocchio's model.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "pinocchio_headers.hpp"

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

/// The model of a chain: joint i is Pinocchio's joint i + 1, with its axis along z. A continuous
/// joint is a revolute one, so that positions stay angles (nq = nv). The last frame is the tip's.
Model toPinocchio(const chain_dynamics::Chain& chain);

/// A robot that all threads read.
struct Models {
  Model with_gravity;
  Model without_gravity;

  /// How the joints of a tree follow its coordinates, and which links they move [mechanism.hpp]; empty: of
  /// a chain.
  std::vector<chain_dynamics::Follow> S = {};
  std::vector<double> s = {};
  std::vector<Eigen::Index> link = {};
};

/// The models of a tree, in which each joint is once. Their frames are those of the tips, after Pinocchio's
/// own.
Models toPinocchio(const std::vector<chain_dynamics::Branch>& branches);

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver

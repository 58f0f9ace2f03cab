// SPDX-License-Identifier: Apache-2.0

/// @file
/// A mechanism as kernels compute it: the sum over its branches, each a FastModel of its chain.

#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/model.hpp"
#include "fast/robot.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// A branch made ready.
struct FastBranch {
  FastBranch(const Branch& of, std::unique_ptr<const FastModel> made);

  const Branch& branch;
  std::unique_ptr<const FastModel> fast;
  /// The coordinate that each joint is; empty where a joint follows in another way.
  std::vector<int> coordinates;
  std::vector<int> own;  ///< joints whose links no earlier branch has
};

/// A mechanism's branches, for kernels that get it as their robot; of a chain there are none.
struct FastBranches : fast::Robot {
  std::unique_ptr<const Model> model;
  std::vector<FastBranch> branches;
  int links = 0;  ///< which the regressor has ten columns each of; of a chain, too
  std::vector<std::vector<int>> moved;  ///< by each coordinate: links, ascending; empty: a chain
  /// Computes friction; null: there is none, or it depends on load.
  std::unique_ptr<const FastModel> friction_alone;
};

/// Tables whose functions expect that their robot is a FastBranches.
fast::Kernels branchKernels(const char* instruction_set);
fast::ManyKernels manyBranchKernels();

}  // namespace v2
}  // namespace chain_dynamics

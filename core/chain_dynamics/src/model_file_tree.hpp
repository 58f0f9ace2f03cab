// SPDX-License-Identifier: Apache-2.0

/// @file
/// A model file of a tree: joints that name their parents, and tips.

#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "chain_dynamics/located_yaml.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "model_file_joint.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// A tip of a file.
struct TipEntry {
  std::string where;  // as error texts begin
  std::string name;
  std::string joint;          // which moves the link that it is on
  Transform<double> X_U_tip;  // in the file's frame of that link
};

std::vector<TipEntry> readTips(const LocatedValue& value);

/// Makes the chain of some joints from root to tip.
using MakeChain = std::function<Chain(const std::vector<JointEntry>&, const Transform<double>&)>;

/// The mechanism of all joints. Its links have the order of the file, and so have its coordinates.
///
/// @throws ModelError  naming the joint: a parent or a joint to follow that doesn't exist, one that is
///     below itself or follows itself, a name that stands twice, a joint that leads to no tip.
Mechanism treeOf(const std::string& name, const std::vector<JointEntry>& entries,
                 const std::vector<TipEntry>& tips, const Eigen::Vector3d& gravity,
                 const MakeChain& make_chain);

}  // namespace v2
}  // namespace chain_dynamics

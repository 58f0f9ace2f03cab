// SPDX-License-Identifier: Apache-2.0
/// @file
/// The figures of the two-link arm, and the arm as a chain.
#pragma once

#include "chain_dynamics/chain.hpp"

namespace two_link_solver {

// Masses [kg] and lengths [m] of the two links.
constexpr double m1 = 3.0, m2 = 2.0, l1 = 0.7, l2 = 0.5;

/// Both joints turn about z of their link, which is y of the root; y of a link points along it.
inline chain_dynamics::Chain chain(const Eigen::Vector3d& gravity) {
  using chain_dynamics::LinkParameters;
  chain_dynamics::Joint shoulder{"shoulder", chain_dynamics::JointType::kRevolute};
  chain_dynamics::Joint elbow{"elbow", chain_dynamics::JointType::kRevolute};
  shoulder.placement.R << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  elbow.placement.p = {0, l1, 0};
  const Eigen::Matrix3d none = Eigen::Matrix3d::Zero();
  return chain_dynamics::Chain("two_link", {shoulder, elbow},
                               {LinkParameters::fromCenterOfMass(m1, {0, l1, 0}, none),
                                LinkParameters::fromCenterOfMass(m2, {0, l2, 0}, none)},
                               gravity);
}

}  // namespace two_link_solver

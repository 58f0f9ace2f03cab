// SPDX-License-Identifier: Apache-2.0

/// @file
/// Dynamics of a robot whose rows have parameters of their own: what identified models are.
///
///     ParameterSets sets{model.row_parameters, model.gravity_parameters};
///     torques(chain, sets, q, qd, qdd, tau);   // row j with parameter set j, gravity with its own
///
/// An identified robot need not be *one* rigid body system. When each joint was identified by
/// itself, row j of the torque has its own ten parameters per link; when gravity was identified
/// apart, gravity has. Every row is still that of a rigid body system, so each is computed as such:
/// kinematics depend on no parameter and are shared by all rows, then row j is the recursion from
/// the tip down to joint j with parameter set j, O(n^2) for all.
///
/// Such an H need be neither symmetric nor positive definite: row j is that of the j-th system.

#pragma once

#include <Eigen/Core>
#include <vector>

#include "chain_dynamics/chain.hpp"

namespace chain_dynamics {

/// Which inertial parameters a torque is made of. A view: the vectors must outlive it.
struct ParameterSets {
  /// Empty: chain.links() for every row. Otherwise n sets of n links: row j uses rows[j].
  const std::vector<std::vector<LinkParameters>>& rows;
  /// Empty: the row's own. Otherwise n links: gravity, in every row, uses these. Only their masses
  /// and first moments matter.
  const std::vector<LinkParameters>& gravity;
};

/// Rejects sets that don't fit a chain: wrong number of sets or links, non-finite numbers.
///
/// Any finite parameters will do, negative masses too: in an identified set a single figure has
/// no physical meaning. Call it once, when reading; the functions below only assert the sizes.
///
/// @throws ModelError  naming set and joint.
void checkParameterSets(const Chain& chain, const ParameterSets& sets);

// Declared here in short; they follow the functions of the same names for a Chain:
//   torques(chain, sets, q, qd, qdd, tau)
//   inertiaMatrix(chain, sets, q, H)
//   coriolisVector(chain, sets, q, qd, c)
//   gravityVector(chain, sets, q, g)
//   dynamicComponents(chain, sets, q, qd, H, c, g)

}  // namespace chain_dynamics

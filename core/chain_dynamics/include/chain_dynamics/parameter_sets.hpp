// SPDX-License-Identifier: Apache-2.0

/// @file
/// Inertial parameters of a robot whose rows have their own: what identified models are.
///
///     const ParameterSets sets{row_parameters, gravity_parameters};
///     torques(chain, sets, q, qd, qdd, tau);   // row j with set j, gravity with its own
///
/// An identified robot need not be *one* system of rigid bodies. Where each joint was identified by
/// itself, row j of the torque has its own ten parameters per link; where gravity was identified
/// apart, gravity has. Every row is still that of some system of rigid bodies, and is computed as
/// such: kinematics depend on no parameter and are shared, then the recursion goes from the tip
/// down to joint j with parameter set j. O(n^2) for all rows.
///
/// Such an H need be neither symmetric nor positive definite: row j is that of the j-th system.
///
/// Real time (up to 64 joints): no allocation, lock, exception or system call. Threads: safe.

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "chain_dynamics/chain.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Which inertial parameters each quantity is made of. A view: the vectors must outlive it.
struct ParameterSets {
  /// Empty: chain.links() for every row. Otherwise n sets of n links, and row j uses rows[j].
  const std::vector<std::vector<LinkParameters>>& rows;

  /// Empty: the row's own. Otherwise n links, whose masses and first moments are those of gravity,
  /// in every row.
  const std::vector<LinkParameters>& gravity;
};

/// Rejects sets that don't fit a chain: wrong number of sets or links, non-finite numbers.
///
/// Any finite parameters will do, negative masses too: in an identified set a single number has no
/// physical meaning. Call it once, when reading; the algorithms only assert the sizes.
///
/// @throws ModelError  naming set and joint.
void checkParameterSets(const Chain& chain, const ParameterSets& sets);

namespace internal {

// In place of ParameterSets: chain.links() for every row, gravity's too.
struct OwnParameters {};

inline bool haveSizesOf(const Chain& /*chain*/, OwnParameters /*sets*/) { return true; }
inline bool haveSizesOf(const Chain& chain, const ParameterSets& sets) {
  const std::size_t n = chain.joints().size();
  return (sets.rows.empty() || sets.rows.size() == n) &&
         (sets.gravity.empty() || sets.gravity.size() == n);
}

// The set for gravity; nullptr: there is none.
inline const std::vector<LinkParameters>* gravitySet(OwnParameters /*sets*/) { return nullptr; }
inline const std::vector<LinkParameters>* gravitySet(const ParameterSets& sets) {
  return sets.gravity.empty() ? nullptr : &sets.gravity;
}

// Gravity as a part of the links' motion: none if it has a set of its own.
template <typename Sets>
Eigen::Vector3d gravityOfMotion(const Chain& chain, const Sets& sets) {
  if (gravitySet(sets) != nullptr) return Eigen::Vector3d::Zero();
  return chain.gravity();
}

// compute(links, first) gives rows first to n - 1 of a matrix or vector; row j is to be that of set j.
template <typename Compute>
void forEachSet(const Chain& chain, OwnParameters /*sets*/, const Compute& compute) {
  compute(chain.links(), Eigen::Index{0});
}
template <typename Compute>
void forEachSet(const Chain& chain, const ParameterSets& sets, const Compute& compute) {
  if (sets.rows.empty()) return compute(chain.links(), Eigen::Index{0});
  // set j gives rows j to n - 1, of which set j + 1 then overwrites all but row j
  for (Eigen::Index j = 0; j < chain.jointCount(); ++j) {
    compute(sets.rows[static_cast<std::size_t>(j)], j);
  }
}

}  // namespace internal

}  // namespace v2
}  // namespace chain_dynamics

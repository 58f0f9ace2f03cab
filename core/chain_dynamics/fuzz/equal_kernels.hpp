// SPDX-License-Identifier: Apache-2.0

/// @file
/// Whether the fast kernels give what the readable functions of model.hpp give.
///
///     requireEqualKernels(model, {q, qd, qdd});   // ends the program where they don't

#pragma once

#include <Eigen/Core>

#include "chain_dynamics/model.hpp"

namespace chain_dynamics::fuzz {

/// Positions, velocities, accelerations; n numbers each.
struct State {
  Eigen::VectorXd q, qd, qdd;
};

/// How large the terms get that torques are added up from: the recursion of torques.hpp, with the
/// norm in place of each vector and plus in place of each minus; N m (prismatic N). What is lost by
/// rounding is in proportion to it.
double largestTerm(const Model& model, const State& state, double gravity);

/// Compares every quantity of every instruction set of this processor, of one state and of a batch.
///
/// Each entry may differ by the rounding of some hundred operations per joint on the largest of the
/// terms that it is added up from: with cancellation, no algorithm can keep more. Prints the
/// quantity and calls std::abort() where an entry differs by more, or where it is NaN.
void requireEqualKernels(const Model& model, const State& state);

}  // namespace chain_dynamics::fuzz

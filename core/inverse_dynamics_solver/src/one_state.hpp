// SPDX-License-Identifier: Apache-2.0
/// @file
/// One state after the other of a batch of any layout, as the functions of one state take them:
/// contiguous, copied only where it isn't.
///
///     eachState([this](const auto&... of_state) { computeGravityVector(of_state...); }, q, g);
#pragma once

#include <Eigen/Core>

#include "chain_dynamics/scratch.hpp"
#include "inverse_dynamics_solver/states.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Chains up to this many joints are computed without allocation.
constexpr int kMaxStackJoints = 64;

/// Numbers on the stack up to `StackSize`, on the heap beyond.
template <int StackSize>
using Scratch = chain_dynamics::Scratch<double, StackSize>;

/// Inputs of one state at a time.
class StateReader {
 public:
  explicit StateReader(const ConstStates& states)
      : states_(states), copy_(states.joint_step == 1 ? 0 : states.joints) {}

  /// n numbers; valid until the next call.
  Eigen::Map<const Eigen::VectorXd> operator()(Eigen::Index state) {
    // (no numbers, so perhaps no memory, where the positions aren't known)
    if (states_.joint_step == 1) return {states_.data + state * states_.state_step, states_.joints};
    for (Eigen::Index j = 0; j < states_.joints; ++j) copy_[j] = states_(j, state);
    return {&copy_[0], states_.joints};
  }
  void done(Eigen::Index) const {}

 private:
  const ConstStates states_;
  Scratch<kMaxStackJoints> copy_;
};

/// Outputs of one state at a time: vectors, being matrices of one column, or matrices.
template <class Plain>
class StateWriter {
 public:
  explicit StateWriter(const StridedMatrices& to)
      : to_(to), copy_(isInPlace() ? 0 : to.rows * to.columns) {}

  /// Where to write the numbers of a state: in the batch, or in a copy.
  Eigen::Map<Plain, 0, Eigen::OuterStride<>> operator()(Eigen::Index state) {
    double* const first = isInPlace() ? &to_(0, 0, state) : &copy_[0];
    const Eigen::OuterStride<> step(isInPlace() ? to_.column_step : to_.rows);
    return {first, to_.rows, to_.columns, step};
  }

  /// They are written.
  void done(Eigen::Index state) {
    if (isInPlace()) return;
    for (Eigen::Index j = 0; j < to_.columns; ++j) {
      for (Eigen::Index i = 0; i < to_.rows; ++i) to_(i, j, state) = copy_[i + j * to_.rows];
    }
  }

 private:
  // Whether Eigen::Ref can refer to it.
  bool isInPlace() const { return to_.row_step == 1 && to_.column_step >= to_.rows; }

  const StridedMatrices to_;
  Scratch<Plain::IsVectorAtCompileTime ? kMaxStackJoints : kMaxStackJoints * kMaxStackJoints> copy_;
};

inline StateReader eachOf(const ConstStates& inputs) { return StateReader(inputs); }
inline StateWriter<Eigen::MatrixXd> eachOf(const StridedMatrices& outputs) {
  return StateWriter<Eigen::MatrixXd>(outputs);
}
inline StateWriter<Eigen::VectorXd> eachOf(const States& of) {
  return StateWriter<Eigen::VectorXd>(
      {of.data, of.joints, 1, of.count, of.joint_step, of.joints, of.state_step});
}

/// Calls compute() with the inputs and outputs of each state.
template <class Compute, class... Views>
void eachState(const Compute& compute, const ConstStates& first, const Views&... others) {
  const auto each = [&](auto&&... of) {
    for (Eigen::Index k = 0; k < first.count; ++k) {
      compute(of(k)...);
      (of.done(k), ...);
    }
  };
  each(eachOf(first), eachOf(others)...);
}

}  // namespace v2
}  // namespace inverse_dynamics_solver

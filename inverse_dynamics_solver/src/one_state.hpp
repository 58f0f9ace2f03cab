// SPDX-License-Identifier: Apache-2.0
/// @file
/// One state after the other of a batch of any layout, as the functions of one state take them:
/// contiguous, copied only where it isn't.
///
///     eachState(q.count, [this](const auto&... of_state) { computeGravityVector(of_state...); },
///               StateReader(q), StateWriter(g));
#pragma once

#include <Eigen/Core>
#include <vector>

#include "inverse_dynamics_solver/states.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// Chains up to this many joints are computed without allocation.
constexpr int kMaxStackJoints = 64;

/// Uninitialized numbers: on the stack up to `StackSize`, on the heap beyond.
template <int StackSize>
class Scratch {
 public:
  explicit Scratch(Eigen::Index size) {
    if (size > StackSize) heap_.resize(static_cast<std::size_t>(size));
  }
  double* data() { return heap_.empty() ? stack_ : heap_.data(); }

 private:
  double stack_[StackSize];
  std::vector<double> heap_;
};

/// Inputs of one state at a time.
class StateReader {
 public:
  explicit StateReader(const ConstStates& states)
      : states_(states), copy_(states.joint_step == 1 ? 0 : states.joints) {}

  /// n numbers; valid until the next call.
  Eigen::Map<const Eigen::VectorXd> operator()(Eigen::Index state) {
    // (no numbers, so perhaps no memory, where the positions aren't known)
    if (states_.joint_step == 1) return {states_.data + state * states_.state_step, states_.joints};
    for (Eigen::Index j = 0; j < states_.joints; ++j) copy_.data()[j] = states_(j, state);
    return {copy_.data(), states_.joints};
  }
  void done(Eigen::Index) const {}

 private:
  const ConstStates states_;
  Scratch<kMaxStackJoints> copy_;
};

/// Outputs of one state at a time.
class StateWriter {
 public:
  explicit StateWriter(const States& states)
      : states_(states), copy_(states.joint_step == 1 ? 0 : states.joints) {}

  /// Where to write a state's n numbers: in the batch, or in a copy.
  Eigen::Map<Eigen::VectorXd> operator()(Eigen::Index state) {
    return {states_.joint_step == 1 ? &states_(0, state) : copy_.data(), states_.joints};
  }

  /// They are written.
  void done(Eigen::Index state) {
    if (states_.joint_step == 1) return;
    for (Eigen::Index j = 0; j < states_.joints; ++j) states_(j, state) = copy_.data()[j];
  }

 private:
  const States states_;
  Scratch<kMaxStackJoints> copy_;
};

/// Matrices of one state at a time.
class MatrixWriter {
 public:
  explicit MatrixWriter(const StridedMatrices& matrices)
      : matrices_(matrices), copy_(isColumns() ? 0 : matrices.rows * matrices.columns) {}

  /// As those of StateWriter.
  Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>> operator()(Eigen::Index state) {
    const Eigen::Index rows = matrices_.rows, columns = matrices_.columns;
    if (isColumns()) {
      return {&matrices_(0, 0, state), rows, columns, Eigen::OuterStride<>(matrices_.column_step)};
    }
    return {copy_.data(), rows, columns, Eigen::OuterStride<>(rows)};
  }
  void done(Eigen::Index state) {
    if (isColumns()) return;
    const Eigen::Index rows = matrices_.rows;
    for (Eigen::Index j = 0; j < matrices_.columns; ++j) {
      for (Eigen::Index i = 0; i < rows; ++i) matrices_(i, j, state) = copy_.data()[i + j * rows];
    }
  }

 private:
  // What Eigen::Ref<MatrixXd> can look at.
  bool isColumns() const {
    return matrices_.row_step == 1 && matrices_.column_step >= matrices_.rows;
  }

  const StridedMatrices matrices_;
  Scratch<kMaxStackJoints * kMaxStackJoints> copy_;
};

/// Calls compute() with what the readers and writers give of each state.
template <class Compute, class... ReadersAndWriters>
void eachState(Eigen::Index count, const Compute& compute, ReadersAndWriters&&... of) {
  for (Eigen::Index k = 0; k < count; ++k) {
    compute(of(k)...);
    (of.done(k), ...);
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_solver

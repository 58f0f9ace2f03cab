// SPDX-License-Identifier: Apache-2.0

/// @file
/// What sums over branches share, of one state and of many.

#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "chain_dynamics/owned.hpp"
#include "fast_branches.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace kernel_sums {  // apart from functions of other sources, which have the same names

using Eigen::Index;
using fast::Matrices;
using fast::Robot;

constexpr int kMost = FastModel::kMaxJoints;

inline const FastBranches& branchesOf(const Robot& robot) {
  return static_cast<const FastBranches&>(robot);
}

struct Numbers {
  double numbers[kMost];
};

inline Index jointsOf(const FastBranch& b) { return b.branch.chain.jointCount(); }

/// `sum += S' of_branch S`, of a matrix whose columns stand one after the other.
inline void addMatrix(const FastBranch& b, const double* of_branch, const Matrices& sum) {
  const Index m = jointsOf(b);
  if (!b.coordinates.empty()) {
    for (Index j = 0; j < m; ++j) {
      const double* const from = of_branch + j * m;
      double* const to = sum.data + b.coordinates[static_cast<std::size_t>(j)] * sum.column_step;
      for (Index i = 0; i < m; ++i) {
        to[b.coordinates[static_cast<std::size_t>(i)] * sum.row_step] += from[i];
      }
    }
    return;
  }
  for (const Follow& column : b.branch.S) {
    const double* const from = of_branch + column.joint * m;
    double* const to = sum.data + column.coordinate * sum.column_step;
    for (const Follow& row : b.branch.S) {
      to[row.coordinate * sum.row_step] += row.factor * column.factor * from[row.joint];
    }
  }
}

/// Adds the numbers to a diagonal.
inline void addToDiagonal(const OwnedVector& numbers, const Matrices& matrix) {
  for (Index j = 0; j < numbers.size(); ++j) {
    matrix.data[j * (matrix.row_step + matrix.column_step)] += numbers[j];
  }
}

inline void setZero(const Matrices& matrix, Index rows, Index columns) {
  for (Index j = 0; j < columns; ++j) {
    for (Index i = 0; i < rows; ++i) {
      matrix.data[i * matrix.row_step + j * matrix.column_step] = 0;
    }
  }
}

}  // namespace kernel_sums
}  // namespace v2
}  // namespace chain_dynamics

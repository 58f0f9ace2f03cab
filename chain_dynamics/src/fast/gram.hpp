// SPDX-License-Identifier: Apache-2.0

/// @file
/// Gram matrices of the rows of the regressor, of many states.
///
/// Included by many_kernels.cpp only [pack.hpp]. The rows of a few states go to memory that stays in
/// the cache, the rows of a joint side by side, and from there into the sums.

#pragma once

#include "many_states.hpp"
#include "regressor.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

FAST_INLINE Pack gatherOne(const Samples& from, int joint, const Lanes& lanes) {
  Pack pack{};
  const double* const numbers = from.data + joint * from.joint_step;
  for (int lane = 0; lane < kWidth; ++lane) pack[lane] = numbers[lanes[lane] * from.state_step];
  return pack;
}

FAST_INLINE Pack rootOf(const Pack& squares) {
  Pack roots{};
  for (int lane = 0; lane < kWidth; ++lane) roots[lane] = __builtin_sqrt(squares[lane]);
  return roots;
}

/// Rows of a pack of states, whose weights' roots they come times; the first is `to` in memory.
inline void writeRows(const Robot& robot, const GramInputs& inputs, const Lanes& lanes, int to,
                      double* memory) {
  const int n = robot.joints;
  const Lanes target{to, lanes.count};
  PackOfStates<> x;
  Pack scale[kMaxJoints];
  double* rows[kMaxJoints];  // of each joint
  x.read(robot, inputs.q, inputs.qd, inputs.qdd, lanes);
  for (int j = 0; j < n; ++j) {
    scale[j] = all<Pack>(1.0);
    if (inputs.weights != nullptr) scale[j] = rootOf(gatherOne(*inputs.weights, j, lanes));
    rows[j] = memory;
    memory += kGramStates * gramRow(n, j, inputs.column_count);
  }
  forEachRegressorLink(robot, x.state(), scale,
                       [&](int i, const auto& motion, const auto* w, const auto* v) FAST_LAMBDA {
                         for (int j = 0; j <= i; ++j) {
                           Pack columns[10];
                           regressorColumns(motion, w[j], v[j], columns);
                           scatter<10>(columns, 10, target, rows[j] + std::ptrdiff_t{10} * (i - j),
                                       1, gramRow(n, j, inputs.column_count));
                         }
                       });
  for (int j = 0; j < n; ++j) {
    const std::ptrdiff_t size = gramRow(n, j, inputs.column_count);
    double* const own = rows[j] + std::ptrdiff_t{10} * (n - j);
    for (int k = 0; k <= inputs.column_count; ++k) {
      const Samples& from = k < inputs.column_count ? inputs.columns[k] : inputs.tau;
      const Pack numbers = scale[j] * gatherOne(from, j, lanes);
      scatter(&numbers, 1, target, own + k, 1, size);
    }
  }
}

/// Of sums(a, b), both below `size`, so many rows from a on and so many packs from b on.
template <int Rows, int Packs>
FAST_INLINE void addTile(const double* rows, int states, std::ptrdiff_t size, std::ptrdiff_t a,
                         std::ptrdiff_t b, double* sums) {
  Pack sum[Rows][Packs] = {};
  for (int k = 0; k < states; ++k, rows += size) {
    countUp<0, Packs>([&](auto p) FAST_LAMBDA {
      const Pack right = load<Pack>(rows + b + p * kWidth);
      countUp<0, Rows>([&](auto r) FAST_LAMBDA { sum[r][p] += rows[a + r] * right; });
    });
  }
  countUp<0, Rows>([&](auto r) FAST_LAMBDA {
    double* const to = sums + (a + r) * size + b;
    countUp<0, Packs>([&](auto p) FAST_LAMBDA {
      store(load<Pack>(to + p * kWidth) + sum[r][p], to + p * kWidth);
    });
  });
}

/// sums += rows' rows, where b is not before a; sizes are multiples of eight.
inline void addSquares(const double* rows, int states, std::ptrdiff_t size, double* sums) {
  constexpr int kRows = 4;
  constexpr int kPacks = 3;
  constexpr std::ptrdiff_t kStep = std::ptrdiff_t{kPacks} * kWidth;
  for (std::ptrdiff_t a = 0; a < size; a += kRows) {
    std::ptrdiff_t b = a / kWidth * kWidth;
    for (; b + kStep <= size; b += kStep) {
      addTile<kRows, kPacks>(rows, states, size, a, b, sums);
    }
    for (; b < size; b += kWidth) addTile<kRows, 1>(rows, states, size, a, b, sums);
  }
}

/// Adds the states to `sums`: for each joint a matrix of gramRow() squared, row after row, of which
/// the upper triangle is written. memory: kGramStates rows of each joint.
void gramOfStates(const Robot& robot, std::ptrdiff_t states, const GramInputs& inputs,
                  double* memory, double* sums) {
  const int n = robot.joints;
  for (std::ptrdiff_t first = 0; first < states; first += kGramStates) {
    const std::ptrdiff_t left = states - first;
    const int count = left < kGramStates ? static_cast<int>(left) : kGramStates;
    for (int k = 0; k < count; k += kWidth) {
      const int in_pack = count - k < kWidth ? count - k : kWidth;
      writeRows(robot, inputs, Lanes{first + k, in_pack}, k, memory);
    }
    const double* rows = memory;
    double* sum = sums;
    for (int j = 0; j < n; ++j) {
      const std::ptrdiff_t size = gramRow(n, j, inputs.column_count);
      addSquares(rows, count, size, sum);
      rows += kGramStates * size;
      sum += size * size;
    }
  }
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics

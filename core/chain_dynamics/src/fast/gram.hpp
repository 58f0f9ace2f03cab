// SPDX-License-Identifier: Apache-2.0

/// @file
/// Gram matrices of the rows of the regressor, of many states.
///
/// Included by many_kernels.cpp only [pack.hpp]. The rows of a few states go to memory that stays in
/// the cache, the rows of a joint side by side, and from there into the sums: those of own columns and
/// torque come first in them.

#pragma once

#include <cstddef>

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

/// Square roots of the weights of a pack of states.
inline void readScale(const Robot& robot, const GramInputs& inputs, const Lanes& lanes,
                      Pack* scale) {
  for (int j = 0; j < robot.joints; ++j) {
    scale[j] = all<Pack>(1.0);
    if (inputs.weights != nullptr) scale[j] = rootOf(gatherOne(*inputs.weights, j, lanes));
  }
}

/// Rows of links of a pack of states, the first of which is `to` in memory, times a scale.
inline void writeLinks(const Robot& robot, const GramInputs& inputs, const Lanes& lanes, int to,
                       const Pack* scale, double* memory) {
  const int n = robot.joints;
  const Lanes target{to, lanes.count};
  PackOfStates<> x;
  double* rows[kMaxJoints];  // of each joint
  x.read(robot, inputs.q, inputs.qd, inputs.qdd, lanes);
  for (int j = 0; j < n; ++j) {
    rows[j] = memory;
    memory += kGramStates * linksRow(n, j);
  }
  forEachRegressorLink(robot, x.state(), scale,
                       [&](int i, const auto& motion, const auto* w, const auto* v) FAST_LAMBDA {
                         for (int j = 0; j <= i; ++j) {
                           Pack columns[10];
                           regressorColumns(motion, w[j], v[j], columns);
                           scatter<10>(columns, 10, target, rows[j] + std::ptrdiff_t{10} * (i - j),
                                       1, linksRow(n, j));
                         }
                       });
}

/// Own columns and torques of these states.
inline void writeOwn(const Robot& robot, const GramInputs& inputs, const Lanes& lanes, int to,
                     const Pack* scale, double* memory) {
  const Lanes target{to, lanes.count};
  const std::ptrdiff_t size = ownRow(inputs.column_count);
  for (int j = 0; j < robot.joints; ++j, memory += kGramStates * size) {
    for (int k = 0; k <= inputs.column_count; ++k) {
      const Samples& from = k < inputs.column_count ? inputs.columns[k] : inputs.tau;
      const Pack numbers = scale[j] * gatherOne(from, j, lanes);
      scatter(&numbers, 1, target, memory + k, 1, size);
    }
  }
}

/// Rows of a few states: sizes are multiples of eight, what is used of them of four.
struct Panel {
  const double* numbers;
  std::ptrdiff_t size, used;
};

/// Adds products of so many numbers of the left rows and so many packs of the right ones.
template <int Count, int Packs>
FAST_INLINE void addTile(Panel left, Panel right, int states, double* sums, std::ptrdiff_t step) {
  Pack sum[Count][Packs] = {};
  for (int k = 0; k < states; ++k, left.numbers += left.size, right.numbers += right.size) {
    countUp<0, Packs>([&](auto p) FAST_LAMBDA {
      const Pack numbers = load<Pack>(right.numbers + p * kWidth);
      countUp<0, Count>([&](auto r) FAST_LAMBDA { sum[r][p] += left.numbers[r] * numbers; });
    });
  }
  countUp<0, Count>([&](auto r) FAST_LAMBDA {
    countUp<0, Packs>([&](auto p) FAST_LAMBDA {
      double* const to = sums + r * step + p * kWidth;
      store(load<Pack>(to) + sum[r][p], to);
    });
  });
}

/// sums += left' right; of the same rows, the upper triangle.
inline void addProducts(const Panel& left, const Panel& right, int states, double* sums,
                        std::ptrdiff_t step) {
  constexpr int kRows = 4;
  constexpr int kPacks = 3;
  for (std::ptrdiff_t a = 0; a < left.used; a += kRows) {
    const Panel from{left.numbers + a, left.size, kRows};
    std::ptrdiff_t b = left.numbers == right.numbers ? a / kWidth * kWidth : 0;
    for (; b + kPacks * kWidth <= right.size; b += kPacks * kWidth) {
      addTile<kRows, kPacks>(from, {right.numbers + b, right.size, kWidth}, states,
                             sums + a * step + b, step);
    }
    for (; b < right.size; b += kWidth) {
      addTile<kRows, 1>(from, {right.numbers + b, right.size, kWidth}, states, sums + a * step + b,
                        step);
    }
  }
}

/// Adds up to kGramStates states to the sums.
inline void addRows(const Robot& robot, int states, const GramInputs& inputs, const double* links,
                    const GramMemory& to) {
  const int n = robot.joints;
  Panel own{to.own, ownRow(inputs.column_count), (inputs.column_count + 1 + 3) / 4 * 4};
  double* sums = to.sums;
  for (int j = 0; j < n; ++j) {
    const Panel of_links{links, linksRow(n, j), linksRow(n, j)};
    const std::ptrdiff_t size = own.size + of_links.size;
    addProducts(own, own, states, sums, size);
    addProducts(own, of_links, states, sums + own.size, size);
    if (inputs.links) addProducts(of_links, of_links, states, sums + own.size * (size + 1), size);
    own.numbers += kGramStates * own.size;
    links += kGramStates * of_links.size;
    sums += size * size;
  }
}

void gramOfStates(const Robot& robot, std::ptrdiff_t states, const GramInputs& inputs,
                  const GramMemory& to) {
  const std::ptrdiff_t size = kGramStates * linksRows(robot.joints);
  for (std::ptrdiff_t part = 0, first = 0; first < states; ++part, first += kGramStates) {
    double* const made = to.links + (to.keep ? part * size : 0);
    const double* const links = inputs.rows != nullptr ? inputs.rows + part * size : made;
    const std::ptrdiff_t left = states - first;
    const int count = left < kGramStates ? static_cast<int>(left) : kGramStates;
    for (int k = 0; k < count; k += kWidth) {
      const Lanes lanes{first + k, count - k < kWidth ? count - k : kWidth};
      Pack scale[kMaxJoints];
      readScale(robot, inputs, lanes, scale);
      if (inputs.rows == nullptr) writeLinks(robot, inputs, lanes, k, scale, made);
      writeOwn(robot, inputs, lanes, k, scale, to.own);
    }
    addRows(robot, count, inputs, links, to);
  }
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics

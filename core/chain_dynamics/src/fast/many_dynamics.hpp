// SPDX-License-Identifier: Apache-2.0

/// @file
/// Forward dynamics, derivatives and regressor of many states, a pack at a time.
///
/// N is the number of joints where the compiler is to know it, or zero.
///
/// Included by many_kernels.cpp only [pack.hpp].

#pragma once

#include <cstddef>

#include "linear_solve.hpp"
#include "many_states.hpp"
#include "regressor.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

constexpr int kPackedEntries = kPackedMatrixJoints * kPackedMatrixJoints;

template <int N>
void forwardDynamicsBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                          Samples qd, Samples tau, Samples qdd) {
  const int n = jointsOf<N>(robot);
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<kPackedMatrixJoints> x;
    Pack given[kPackedMatrixJoints];
    Pack bias[kPackedMatrixJoints];
    Pack H[kPackedEntries];
    x.readAtRest<N>(robot, qd, lanes);
    x.readPositions<N>(robot, q, lanes, FirstJoint::kForGravity);
    gather<N>(robot, tau, lanes, given);
    torquesOf(robot, structure, x.state(), bias);
    for (int i = 0; i < n; ++i) given[i] -= bias[i];
    if (robot.changing_steps) {
      addChangingFriction(robot, structure, x.state(), -1.0, given);
    } else if (robot.friction != nullptr) {
      for (int i = 0; i < n; ++i) given[i] -= frictionOfPack(robot, i, x.qd[i]);
    }
    recursionsOf<Pack>(structure).inertia(robot, x.state(), Entries<Pack>{H, n, 1});
    solveSymmetric(n, H, given);
    scatter<N>(robot, given, lanes, qdd);
  });
}

/// Packs of the entries of matrices, (i, j) at i + j rows, to the matrices of each state.
FAST_INLINE void scatterMatrix(Pack* entries, int n, const Lanes& lanes, const Matrices& to) {
  if (to.column_step == 1) {
    for (int i = 1; i < n; ++i) {
      for (int j = 0; j < i; ++j) {
        const Pack above = entries[j + i * n];
        entries[j + i * n] = entries[i + j * n];
        entries[i + j * n] = above;
      }
    }
  }
  scatterColumns(entries, n, n, lanes, sideBySide(to));
}

void torqueDerivativesBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                            Samples qd, Samples qdd, Matrices by_q, Matrices by_qd,
                            Matrices by_qdd) {
  const int n = robot.joints;
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<kPackedMatrixJoints> x;
    Pack entries[3][kPackedEntries];
    x.read(robot, q, qd, qdd, lanes);
    const DerivativeEntries<Pack> to{entries[0], entries[1], entries[2], n};
    derivativesOf(robot, structure, x.state(), to);
    if (robot.changing_steps) {
      addChangingFrictionDerivatives(robot, structure, x.state(), to);
    } else if (robot.friction != nullptr) {
      for (int i = 0; i < n; ++i) entries[1][i + i * n] += frictionSlopeOfPack(robot, i, x.qd[i]);
    }
    scatterMatrix(entries[0], n, lanes, by_q);
    scatterMatrix(entries[1], n, lanes, by_qd);
    scatterMatrix(entries[2], n, lanes, by_qdd);
  });
}

void coriolisMatrixBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                         Samples qd, Matrices C) {
  const int n = robot.joints;
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<kPackedMatrixJoints> x;
    Pack entries[kPackedEntries];
    gather(robot, qd, lanes, x.qd);
    x.readPositions(robot, q, lanes, FirstJoint::kUnused);
    coriolisMatrixOf<Pack>(robot, structure)(robot, x.state(), entries, n);
    scatterMatrix(entries, n, lanes, C);
  });
}

/// Ten columns of link i to each Y, in rows, of which those after joint i are zero.
FAST_INLINE void writeRows(const OwnMotion<Pack>& motion, const Vec<Pack>* w, const Vec<Pack>* v,
                           int n, int i, const Lanes& lanes, Matrices Y) {
  double* const link = Y.data + std::ptrdiff_t{10} * i * Y.column_step;
  for (int j = 0; j <= i; ++j) {
    Pack columns[10];
    regressorColumns(motion, w[j], v[j], columns);
    scatter<10>(columns, 10, lanes, link + j * Y.row_step, Y.column_step, Y.state_step);
  }
  for (int j = i + 1; j < n; ++j) {
    for (int k = 0; k < lanes.count; ++k) {
      double* const row = link + j * Y.row_step + lanes[k] * Y.state_step;
      for (int column = 0; column < 10; ++column) row[column * Y.column_step] = 0;
    }
  }
}

/// Ten columns of link i to as many matrices as a pack has lanes, with their numbers side by side. In
/// blocks of rows, from last to first: the last block overlaps the one before. The memory `ahead` of
/// each number, where the next ones go, comes into the cache meanwhile.
FAST_INLINE void writeColumns(const OwnMotion<Pack>& motion, const Vec<Pack>* w, const Vec<Pack>* v,
                              int n, int i, double* to, std::ptrdiff_t state_step,
                              std::ptrdiff_t ahead) {
  for (int row = (n - 1) / kShortWidth * kShortWidth; row >= 0; row -= kShortWidth) {
    const int first = row < n - kShortWidth ? row : n - kShortWidth;
    countUp<0, 10>([&](auto column) FAST_LAMBDA {
      constexpr int kColumn = column;
      double* const rows = to + first + std::ptrdiff_t{kColumn} * n;
      if (row == 0) {
        for (int k = 0; k < kWidth; ++k) __builtin_prefetch(rows + k * state_step + ahead, 1);
      }
      if (row > i) {
        for (int k = 0; k < kWidth; ++k) store(Short{}, rows + k * state_step);
        return;
      }
      Pack block[kShortWidth];
      countUp<0, kShortWidth>([&](auto k) FAST_LAMBDA {
        block[k] = regressorColumn<kColumn>(motion, w[first + k], v[first + k]);
      });
      storeTransposed(block, rows, state_step);
    });
  }
}

/// Ten columns of the first `states` matrices, whose numbers stand side by side in `from`.
FAST_APART void copyColumns(const double* from, int n, int states, const Matrices& to) {
  for (int k = 0; k < states; ++k) {
    for (int column = 0; column < 10; ++column, from += n) {
      double* const target = to.data + column * to.column_step + k * to.state_step;
      for (int row = 0; row < n; ++row) target[row] = from[row];
    }
  }
}

template <int N>
void regressorBatch(const Robot& robot, std::ptrdiff_t states, Samples q, Samples qd, Samples qdd,
                    Matrices Y) {
  const int n = jointsOf<N>(robot);
  const std::ptrdiff_t link_size = std::ptrdiff_t{10} * n;
  const bool by_columns = Y.row_step == 1 && n >= kShortWidth;
  double apart[kWidth * 10 * kMaxJoints];
  Pack one[kMaxJoints];
  for (int i = 0; i < n; ++i) one[i] = all<Pack>(1.0);
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<> x;
    x.read<N>(robot, q, qd, qdd, lanes);
    const auto write = [&](int i, const auto& motion, const auto* w, const auto* v) FAST_LAMBDA {
      if (by_columns) {
        Matrices link = Y;
        link.data += std::ptrdiff_t{10} * i * Y.column_step + lanes.first * Y.state_step;
        const bool in_place = lanes.count == kWidth && Y.column_step == n;
        double* const to = in_place ? link.data : apart;
        const std::ptrdiff_t step = in_place ? Y.state_step : link_size;
        const std::ptrdiff_t next = i + 1 < n ? link_size : kWidth * step - i * link_size;
        writeColumns(motion, w, v, n, i, to, step, next);
        if (!in_place) copyColumns(apart, n, lanes.count, link);
      } else if (Y.column_step == 1) {  // for the compiler to know
        writeRows(motion, w, v, n, i, lanes, {Y.data, Y.row_step, 1, Y.state_step});
      } else {
        writeRows(motion, w, v, n, i, lanes, Y);
      }
    };
    forEachRegressorLink(robot, x.state(), one, write);
  });
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics

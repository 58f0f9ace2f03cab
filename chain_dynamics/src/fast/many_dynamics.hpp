// SPDX-License-Identifier: Apache-2.0

/// @file
/// Forward dynamics, derivatives and regressor of many states, a pack at a time.
///
/// N is the number of joints where the compiler is to know it, or zero.
///
/// Included by many_kernels.cpp only [pack.hpp].

#pragma once

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
    x.readPositions<N>(robot, q, lanes, true);
    gather<N>(robot, tau, lanes, given);
    torquesOf(robot, structure, x.state(), bias);
    for (int i = 0; i < n; ++i) given[i] -= bias[i];
    if (robot.friction != nullptr) {
      for (int i = 0; i < n; ++i) given[i] -= frictionOfPack(robot, i, x.qd[i]);
    }
    recursionsOf<Pack>(structure).inertia(robot, x.state(), Entries<Pack>{H, n, 1});
    solveSymmetric(n, H, given);
    scatter<N>(robot, given, lanes, qdd);
  });
}

/// Packs of the entries of matrices, (i, j) at i + j rows, to the matrices of each state.
template <int N>
FAST_INLINE void scatterMatrix(Pack* entries, int n, const Lanes& lanes, const Matrices& to) {
  const bool columns = to.column_step != 1;
  if (!columns) {
    for (int i = 1; i < n; ++i) {
      for (int j = 0; j < i; ++j) {
        const Pack above = entries[j + i * n];
        entries[j + i * n] = entries[i + j * n];
        entries[i + j * n] = above;
      }
    }
  }
  // columns in turn, or rows, whichever stand side by side
  const std::ptrdiff_t major_step = columns ? to.column_step : to.row_step;
  const std::ptrdiff_t minor_step = columns ? to.row_step : 1;
  if (minor_step == 1 && major_step == n) {
    scatter<0>(entries, n * n, lanes, to.data, 1, to.state_step);
    return;
  }
  for (int j = 0; j < n; ++j) {
    scatter<0>(entries + std::ptrdiff_t{j} * n, n, lanes, to.data + j * major_step, minor_step,
               to.state_step);
  }
}

template <int N>
void torqueDerivativesBatch(const Robot& robot, int structure, std::ptrdiff_t states, Samples q,
                            Samples qd, Samples qdd, Matrices by_q, Matrices by_qd,
                            Matrices by_qdd) {
  const int n = jointsOf<N>(robot);
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<kPackedMatrixJoints> x;
    Pack entries[3][kPackedEntries];
    x.read<N>(robot, q, qd, qdd, lanes);
    derivativesOf(robot, structure, x.state(),
                  DerivativeEntries<Pack>{entries[0], entries[1], entries[2], n});
    for (int i = 0; robot.friction != nullptr && i < n; ++i) {
      entries[1][i + i * n] += frictionSlopeOfPack(robot, i, x.qd[i]);
    }
    scatterMatrix<N>(entries[0], n, lanes, by_q);
    scatterMatrix<N>(entries[1], n, lanes, by_qd);
    scatterMatrix<N>(entries[2], n, lanes, by_qdd);
  });
}

/// The ten columns of link i for all rows, (j, column) at j + column n, to each state's Y.
FAST_INLINE void scatterLink(const Pack* part, int n, int i, const Lanes& lanes,
                             const Matrices& Y) {
  double* const link = Y.data + 10 * i * Y.column_step;
  if (Y.row_step == 1 && Y.column_step == n) {
    return scatter<0>(part, 10 * n, lanes, link, 1, Y.state_step);
  }
  for (int column = 0; column < 10; ++column) {
    scatter<0>(part + std::ptrdiff_t{column} * n, n, lanes, link + column * Y.column_step,
               Y.row_step, Y.state_step);
  }
}

template <int N>
void regressorBatch(const Robot& robot, std::ptrdiff_t states, Samples q, Samples qd, Samples qdd,
                    Matrices Y) {
  const int n = jointsOf<N>(robot);
  const bool by_rows = Y.column_step == 1;
  Pack one[kMaxJoints];
  for (int i = 0; i < n; ++i) one[i] = all<Pack>(1.0);
  forEachPack(states, [&](const Lanes& lanes) {
    PackOfStates<> x;
    Pack part[10 * kMaxJoints];
    x.read<N>(robot, q, qd, qdd, lanes);
    forEachRegressorPart(robot, x.state(), one, [&](int i, int j, const Pack* columns) FAST_LAMBDA {
      if (by_rows) {
        scatter<10>(columns, 10, lanes, Y.data + j * Y.row_step + 10 * i, 1, Y.state_step);
        for (int row = i + 1; j == i && row < n; ++row) {
          for (int k = 0; k < lanes.count; ++k) {
            double* const to = Y.data + row * Y.row_step + 10 * i + lanes[k] * Y.state_step;
            for (int column = 0; column < 10; ++column) to[column] = 0;
          }
        }
        return;
      }
      for (int column = 0; column < 10; ++column) part[j + column * n] = columns[column];
      if (j < i) return;
      for (int row = i + 1; row < n; ++row) {
        for (int column = 0; column < 10; ++column) part[row + column * n] = Pack{};
      }
      scatterLink(part, n, i, lanes, Y);
    });
  });
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics

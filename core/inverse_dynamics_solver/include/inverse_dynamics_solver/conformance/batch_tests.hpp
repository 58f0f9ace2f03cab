// SPDX-License-Identifier: Apache-2.0
/// @file
/// Conformance, part three: many states at once, their layouts and threads. Include
/// conformance_tests.hpp, not this.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "inverse_dynamics_solver/conformance/capabilities.hpp"
#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"

namespace inverse_dynamics_solver::conformance {

/// Where the numbers of N matrices r x c stand; vectors are r x 1.
struct BatchLayout {
  using Steps = Eigen::Matrix<Eigen::Index, 3, 1>;

  const char* name;
  /// From row to row, column to column, state to state.
  Steps (*steps)(Eigen::Index r, Eigen::Index c, Eigen::Index N);
};

inline std::vector<BatchLayout> batchLayouts() {
  using I = Eigen::Index;
  using S = BatchLayout::Steps;
  return {{"one state per column", [](I r, I c, I) { return S(1, r, r * c); }},
          {"r x (c N) row after row", [](I, I c, I N) { return S(c * N, 1, c); }},
          {"matrices in C order", [](I r, I c, I) { return S(c, 1, r * c); }},
          {"states side by side", [](I r, I, I N) { return S(N, r * N, 1); }},
          {"gaps", [](I r, I c, I) { return S(2, 2 * r + 1, 2 * (r + 1) * c + 3); }},
          {"backwards", [](I r, I c, I) { return S(-1, -r, -r * c); }}};
}

/// Matrices of many states, in memory of any layout; NaN where nothing is written.
class BatchMemory {
 public:
  BatchMemory(const BatchLayout& layout, Eigen::Index rows, Eigen::Index columns,
              Eigen::Index count)
      : rows_(rows),
        columns_(columns),
        count_(count),
        steps_(layout.steps(rows, columns, count)),
        first_(steps_.cwiseAbs().dot(BatchLayout::Steps(rows, columns, count))),
        numbers_(
            Eigen::VectorXd::Constant(2 * first_ + 1, std::numeric_limits<double>::quiet_NaN())) {}

  States states() { return {numbers_.data() + first_, rows_, count_, steps_[0], steps_[2]}; }
  StridedMatrices matrices() {
    return {numbers_.data() + first_, rows_, columns_, count_, steps_[0], steps_[1], steps_[2]};
  }

  /// From and to matrices side by side.
  BatchMemory& operator=(const Eigen::MatrixXd& values) {
    for (Eigen::Index j = 0; j < values.cols(); ++j) {
      for (Eigen::Index i = 0; i < values.rows(); ++i) numbers_[indexOf(i, j)] = values(i, j);
    }
    return *this;
  }
  Eigen::MatrixXd values() const {
    return Eigen::MatrixXd::NullaryExpr(
        rows_, columns_ * count_,
        [this](Eigen::Index i, Eigen::Index j) { return numbers_[indexOf(i, j)]; });
  }

 private:
  Eigen::Index indexOf(Eigen::Index i, Eigen::Index j) const {
    return first_ + steps_.dot(BatchLayout::Steps(i, j % columns_, j / columns_));
  }

  Eigen::Index rows_, columns_, count_;
  BatchLayout::Steps steps_;
  Eigen::Index first_;
  Eigen::VectorXd numbers_;
};

/// A method of many states, its outputs as matrices side by side.
inline Matrices batchResult(const Method& method, const BatchLayout& layout, const ConstStates& q,
                            const ConstStates& qd, const ConstStates& qdd) {
  std::vector<BatchMemory> memories;
  for (const auto& [rows, columns] : method.shapes.matrices) {
    memories.emplace_back(layout, rows, columns, q.count);
  }
  for (const Eigen::Index rows : method.shapes.vectors) {
    memories.emplace_back(layout, rows, 1, q.count);
  }
  BatchOutputs outputs;
  for (std::size_t i = 0; i < memories.size(); ++i) {
    if (i < method.shapes.matrices.size()) {
      outputs.matrices.push_back(memories[i].matrices());
    } else {
      outputs.vectors.push_back(memories[i].states());
    }
  }
  method.batch(q, qd, qdd, outputs);
  Matrices results;
  for (const BatchMemory& memory : memories) results.push_back(memory.values());
  return results;
}

/// Every quantity of a batch, a column of numbers each.
inline std::vector<Eigen::VectorXd> batchResults(const InverseDynamicsSolver& s,
                                                 const BatchLayout& layout,
                                                 const Eigen::MatrixXd& q_values,
                                                 const Eigen::MatrixXd& qd_values,
                                                 const Eigen::MatrixXd& qdd_values) {
  BatchMemory q(layout, q_values.rows(), 1, q_values.cols()), qd(q), qdd(q);
  q = q_values;
  qd = qd_values;
  qdd = qdd_values;
  std::vector<Eigen::VectorXd> results;
  for (const Method& method : methodsOf(s)) {
    results.push_back(flat(batchResult(method, layout, q.states(), qd.states(), qdd.states())));
  }
  return results;
}

/// Matrices side by side, or vectors: those of one state.
inline Matrices ofState(const Method& method, const Matrices& results, Eigen::Index k) {
  Matrices all;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const bool is_matrix = i < method.shapes.matrices.size();
    const Eigen::Index columns = is_matrix ? method.shapes.matrices[i].second : 1;
    all.push_back(results[i].middleCols(k * columns, columns));
  }
  return all;
}

TEST_P(SolverConformance, BatchOfWrongShapeIsRefused) {
  const InverseDynamicsSolver& s = *solver_;
  const Eigen::Index n = s.jointCount(), count = n + 2;
  const Eigen::MatrixXd ok = Eigen::MatrixXd::Zero(n, count), no = ok.leftCols(n + 1);
  Eigen::MatrixXd short_out(n, n + 1), short_H(n, count * n - 1);
  errorOf<SizeMismatchException>([&] { s.getTorquesBatch(ok, no, ok); });
  errorOf<SizeMismatchException>([&] { s.getTorquesBatch(ok, ok, ok, short_out); });
  errorOf<SizeMismatchException>([&] { s.getCoriolisVectorBatch(ok, no); });
  errorOf<SizeMismatchException>([&] { s.getFrictionVectorBatch(ok, ok, short_out); });
  errorOf<SizeMismatchException>([&] { s.getFrictionVectorBatch(no, ok).size(); });
  errorOf<SizeMismatchException>([&] { s.getInertiaMatrixBatch(ok, short_H); });
  errorOf<SizeMismatchException>([&] { s.getDynamicComponentsBatch(no, ok); });
  errorOf<SizeMismatchException>([&] { s.getGravityVectorBatch(ok.transpose()); });
}

TEST_P(SolverConformance, FrictionWithoutPositionsIsTheSameOrRefused) {
  const InverseDynamicsSolver& s = *solver_;
  const Eigen::MatrixXd q = randomColumns(3);
  const Eigen::MatrixXd qd = randomColumns(3);
  const Eigen::VectorXd none;
  if (frictionDependsOnPosition(s)) {
    for (const auto& call : std::vector<std::function<void()>>{
             [&] { s.getFrictionVector(qd.col(0)); }, [&] { s.getFrictionVectorBatch(qd); },
             [&] { (void)s.getFrictionVector(none, qd.col(0)); }}) {
      EXPECT_TRUE(contains(errorOf<SizeMismatchException>(call),
                           {"argument q: missing", "getFrictionVector(q, qd)"}));
    }
    return;
  }
  const Eigen::MatrixXd batch = s.getFrictionVectorBatch(qd);
  for (Eigen::Index k = 0; k < qd.cols(); ++k) {
    const Eigen::VectorXd f = s.getFrictionVector(q.col(k), qd.col(k));
    EXPECT_TRUE(identical(s.getFrictionVector(qd.col(k)), f));
    EXPECT_TRUE(identical(s.getFrictionVector(none, qd.col(k)), f));
    EXPECT_TRUE(near(batch.col(k), f, kRounding, sizeOf(f)));
  }
}

TEST_P(SolverConformance, BatchEqualsSingleCalls) {
  const InverseDynamicsSolver& s = *solver_;
  const Eigen::Index n = s.jointCount();
  for (const int count : {0, 1, 7}) {
    const std::vector<State> states = randomStates(count);
    Eigen::MatrixXd q(n, count), qd(n, count), qdd(n, count);
    for (int k = 0; k < count; ++k) {
      q.col(k) = states[static_cast<std::size_t>(k)].q;
      qd.col(k) = states[static_cast<std::size_t>(k)].qd;
      qdd.col(k) = states[static_cast<std::size_t>(k)].qdd;
    }

    for (const Method& method : methodsOf(s)) {
      const Matrices results = batchResult(method, batchLayouts().front(), q, qd, qdd);
      for (int k = 0; k < count; ++k) {
        const State& x = states[static_cast<std::size_t>(k)];
        const Eigen::VectorXd one = flat(method.by_value(x));
        const double tolerance = method.name == "getAccelerations" ? kSolved : kRounding;
        EXPECT_TRUE(near(flat(ofState(method, results, k)), one, tolerance, sizeOf(one)))
            << method.name << toString(x);
      }
    }
  }
}

/// Rows, columns, gaps: a layout is where numbers stand, not what they are.
TEST_P(SolverConformance, BatchesOfAnyLayoutGiveTheBitsOfColumns) {
  const InverseDynamicsSolver& s = *solver_;
  for (const Eigen::Index count : {1, 11}) {
    const Eigen::MatrixXd q = randomColumns(count), qd = randomColumns(count),
                          qdd = randomColumns(count);
    const std::vector<BatchLayout> layouts = batchLayouts();
    const auto expected = batchResults(s, layouts.front(), q, qd, qdd);
    for (const BatchLayout& layout : layouts) {
      const auto results = batchResults(s, layout, q, qd, qdd);
      for (std::size_t i = 0; i < results.size(); ++i) {
        EXPECT_TRUE(identical(results[i], expected[i]))
            << layout.name << ", " << count << " states: quantity " << i;
      }
    }
  }
}

/// Of a pool of one workspace (`max_threads`) too, where a solver has a pool.
TEST_P(SolverConformance, ThreadsThatShareABatchGiveTheBitsOfOne) {
  const Eigen::Index count = 3 * 2048 + 7;  // enough for three threads, and no multiple
  const Eigen::MatrixXd q = randomColumns(count), qd = randomColumns(count),
                        qdd = randomColumns(count);
  const BatchLayout rows = batchLayouts()[1];
  const auto expected = batchResults(*solver_, rows, q, qd, qdd);
  for (const int threads : {2, 3, 4096}) {
    const auto solver = makeInitialized({{"batch_threads", threads}, {"max_threads", 1}});
    const auto results = batchResults(*solver, rows, q, qd, qdd);
    for (std::size_t i = 0; i < results.size(); ++i) {
      EXPECT_TRUE(identical(results[i], expected[i])) << threads << " threads: quantity " << i;
    }
  }
}

}  // namespace inverse_dynamics_solver::conformance

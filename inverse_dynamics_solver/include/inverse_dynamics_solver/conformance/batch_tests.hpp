// SPDX-License-Identifier: Apache-2.0
/// @file
/// Conformance, part three: many states at once, their layouts and threads. Include
/// conformance_tests.hpp, not this.
#pragma once

#include <limits>
#include <vector>

#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"

namespace inverse_dynamics_solver::conformance {

/// One number of each joint and state of a batch, or one matrix of each state, in memory of any
/// layout; NaN where nothing is written.
class BatchMemory {
 public:
  BatchMemory(Eigen::Index rows, Eigen::Index columns, Eigen::Index count, std::ptrdiff_t row_step,
              std::ptrdiff_t column_step, std::ptrdiff_t state_step)
      : rows_(rows),
        columns_(columns),
        count_(count),
        row_step_(row_step),
        column_step_(column_step),
        state_step_(state_step) {
    const Eigen::Index reach =
        rows * std::abs(row_step) + columns * std::abs(column_step) + count * std::abs(state_step);
    numbers_.resize(static_cast<std::size_t>(2 * reach + 1),
                    std::numeric_limits<double>::quiet_NaN());
    first_ = reach;
  }

  States states() { return {first(), rows_, count_, row_step_, state_step_}; }
  StridedMatrices matrices() {
    return {first(), rows_, count_, row_step_, column_step_, state_step_};
  }

  /// From and to matrices side by side, vectors being n x 1.
  BatchMemory& operator=(const Eigen::MatrixXd& values) {
    for (Eigen::Index k = 0; k < count_; ++k) {
      for (Eigen::Index j = 0; j < columns_; ++j) {
        for (Eigen::Index i = 0; i < rows_; ++i) at(i, j, k) = values(i, k * columns_ + j);
      }
    }
    return *this;
  }
  Eigen::MatrixXd values() {
    Eigen::MatrixXd result(rows_, columns_ * count_);
    for (Eigen::Index k = 0; k < count_; ++k) {
      for (Eigen::Index j = 0; j < columns_; ++j) {
        for (Eigen::Index i = 0; i < rows_; ++i) result(i, k * columns_ + j) = at(i, j, k);
      }
    }
    return result;
  }

 private:
  double* first() { return numbers_.data() + first_; }
  double& at(Eigen::Index i, Eigen::Index j, Eigen::Index k) {
    return first()[i * row_step_ + j * column_step_ + k * state_step_];
  }

  Eigen::Index rows_, columns_, count_;
  std::ptrdiff_t row_step_, column_step_, state_step_;
  std::vector<double> numbers_;
  Eigen::Index first_;
};

/// Steps from joint to joint (row to row), column to column of a matrix, state to state.
struct BatchLayout {
  const char* name;
  std::ptrdiff_t vector[2];
  std::ptrdiff_t matrix[3];
};

/// n joints, N states.
inline std::vector<BatchLayout> batchLayouts(Eigen::Index n, Eigen::Index N) {
  return {{"a state a column", {1, n}, {1, n, n * n}},
          {"a state a row, matrices in C order", {N, 1}, {n, 1, n * n}},
          {"n x (n N) row after row", {N, 1}, {n * N, 1, n}},
          {"states side by side", {N, 1}, {N, n * N, 1}},
          {"gaps", {2, 2 * n + 3}, {1, n + 2, (n + 2) * n + 1}},
          {"backwards", {-1, -n}, {-1, -n, -n * n}}};
}

/// Every quantity of a batch, a column of numbers each.
inline std::vector<Eigen::VectorXd> batchResults(const InverseDynamicsSolver& s,
                                                 const BatchLayout& layout,
                                                 const Eigen::MatrixXd& q_values,
                                                 const Eigen::MatrixXd& qd_values,
                                                 const Eigen::MatrixXd& qdd_values) {
  const Eigen::Index n = q_values.rows(), count = q_values.cols();
  const BatchMemory vectors(n, 1, count, layout.vector[0], 0, layout.vector[1]);
  const BatchMemory matrices(n, n, count, layout.matrix[0], layout.matrix[1], layout.matrix[2]);
  BatchMemory q(vectors), qd(vectors), qdd(vectors), tau(vectors), c(vectors), f(vectors),
      g(vectors), c_all(vectors), g_all(vectors), H(matrices), H_all(matrices);
  q = q_values;
  qd = qd_values;
  qdd = qdd_values;
  s.getTorquesBatch(q.states(), qd.states(), qdd.states(), tau.states());
  s.getInertiaMatrixBatch(q.states(), H.matrices());
  s.getCoriolisVectorBatch(q.states(), qd.states(), c.states());
  s.getFrictionVectorBatch(qd.states(), f.states());
  s.getGravityVectorBatch(q.states(), g.states());
  s.getDynamicComponentsBatch(q.states(), qd.states(), H_all.matrices(), c_all.states(),
                              g_all.states());
  std::vector<Eigen::VectorXd> results;
  for (BatchMemory* memory : {&tau, &H, &c, &f, &g, &H_all, &c_all, &g_all}) {
    results.push_back(flat(memory->values()));
  }
  return results;
}

TYPED_TEST_P(SolverConformance, BatchOfWrongShapeIsRefused) {
  const InverseDynamicsSolver& s = *this->solver_;
  const Eigen::Index n = s.jointCount(), count = n + 2;
  const Eigen::MatrixXd ok = Eigen::MatrixXd::Zero(n, count), no = ok.leftCols(n + 1);
  Eigen::MatrixXd short_out(n, n + 1), short_H(n, count * n - 1);
  errorOf<SizeMismatchException>([&] { s.getTorquesBatch(ok, no, ok); });
  errorOf<SizeMismatchException>([&] { s.getTorquesBatch(ok, ok, ok, short_out); });
  errorOf<SizeMismatchException>([&] { s.getCoriolisVectorBatch(ok, no); });
  errorOf<SizeMismatchException>([&] { s.getFrictionVectorBatch(ok, short_out); });
  errorOf<SizeMismatchException>([&] { s.getInertiaMatrixBatch(ok, short_H); });
  errorOf<SizeMismatchException>([&] { s.getDynamicComponentsBatch(no, ok); });
  errorOf<SizeMismatchException>([&] { s.getGravityVectorBatch(ok.transpose()); });
}

TYPED_TEST_P(SolverConformance, BatchEqualsSingleCalls) {
  const InverseDynamicsSolver& s = *this->solver_;
  const Eigen::Index n = s.jointCount();
  for (const int count : {0, 1, 7}) {
    const std::vector<State> states = this->randomStates(count);
    Eigen::MatrixXd q(n, count), qd(n, count), qdd(n, count);
    for (int k = 0; k < count; ++k) {
      q.col(k) = states[static_cast<std::size_t>(k)].q;
      qd.col(k) = states[static_cast<std::size_t>(k)].qd;
      qdd.col(k) = states[static_cast<std::size_t>(k)].qdd;
    }

    // Outputs with a stride: the lower rows of larger matrices.
    Eigen::MatrixXd tau_memory(n + 3, count), H_memory(n + 1, n * count);
    s.getTorquesBatch(q, qd, qdd, tau_memory.bottomRows(n));
    s.getInertiaMatrixBatch(q, H_memory.bottomRows(n));
    const Eigen::MatrixXd tau = tau_memory.bottomRows(n), H = H_memory.bottomRows(n);
    const Eigen::MatrixXd c = s.getCoriolisVectorBatch(q, qd), f = s.getFrictionVectorBatch(qd);
    const Eigen::MatrixXd g = s.getGravityVectorBatch(q);
    const auto [H_all, c_all, g_all] = s.getDynamicComponentsBatch(q, qd);
    EXPECT_EQ(g_all.cols(), count);
    for (int k = 0; k < count; ++k) {
      const State& x = states[static_cast<std::size_t>(k)];
      SCOPED_TRACE(toString(x));
      const Eigen::MatrixXd H_one = s.getInertiaMatrix(x.q);
      const Eigen::VectorXd c_one = s.getCoriolisVector(x.q, x.qd);
      const Eigen::VectorXd f_one = s.getFrictionVector(x.qd);
      const Eigen::VectorXd g_one = s.getGravityVector(x.q);
      const Eigen::VectorXd tau_one = s.getTorques(x.q, x.qd, x.qdd);
      EXPECT_TRUE(near(H.middleCols(k * n, n), H_one, kRounding, sizeOf(H_one)));
      EXPECT_TRUE(near(c.col(k), c_one, kRounding, sizeOf(c_one)));
      EXPECT_TRUE(near(f.col(k), f_one, kRounding, sizeOf(f_one)));
      EXPECT_TRUE(near(g.col(k), g_one, kRounding, sizeOf(g_one)));
      EXPECT_TRUE(near(tau.col(k), tau_one, kRounding, sizeOf(tau_one)));
      EXPECT_TRUE(near(H_all.middleCols(k * n, n), H_one, kRounding, sizeOf(H_one)));
      EXPECT_TRUE(near(c_all.col(k), c_one, kRounding, sizeOf(c_one)));
      EXPECT_TRUE(near(g_all.col(k), g_one, kRounding, sizeOf(g_one)));
    }
  }
}

/// Rows, columns, gaps: a layout is where numbers stand, not what they are.
TYPED_TEST_P(SolverConformance, BatchesOfAnyLayoutGiveTheBitsOfColumns) {
  const InverseDynamicsSolver& s = *this->solver_;
  const Eigen::Index n = s.jointCount();
  for (const Eigen::Index count : {1, 11}) {
    const Eigen::MatrixXd q = this->randomColumns(count), qd = this->randomColumns(count),
                          qdd = this->randomColumns(count);
    const std::vector<BatchLayout> layouts = batchLayouts(n, count);
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
TYPED_TEST_P(SolverConformance, ThreadsThatShareABatchGiveTheBitsOfOne) {
  const Eigen::Index n = this->solver_->jointCount();
  const Eigen::Index count = 3 * 2048 + 7;  // enough for three threads, and no multiple
  const Eigen::MatrixXd q = this->randomColumns(count), qd = this->randomColumns(count),
                        qdd = this->randomColumns(count);
  const BatchLayout rows = batchLayouts(n, count)[1];
  const auto expected = batchResults(*this->solver_, rows, q, qd, qdd);
  for (const int threads : {2, 3, 4096}) {
    const auto solver = this->makeInitialized({{"batch_threads", threads}, {"max_threads", 1}});
    const auto results = batchResults(*solver, rows, q, qd, qdd);
    for (std::size_t i = 0; i < results.size(); ++i) {
      EXPECT_TRUE(identical(results[i], expected[i])) << threads << " threads: quantity " << i;
    }
  }
}

}  // namespace inverse_dynamics_solver::conformance

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Conformance, part three: many states at once, their layouts and threads. Include
/// conformance_tests.hpp, not this.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "inverse_dynamics_solver/conformance/capabilities.hpp"
#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"

namespace inverse_dynamics_solver::conformance {

/// Steps from row to row, column to column of a matrix, state to state.
struct Steps {
  std::ptrdiff_t row, column, state;
};

/// Where the numbers of a batch stand: of N vectors of r numbers, of N matrices r x c.
struct BatchLayout {
  const char* name;
  Steps (*vectors)(Eigen::Index r, Eigen::Index N);
  Steps (*matrices)(Eigen::Index r, Eigen::Index c, Eigen::Index N);
};

inline std::vector<BatchLayout> batchLayouts() {
  using I = Eigen::Index;
  const auto side_by_side = [](I, I N) { return Steps{N, 0, 1}; };
  return {{"one state per column",
           [](I r, I) {
             return Steps{1, 0, r};
           },
           [](I r, I c, I) {
             return Steps{1, r, r * c};
           }},
          {"one state per row, matrices in C order", side_by_side,
           [](I r, I c, I) {
             return Steps{c, 1, r * c};
           }},
          {"r x (c N) row after row", side_by_side,
           [](I, I c, I N) {
             return Steps{c * N, 1, c};
           }},
          {"states side by side", side_by_side,
           [](I r, I, I N) {
             return Steps{N, r * N, 1};
           }},
          {"gaps",
           [](I r, I) {
             return Steps{2, 0, 2 * r + 3};
           },
           [](I r, I c, I) {
             return Steps{1, r + 2, (r + 2) * c + 1};
           }},
          {"backwards",
           [](I r, I) {
             return Steps{-1, 0, -r};
           },
           [](I r, I c, I) {
             return Steps{-1, -r, -r * c};
           }}};
}

/// Vectors or matrices of many states, in memory of any layout; NaN where nothing is written.
class BatchMemory {
 public:
  /// Vectors.
  BatchMemory(const BatchLayout& layout, Eigen::Index rows, Eigen::Index count)
      : BatchMemory(layout.vectors(rows, count), rows, 1, count) {}
  /// Matrices.
  BatchMemory(const BatchLayout& layout, Eigen::Index rows, Eigen::Index columns,
              Eigen::Index count)
      : BatchMemory(layout.matrices(rows, columns, count), rows, columns, count) {}

  States states() { return {first(), rows_, count_, steps_.row, steps_.state}; }
  StridedMatrices matrices() {
    return {first(), rows_, columns_, count_, steps_.row, steps_.column, steps_.state};
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
  BatchMemory(const Steps& steps, Eigen::Index rows, Eigen::Index columns, Eigen::Index count)
      : steps_(steps), rows_(rows), columns_(columns), count_(count) {
    first_ = rows * std::abs(steps.row) + columns * std::abs(steps.column) +
             count * std::abs(steps.state);
    numbers_.resize(static_cast<std::size_t>(2 * first_ + 1),
                    std::numeric_limits<double>::quiet_NaN());
  }
  double* first() { return numbers_.data() + first_; }
  double& at(Eigen::Index i, Eigen::Index j, Eigen::Index k) {
    return first()[i * steps_.row + j * steps_.column + k * steps_.state];
  }

  Steps steps_;
  Eigen::Index rows_, columns_, count_, first_ = 0;
  std::vector<double> numbers_;
};

/// A method of a capability, its outputs as matrices side by side.
inline Matrices batchResult(const CapabilityMethod& method, const BatchLayout& layout,
                            const ConstStates& q, const ConstStates& qd, const ConstStates& qdd) {
  std::vector<BatchMemory> memories;
  for (const auto& [rows, columns] : method.shapes.matrices) {
    memories.emplace_back(layout, rows, columns, q.count);
  }
  for (const Eigen::Index rows : method.shapes.vectors) {
    memories.emplace_back(layout, rows, q.count);
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
  for (BatchMemory& memory : memories) results.push_back(memory.values());
  return results;
}

/// Every quantity of a batch, a column of numbers each.
inline std::vector<Eigen::VectorXd> batchResults(const InverseDynamicsSolver& s,
                                                 const BatchLayout& layout,
                                                 const Eigen::MatrixXd& q_values,
                                                 const Eigen::MatrixXd& qd_values,
                                                 const Eigen::MatrixXd& qdd_values) {
  const Eigen::Index n = q_values.rows(), count = q_values.cols();
  const BatchMemory vectors(layout, n, count), matrices(layout, n, n, count);
  BatchMemory q(vectors), qd(vectors), qdd(vectors), tau(vectors), c(vectors), f(vectors),
      g(vectors), c_all(vectors), g_all(vectors), H(matrices), H_all(matrices);
  q = q_values;
  qd = qd_values;
  qdd = qdd_values;
  s.getTorquesBatch(q.states(), qd.states(), qdd.states(), tau.states());
  s.getInertiaMatrixBatch(q.states(), H.matrices());
  s.getCoriolisVectorBatch(q.states(), qd.states(), c.states());
  s.getFrictionVectorBatch(q.states(), qd.states(), f.states());
  s.getGravityVectorBatch(q.states(), g.states());
  s.getDynamicComponentsBatch(q.states(), qd.states(), H_all.matrices(), c_all.states(),
                              g_all.states());
  std::vector<Eigen::VectorXd> results;
  for (BatchMemory* memory : {&tau, &H, &c, &f, &g, &H_all, &c_all, &g_all}) {
    results.push_back(flat(memory->values()));
  }
  for (const CapabilityMethod& method : capabilityMethods(s)) {
    results.push_back(flat(batchResult(method, layout, q.states(), qd.states(), qdd.states())));
  }
  return results;
}

/// Matrices side by side, or vectors: those of one state.
inline Matrices ofState(const CapabilityMethod& method, const Matrices& results, Eigen::Index k) {
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

    // Outputs with a stride: the lower rows of larger matrices.
    Eigen::MatrixXd tau_memory(n + 3, count), H_memory(n + 1, n * count);
    s.getTorquesBatch(q, qd, qdd, tau_memory.bottomRows(n));
    s.getInertiaMatrixBatch(q, H_memory.bottomRows(n));
    const Eigen::MatrixXd tau = tau_memory.bottomRows(n), H = H_memory.bottomRows(n);
    const Eigen::MatrixXd c = s.getCoriolisVectorBatch(q, qd);
    const Eigen::MatrixXd f = s.getFrictionVectorBatch(q, qd);
    const Eigen::MatrixXd g = s.getGravityVectorBatch(q);
    const auto [H_all, c_all, g_all] = s.getDynamicComponentsBatch(q, qd);
    EXPECT_EQ(g_all.cols(), count);
    for (int k = 0; k < count; ++k) {
      const State& x = states[static_cast<std::size_t>(k)];
      SCOPED_TRACE(toString(x));
      const Eigen::MatrixXd H_one = s.getInertiaMatrix(x.q);
      const Eigen::VectorXd c_one = s.getCoriolisVector(x.q, x.qd);
      const Eigen::VectorXd f_one = s.getFrictionVector(x.q, x.qd);
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

    for (const CapabilityMethod& method : capabilityMethods(s)) {
      const Matrices results = batchResult(method, batchLayouts().front(), q, qd, qdd);
      for (int k = 0; k < count; ++k) {
        const State& x = states[static_cast<std::size_t>(k)];
        const Eigen::VectorXd one = flat(method.by_value(x));
        EXPECT_TRUE(near(flat(ofState(method, results, k)), one, kSolved, sizeOf(one)))
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

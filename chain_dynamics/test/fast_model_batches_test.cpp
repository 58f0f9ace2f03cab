// SPDX-License-Identifier: Apache-2.0

// Many states of what solvers don't offer: forward dynamics, derivatives, regressor, Gram matrices.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "allocation_guard.hpp"
#include "chain_dynamics/error.hpp"
#include "chain_dynamics/fast_model.hpp"
#include "example_models.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTolerance = 1e-12;

/// Numbers in memory of which every second belongs to something else.
using Step = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;
using Gaps = Eigen::Map<MatrixXd, 0, Step>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Random states, one a column.
struct Inputs {
  Inputs(Index n, Index count) {
    Random random(static_cast<std::uint32_t>(7 + count));
    q = 3 * random.vector(n * count).reshaped(n, count);
    qd = 2 * random.vector(n * count).reshaped(n, count);
    qdd = 5 * random.vector(n * count).reshaped(n, count);
    tau = 20 * random.vector(n * count).reshaped(n, count);
  }
  MatrixXd q, qd, qdd, tau;
};

/// What single calls give: matrices side by side, n x (n N) or n x (10 n N).
struct Results {
  Results(Index n, Index count)
      : qdd(n, count), by_q(n, n * count), by_qd(by_q), by_qdd(by_q), Y(n, 10 * n * count) {}
  MatrixXd qdd, by_q, by_qd, by_qdd, Y;
};

Results singleCalls(const FastModel& fast, const Inputs& in) {
  const Index n = in.q.rows();
  Results out(n, in.q.cols());
  for (Index k = 0; k < in.q.cols(); ++k) {
    const double* const q = in.q.col(k).data();
    const double* const qd = in.qd.col(k).data();
    const double* const qdd = in.qdd.col(k).data();
    fast.forwardDynamics(q, qd, in.tau.col(k).data(), out.qdd.col(k).data());
    fast.torqueDerivatives(q, qd, qdd, out.by_q.col(n * k).data(), out.by_qd.col(n * k).data(),
                           out.by_qdd.col(n * k).data(), n);
    fast.regressor(q, qd, qdd, out.Y.col(10 * n * k).data(), n);
  }
  return out;
}

/// State by state, as the states' accelerations differ by orders of magnitude.
void expectEqual(const Results& batch, const Results& single, Index n, Index count) {
  for (Index k = 0; k < count; ++k) {
    const auto near = [&](const MatrixXd& a, const MatrixXd& b, Index width, double extra) {
      const MatrixXd expected = b.middleCols(k * width, width);
      return agree(a.middleCols(k * width, width), expected, largest(expected) + extra, kTolerance);
    };
    const double rate = largest(single.by_qdd) * 10 + largest(single.by_qd);
    EXPECT_TRUE(near(batch.by_q, single.by_q, n, rate * 10)) << "by q, state " << k;
    EXPECT_TRUE(near(batch.by_qd, single.by_qd, n, rate)) << "by qd, state " << k;
    EXPECT_TRUE(near(batch.by_qdd, single.by_qdd, n, 0)) << "by qdd, state " << k;
    EXPECT_TRUE(near(batch.Y, single.Y, 10 * n, 0)) << "Y, state " << k;
  }
}

/// The torques of both accelerations are equal: with an H that is nearly singular those aren't.
void expectSameAccelerations(const MatrixXd& batch, const Results& single, const Inputs& in) {
  const Index n = batch.rows();
  for (Index k = 0; k < batch.cols(); ++k) {
    const MatrixXd H = single.by_qdd.middleCols(k * n, n);
    const VectorXd difference = batch.col(k) - single.qdd.col(k);
    const double terms = largest(H.cwiseAbs() * single.qdd.col(k).cwiseAbs()) +
                         largest(in.tau.col(k)) + 100 * largest(H);
    EXPECT_LE(largest(H * difference), 10 * kTolerance * terms) << "qdd, state " << k;
  }
}

/// Columns, as Eigen has them.
void batchInColumns(const FastModel& fast, const Inputs& in, Results& out) {
  fast.forwardDynamicsBatch(in.q, in.qd, in.tau, out.qdd);
  fast.torqueDerivativesBatch(in.q, in.qd, in.qdd, out.by_q, out.by_qd, out.by_qdd);
  fast.regressorBatch(in.q, in.qd, in.qdd, out.Y);
}

/// Rows, as numpy has them: states, matrices row after row.
void batchInRows(const FastModel& fast, const Inputs& in, Results& out) {
  const Index n = in.q.rows();
  const Index count = in.q.cols();
  const RowMajor q = in.q, qd = in.qd, qdd = in.qdd, tau = in.tau;
  RowMajor accelerations(n, count);
  std::vector<VectorXd> matrices(3, VectorXd::Constant(n * n * count + 1, kNan));
  VectorXd regressors = VectorXd::Constant(10 * n * n * count + 1, kNan);
  const auto as_rows = [&](VectorXd& to) {
    return StridedMatrices(to.data(), n, count, n, 1, n * n);
  };
  fast.forwardDynamicsBatch(q, qd, tau, accelerations);
  fast.torqueDerivativesBatch(q, qd, qdd, as_rows(matrices[0]), as_rows(matrices[1]),
                              as_rows(matrices[2]));
  fast.regressorBatch(q, qd, qdd, {regressors.data(), n, count, 10 * n, 1, 10 * n * n});
  out.qdd = accelerations;
  for (Index k = 0; k < count; ++k) {
    const auto matrix = [&](const VectorXd& from, Index width) {
      return Eigen::Map<const RowMajor>(from.data() + k * n * width, n, width);
    };
    out.by_q.middleCols(k * n, n) = matrix(matrices[0], n);
    out.by_qd.middleCols(k * n, n) = matrix(matrices[1], n);
    out.by_qdd.middleCols(k * n, n) = matrix(matrices[2], n);
    out.Y.middleCols(10 * k * n, 10 * n) = matrix(regressors, 10 * n);
  }
}

/// Regressors as the upper rows of higher matrices.
void batchInUpperRows(const FastModel& fast, const Inputs& in, Results& out) {
  const Index n = in.q.rows();
  batchInColumns(fast, in, out);
  MatrixXd Y = MatrixXd::Constant(n + 1, out.Y.cols(), kNan);
  fast.regressorBatch(in.q, in.qd, in.qdd,
                      {Y.data(), n, 10 * n, in.q.cols(), 1, n + 1, 10 * n * (n + 1)});
  EXPECT_TRUE(Y.row(n).array().isNaN().all()) << "written below the numbers";
  out.Y = Y.topRows(n);
}

/// Every second number, and from the last state to the first.
void batchWithGaps(const FastModel& fast, const Inputs& in, Results& out) {
  const Index n = in.q.rows();
  const Index count = in.q.cols();
  const auto spread = [&](MatrixXd& memory, const MatrixXd& values) {
    memory = MatrixXd::Constant(2 * n, std::max<Index>(1, values.cols()), kNan);
    Gaps gaps(memory.data(), n, values.cols(), Step(2 * n, 2));
    gaps = values;
    return gaps;
  };
  const auto backwards = [&](const Gaps& at) {
    return ConstStates{at.data() + (count - 1) * 2 * n, n, count, 2, -2 * n};
  };
  MatrixXd q, qd, qdd, tau, accelerations, by_q, by_qd, by_qdd, Y;
  const auto reversed = [&](const MatrixXd& values) { return values.rowwise().reverse().eval(); };
  Gaps to = spread(accelerations, in.q);
  fast.forwardDynamicsBatch(backwards(spread(q, reversed(in.q))),
                            backwards(spread(qd, reversed(in.qd))),
                            backwards(spread(tau, reversed(in.tau))), to);
  Gaps to_q = spread(by_q, out.by_q);
  Gaps to_qd = spread(by_qd, out.by_qd);
  Gaps to_qdd = spread(by_qdd, out.by_qdd);
  Gaps to_Y = spread(Y, out.Y);
  const Gaps at_qdd = spread(qdd, reversed(in.qdd));
  const ConstStates states[] = {backwards(Gaps(q.data(), n, count, Step(2 * n, 2))),
                                backwards(Gaps(qd.data(), n, count, Step(2 * n, 2))),
                                backwards(at_qdd)};
  fast.torqueDerivativesBatch(states[0], states[1], states[2], to_q, to_qd, to_qdd);
  fast.regressorBatch(states[0], states[1], states[2], to_Y);
  for (const MatrixXd* memory : {&accelerations, &by_q, &by_qd, &by_qdd, &Y}) {
    for (Index row = 1; row < 2 * n; row += 2) {
      EXPECT_TRUE(memory->row(row).array().isNaN().all()) << "written between the numbers";
    }
  }
  out.qdd = to;
  out.by_q = to_q;
  out.by_qd = to_qd;
  out.by_qdd = to_qdd;
  out.Y = to_Y;
}

class FastModelOn : public ::testing::TestWithParam<std::string> {};

TEST_P(FastModelOn, BatchesOfDynamicsEqualSingleCallsInAnyLayout) {
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    SCOPED_TRACE(name);
    const FastModel fast(model, GetParam());
    for (const Index count : {0, 1, 3, 8, 21}) {
      if (n > 30 && count > 8) continue;
      const Inputs in(n, count);
      const Results single = singleCalls(fast, in);
      for (const auto layout : {batchInColumns, batchInRows, batchInUpperRows, batchWithGaps}) {
        Results batch(n, count);
        for (MatrixXd* matrix : {&batch.qdd, &batch.by_q, &batch.by_qd, &batch.by_qdd, &batch.Y}) {
          matrix->setConstant(kNan);
        }
        layout(fast, in, batch);
        expectEqual(batch, single, n, count);
        expectSameAccelerations(batch.qdd, single, in);
        if (HasFailure()) return;
      }
    }
  }
}

// An identified H isn't symmetric.
TEST_P(FastModelOn, InertiaMatricesOfABatchMayStandRowAfterRow) {
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    const FastModel fast(model, GetParam());
    constexpr Index kStates = 11;
    const Inputs in(n, kStates);
    VectorXd rows = VectorXd::Constant(n * n * kStates, kNan);
    MatrixXd c(n, kStates), g(n, kStates), H(n, n);
    for (const bool components : {false, true}) {
      const StridedMatrices to(rows.data(), n, kStates, n, 1, n * n);
      if (components) fast.dynamicComponentsBatch(in.q, in.qd, to, c, g);
      if (!components) fast.inertiaMatrixBatch(in.q, to);
      for (Index k = 0; k < kStates; ++k) {
        fast.inertiaMatrix(in.q.col(k).data(), H.data(), n);
        const MatrixXd batch = Eigen::Map<const RowMajor>(rows.data() + k * n * n, n, n);
        ASSERT_TRUE(agree(batch, H, largest(H), kTolerance)) << name << ", state " << k;
      }
    }
  }
}

TEST_P(FastModelOn, AStateHasTheSameBitsWhereverItStandsInABatchOfDynamics) {
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    if (n > 9) continue;
    const FastModel fast(model, GetParam());
    const Inputs in(n, 19);
    Results all(n, 19);
    batchInColumns(fast, in, all);
    for (Index k = 0; k < 19; ++k) {
      Inputs one(n, 1);
      one.q = in.q.col(k);
      one.qd = in.qd.col(k);
      one.qdd = in.qdd.col(k);
      one.tau = in.tau.col(k);
      Results alone(n, 1);
      batchInColumns(fast, one, alone);
      ASSERT_EQ(alone.qdd, all.qdd.col(k)) << name;
      ASSERT_EQ(alone.by_q, all.by_q.middleCols(k * n, n)) << name;
      ASSERT_EQ(alone.Y, all.Y.middleCols(10 * k * n, 10 * n)) << name;
    }
  }
}

TEST_P(FastModelOn, AccelerationsOfABatchMayBeWrittenWhereAnInputStands) {
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    const FastModel fast(model, GetParam());
    const Inputs in(n, 19);
    MatrixXd qdd(n, 19);
    fast.forwardDynamicsBatch(in.q, in.q, in.q, qdd);
    MatrixXd in_place = in.q;
    fast.forwardDynamicsBatch(in_place, in_place, in_place, in_place);
    ASSERT_EQ(in_place, qdd) << name;
  }
}

// In its own lane and nowhere else.
TEST_P(FastModelOn, NanOfOneStateGoesToItsEntriesAndToNoOtherState) {
  const Model model(revolute(randomChain(6)));
  const FastModel fast(model, GetParam());
  Inputs in(6, 11);
  in.q(2, 4) = kNan;
  Results out(6, 11);
  batchInColumns(fast, in, out);
  for (Index k = 0; k < 11; ++k) {
    EXPECT_EQ(out.qdd.col(k).array().isNaN().all(), k == 4) << k;
    EXPECT_EQ(out.by_q.middleCols(6 * k, 6).array().isNaN().all(), k == 4) << k;
    EXPECT_EQ(!out.Y.middleCols(60 * k, 60).allFinite(), k == 4) << k;
  }
}

TEST_P(FastModelOn, NoBatchOfDynamicsAllocatesUpToSixteenJoints) {
  if (!CHAIN_DYNAMICS_COUNTS_ALLOCATIONS) {
    GTEST_SKIP() << "allocations are counted with the GNU C library, without sanitizers";
  }
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    if (n > 16) continue;
    const FastModel fast(model, GetParam());
    const Inputs in(n, 9);
    Results out(n, 9);
    const AllocationGuard guard;
    batchInColumns(fast, in, out);
    EXPECT_EQ(guard.count(), 0) << name;
  }
}

// --- Gram matrices ---

/// Sums of single calls, of rows [Y_j, own columns, tau_j].
std::vector<MatrixXd> sumsOfSingleCalls(const FastModel& fast, const Inputs& in,
                                        const std::vector<MatrixXd>& own, const MatrixXd& weights) {
  const Index n = in.q.rows();
  const auto columns = static_cast<Index>(own.size());
  const Index size = 10 * n + columns + 1;
  std::vector<MatrixXd> sums(static_cast<std::size_t>(n), MatrixXd::Zero(size, size));
  MatrixXd Y(n, 10 * n);
  for (Index k = 0; k < in.q.cols(); ++k) {
    fast.regressor(in.q.col(k).data(), in.qd.col(k).data(), in.qdd.col(k).data(), Y.data(), n);
    for (Index j = 0; j < n; ++j) {
      VectorXd row(size);
      row.head(10 * n) = Y.row(j).transpose();
      for (Index c = 0; c < columns; ++c) row[10 * n + c] = own[static_cast<std::size_t>(c)](j, k);
      row[size - 1] = in.tau(j, k);
      sums[static_cast<std::size_t>(j)] += weights(j, k) * row * row.transpose();
    }
  }
  return sums;
}

MatrixXd rowGram(const RegressorGram& gram, Index joint) {
  MatrixXd G(gram.rowSize(), gram.rowSize());
  gram.rowGram(joint, G);
  return G;
}

void expectEqual(const RegressorGram& gram, const std::vector<MatrixXd>& sums) {
  for (Index j = 0; j < gram.joints(); ++j) {
    const MatrixXd& expected = sums[static_cast<std::size_t>(j)];
    // numbers of a row are off by rounding of the row's largest
    VectorXd root = expected.diagonal().cwiseAbs().cwiseSqrt();
    root.array() += kTolerance * largest(root);
    const MatrixXd G = rowGram(gram, j);
    const MatrixXd bound = kTolerance * largest(root) *
                           (root.replicate(1, G.cols()) + root.transpose().replicate(G.rows(), 1));
    ASSERT_TRUE(((G - expected).array().abs() <= bound.array()).all()) << "joint " << j;
  }
}

std::vector<MatrixXd> ownColumns(const Inputs& in, int count) {
  const std::vector<MatrixXd> all = {in.qd, in.qd.cwiseSign(),
                                     MatrixXd::Ones(in.q.rows(), in.q.cols()), in.qdd,
                                     in.qd.array().tanh()};
  return {all.begin(), all.begin() + count};
}

TEST_P(FastModelOn, GramMatricesAreThoseOfSingleRegressors) {
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    SCOPED_TRACE(name);
    if (n > 13) continue;
    const FastModel fast(model, GetParam());
    for (const Index count : {0, 1, 7, 32, 77}) {
      const Inputs in(n, count);
      const auto columns = static_cast<int>(count % 6 % 5);
      const std::vector<MatrixXd> own = ownColumns(in, columns);
      const RowMajor q = in.q;  // in another layout
      const RowMajor tau = in.tau;
      const MatrixXd weights = in.tau.cwiseAbs();
      RegressorGram gram(n, columns);
      RegressorGram weighted(n, columns);
      GramSamples samples{q, in.qd, in.qdd, tau, {own.begin(), own.end()}};
      fast.addToGram(samples, gram);
      samples.weights = ConstStates(weights);
      fast.addToGram(samples, weighted);
      EXPECT_EQ(gram.samples(), count);
      expectEqual(gram, sumsOfSingleCalls(fast, in, own, MatrixXd::Ones(n, count)));
      expectEqual(weighted, sumsOfSingleCalls(fast, in, own, weights));
      if (HasFailure()) return;
    }
  }
}

TEST_P(FastModelOn, GramMatricesOfPartsAddUp) {
  const Model model(randomChain(5));
  const FastModel fast(model, GetParam());
  const Inputs in(5, 100);
  const auto part = [&](Index first, Index size) {
    return GramSamples{in.q.middleCols(first, size), in.qd.middleCols(first, size),
                       in.qdd.middleCols(first, size), in.tau.middleCols(first, size)};
  };
  RegressorGram whole(5), halves(5), rest(5);
  fast.addToGram(part(0, 100), whole);
  fast.addToGram(part(0, 10), halves);
  fast.addToGram(part(10, 40), halves);
  fast.addToGram(part(50, 50), rest);
  halves.add(rest);
  EXPECT_EQ(halves.samples(), 100);
  for (Index j = 0; j < 5; ++j) {
    EXPECT_TRUE(
        agree(rowGram(halves, j), rowGram(whole, j), largest(rowGram(whole, j)), kTolerance));
  }
}

INSTANTIATE_TEST_SUITE_P(Every, FastModelOn, ::testing::ValuesIn(FastModel::instructionSets()),
                         [](const auto& test) { return test.param; });

TEST(RegressorGram, ItsNormalEquationsFindParametersAndFriction) {
  const Model model(randomChain(4));
  const FastModel fast(model);
  const Inputs in(4, 400);
  MatrixXd tau(4, 400);
  fast.torquesBatch(in.q, in.qd, in.qdd, tau);
  for (Index j = 0; j < 4; ++j) {
    const double rotor = model.chain.joints()[static_cast<std::size_t>(j)].rotor_inertia;
    tau.row(j) += (3.0 + j) * in.qd.row(j) - rotor * in.qdd.row(j);
  }
  RegressorGram gram(4, 1);
  fast.addToGram({in.q, in.qd, in.qdd, tau, {in.qd}}, gram);
  MatrixXd A(gram.unknowns(), gram.unknowns());
  VectorXd b(gram.unknowns());
  const VectorXd weights = VectorXd::LinSpaced(4, 1, 2);
  gram.normalEquations(weights, A, b);
  EXPECT_TRUE(agree(A, A.transpose(), largest(A), kTolerance));
  // the least solution: parameters without influence are left at zero
  const VectorXd x = A.completeOrthogonalDecomposition().solve(b);
  for (Index j = 0; j < 4; ++j) EXPECT_NEAR(x[40 + j], 3.0 + j, 1e-5);
  EXPECT_LE(largest(A * x - b), 1e-9 * largest(b));
}

TEST(RegressorGram, RefusesOtherSizes) {
  using ::testing::AllOf;
  using ::testing::HasSubstr;
  const FastModel fast(Model(randomChain(3)));
  const Inputs in(3, 5);
  RegressorGram gram(3, 1);
  const GramSamples without{in.q, in.qd, in.qdd, in.tau};
  EXPECT_THAT(errorOf([&] { fast.addToGram(without, gram); }),
              AllOf(HasSubstr("joints x own columns"), HasSubstr("expected 3 x 0, got 3 x 1")));
  const GramSamples short_column{in.q, in.qd, in.qdd, in.tau, {in.qd.leftCols(4)}};
  EXPECT_THAT(errorOf([&] { fast.addToGram(short_column, gram); }),
              HasSubstr("own column: expected 3 x 5, got 3 x 4"));
  const GramSamples short_torques{in.q, in.qd, in.qdd, in.tau.leftCols(2), {in.qd}};
  EXPECT_THAT(errorOf([&] { fast.addToGram(short_torques, gram); }),
              HasSubstr("tau: expected 3 x 5, got 3 x 2"));
  EXPECT_EQ(gram.samples(), 0);
  EXPECT_THAT(errorOf([&] { gram.add(RegressorGram(3, 2)); }), HasSubstr("got 3 x 2"));
  EXPECT_THAT(errorOf([&] { rowGram(gram, 3); }), HasSubstr("joint: expected 0 to 2, got 3"));
  MatrixXd A(3, 3);
  VectorXd b(3);
  EXPECT_THAT(errorOf([&] { gram.normalEquations(b, A, b); }),
              HasSubstr("A: expected 33 x 33, got 3 x 3"));
  EXPECT_THAT(errorOf([] { RegressorGram none(0); }), HasSubstr("joints: expected 1 to 64, got 0"));
  EXPECT_THAT(errorOf([] { RegressorGram negative(2, -1); }), HasSubstr("expected 0 or more"));
}

}  // namespace
}  // namespace chain_dynamics

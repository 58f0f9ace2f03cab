// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/regressor_gram.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/mechanism.hpp"
#include "chain_dynamics/robot_description.hpp"
#include "example_models.hpp"
#include "urdf_texts.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kTolerance = 1e-12;

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

/// Sums of single calls, of rows [Y_j, own columns, tau_j].
std::vector<MatrixXd> sumsOfSingleCalls(const FastModel& fast, const Inputs& in,
                                        const std::vector<MatrixXd>& own, const MatrixXd& weights) {
  const Index n = in.q.rows();
  const auto columns = static_cast<Index>(own.size());
  const Index rigid = 10 * fast.linkCount(), size = rigid + columns + 1;
  std::vector<MatrixXd> sums(static_cast<std::size_t>(n), MatrixXd::Zero(size, size));
  MatrixXd Y(n, rigid);
  for (Index k = 0; k < in.q.cols(); ++k) {
    fast.regressor(in.q.col(k).data(), in.qd.col(k).data(), in.qdd.col(k).data(), Y.data(), n);
    for (Index j = 0; j < n; ++j) {
      VectorXd row(size);
      row.head(rigid) = Y.row(j).transpose();
      for (Index c = 0; c < columns; ++c) row[rigid + c] = own[static_cast<std::size_t>(c)](j, k);
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

/// A waist with two arms, whose links and coordinates stand in the order of no branch; one arm follows,
/// and has a joint of its own.
Model tree() {
  const std::string places = "<origin xyz='0.1 0.2 0.3' rpy='1 0.5 -0.3'/><axis xyz='0.6 0 0.8'/>";
  const std::string follows = "<mimic joint='right_arm' multiplier='-0.7' offset='0.4'/>";
  return Model(mechanismFromRobot(
      robotFromUrdf(
          robot(link("base") + link("chest") + link("left") + link("right") + link("hand") +
                joint("right_arm", "revolute", "chest", "right", places + kLimit) +
                joint("wrist", "prismatic", "left", "hand", places + kLimit) +
                joint("waist", "revolute", "base", "chest", places + kLimit) +
                joint("left_arm", "revolute", "chest", "left", places + follows + kLimit))),
      {}, {"*"}));
}

class RegressorGramOn : public ::testing::TestWithParam<std::string> {};

TEST_P(RegressorGramOn, IsThatOfSingleRegressors) {
  std::vector<NamedModel> all = models();
  all.push_back({"tree", tree()});
  for (const auto& [name, model] : all) {
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
      RegressorGram gram = fast.emptyGram(columns);
      RegressorGram weighted = fast.emptyGram(columns);
      GramSamples samples{q, in.qd, in.qdd, tau, {own.begin(), own.end()}};
      fast.addToGram(samples, gram);
      samples.weights = ConstStates(weights);
      fast.addToGram(samples, weighted);
      EXPECT_EQ(gram.samples(), count);
      expectEqual(gram, sumsOfSingleCalls(fast, in, own, MatrixXd::Ones(n, count)));
      expectEqual(weighted, sumsOfSingleCalls(fast, in, own, weights));
      RegressorRows kept;
      RegressorGram links = fast.emptyGram();
      fast.addToGram({q, in.qd, in.qdd, tau, {}, samples.weights, true, &kept}, links);
      samples.links = false;
      for (const RegressorRows* rows : {&kept, static_cast<RegressorRows*>(nullptr)}) {
        RegressorGram apart = fast.emptyGram(columns);
        samples.rows = rows;
        fast.addToGram(samples, apart);
        apart.addLinks(links);
        expectEqual(apart, sumsOfSingleCalls(fast, in, own, weights));
      }
      if (HasFailure()) return;
    }
  }
}

TEST_P(RegressorGramOn, PartsAddUp) {
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

INSTANTIATE_TEST_SUITE_P(Every, RegressorGramOn, ::testing::ValuesIn(FastModel::instructionSets()),
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

// Unknowns x of shared columns are those of all columns by a matrix P of zeros and ones: P' A P.
TEST(RegressorGram, SharesUnknownsOfColumns) {
  const FastModel fast(Model(randomChain(3)));
  const Inputs in(3, 20);
  RegressorGram apart(3, 2), shared(3, 2);
  shared.share({{0, 2}, {0, -1}, {1, 2}});
  EXPECT_EQ(shared.unknowns(), 33);
  for (RegressorGram* const gram : {&apart, &shared}) {
    fast.addToGram({in.q, in.qd, in.qdd, in.tau, {in.qd, in.qdd}}, *gram);
  }
  MatrixXd P = MatrixXd::Zero(36, 33);
  P.topLeftCorner(30, 30).setIdentity();
  for (Index j = 0; j < 3; ++j) {
    for (Index c = 0; c < 2; ++c) {
      if (shared.unknownOf(j, c) >= 0)
        P(30 + apart.unknownOf(j, c), 30 + shared.unknownOf(j, c)) = 1;
    }
  }
  MatrixXd A(36, 36), A_shared(33, 33);
  VectorXd b(36), b_shared(33);
  const VectorXd weights = VectorXd::LinSpaced(3, 1, 2);
  apart.normalEquations(weights, A, b);
  shared.normalEquations(weights, A_shared, b_shared);
  EXPECT_TRUE(agree(A_shared, P.transpose() * A * P, largest(A), kTolerance));
  EXPECT_TRUE(agree(b_shared, P.transpose() * b, largest(b), kTolerance));
  using ::testing::HasSubstr;
  EXPECT_THAT(errorOf([&] { shared.add(apart); }), HasSubstr("add sums of the same columns"));
  EXPECT_THAT(errorOf([&] {
                shared.share({{0, 2}, {0, 2}, {0, 2}});
              }),
              HasSubstr("each from 0 on at least once"));
  EXPECT_THAT(errorOf([&] { shared.share({{0, 1}}); }), HasSubstr("joints with unknowns"));
}

TEST(RegressorGram, OfATreeHasTheUnknownsOfAllLinks) {
  const FastModel fast(tree());
  const RegressorGram gram = fast.emptyGram(2);
  EXPECT_EQ(gram.joints(), 3);
  EXPECT_EQ(gram.links(), 4);
  EXPECT_EQ(gram.unknowns(), 4 * 10 + 3 * 2);
  // coordinates: right_arm, which the left one follows, wrist, waist
  EXPECT_EQ(gram.firstLink(0), 0);
  EXPECT_EQ(gram.firstLink(1), 1);
}

TEST(RegressorGram, RefusesSumsOfAnotherRobot) {
  using ::testing::HasSubstr;
  const FastModel fast(tree());
  const Inputs in(3, 5);
  RegressorGram of_chain(3);
  EXPECT_THAT(errorOf([&] {
                fast.addToGram({in.q, in.qd, in.qdd, in.tau}, of_chain);
              }),
              HasSubstr("make it by emptyGram()"));
  RegressorGram of_tree = fast.emptyGram();
  const FastModel chain(Model(randomChain(3)));
  EXPECT_THAT(errorOf([&] {
                chain.addToGram({in.q, in.qd, in.qdd, in.tau}, of_tree);
              }),
              HasSubstr("make it by emptyGram()"));
  EXPECT_THAT(errorOf([&] { of_chain.add(of_tree); }), HasSubstr("add sums of one robot"));
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

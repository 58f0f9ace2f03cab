// SPDX-License-Identifier: Apache-2.0
/// What a batch takes, and who computes it.
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "inverse_dynamics_solver/conformance/allocation_guard.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"

namespace inverse_dynamics_solver::batches_test {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// g = 100 q, c = q qd, H(i, j) = q_i + 10 j; notes which threads compute gravity, and lets each of
/// them wait until `expected` have come.
class MadeUp : public InverseDynamicsSolver {
 public:
  mutable std::mutex mutex;
  mutable std::condition_variable came;
  mutable std::set<std::thread::id> seen;
  mutable std::size_t expected = 1;

 protected:
  JointInfo configure(const Configuration& configuration) override {
    JointInfo info;
    const auto n = configuration.get<std::int64_t>("joints").value_or(3);
    for (std::int64_t i = 0; i < n; ++i) info.joint_names.push_back("joint" + std::to_string(i));
    return info;
  }
  void computeInertiaMatrix(const ConstVectorRef& q, MatrixRef H) const override {
    for (Eigen::Index j = 0; j < q.size(); ++j) H.col(j) = q.array() + 10.0 * double(j);
  }
  void computeCoriolisVector(const ConstVectorRef& q, const ConstVectorRef& qd,
                             VectorRef c) const override {
    c = q.cwiseProduct(qd);
  }
  void computeGravityVector(const ConstVectorRef& q, VectorRef g) const override { g = 100.0 * q; }
  void computeGravityVectorBatch(const ConstStates& q, const States& g) const override {
    {
      std::unique_lock<std::mutex> lock(mutex);
      seen.insert(std::this_thread::get_id());
      came.notify_all();
      const auto all_came = [this] { return seen.size() >= expected; };
      // who waited in vain lets the others go
      if (!came.wait_for(lock, std::chrono::seconds(20), all_came)) expected = 0;
    }
    for (Eigen::Index k = 0; k < q.count; ++k) {
      if (q(0, k) < 0) throw std::domain_error("state " + std::to_string(q(0, k)));
    }
    InverseDynamicsSolver::computeGravityVectorBatch(q, g);
  }
  bool inertiaIsPhysicalImpl() const override { return false; }
};

std::unique_ptr<MadeUp> initialized(int joints, int batch_threads = 1) {
  auto solver = std::make_unique<MadeUp>();
  solver->initialize({{"joints", joints}, {"batch_threads", batch_threads}});
  return solver;
}

/// States whose sums and products have no rounding: the same bits in whatever order Eigen adds.
Eigen::MatrixXd wholeNumbers(Eigen::Index joints, Eigen::Index states) {
  return (100.0 * Eigen::MatrixXd::Random(joints, states)).array().round();
}

TEST(Batches, TakeEveryKindOfMatrix) {
  const auto solver = initialized(3);
  const Eigen::Matrix3Xd q = wholeNumbers(3, 4);
  const Eigen::MatrixXd expected = solver->getTorquesBatch(q, q, q);
  EXPECT_EQ(expected.cols(), 4);
  EXPECT_EQ(expected.col(2), solver->getTorques(q.col(2), q.col(2), q.col(2)));

  // Row after row, one state per row, with gaps, mapped, expressions, one state.
  const Rows q_rows = q;
  const Eigen::MatrixXd turned = q.transpose();
  Eigen::MatrixXd larger = Eigen::MatrixXd::Zero(5, 8);
  larger.block(1, 2, 3, 4) = q;
  const Eigen::MatrixXd& constant = larger;
  const std::vector<double> standard(q.data(), q.data() + 12);
  EXPECT_EQ(solver->getTorquesBatch(q_rows, turned.transpose(), 1 * q), expected);
  EXPECT_EQ(
      solver->getTorquesBatch(larger.block(1, 2, 3, 4), constant.block<3, 4>(1, 2), q.array()),
      expected);
  EXPECT_EQ(
      solver->getTorquesBatch(Eigen::Map<const Eigen::MatrixXd>(standard.data(), 3, 4),
                              Eigen::Ref<const Eigen::MatrixXd>(q), turned.eval().transpose()),
      expected);
  EXPECT_EQ(
      solver->getTorquesBatch(q.leftCols(2), q.leftCols(2), q.leftCols(2) + 0 * q.leftCols(2)),
      expected.leftCols(2));
  EXPECT_EQ(solver->getTorquesBatch(q.col(1), q.col(1), q.col(1)), expected.col(1));
  const auto every_second = q(Eigen::seqN(0, 3), Eigen::seqN(0, 2, Eigen::fix<2>));
  EXPECT_EQ(solver->getTorquesBatch(every_second, every_second, every_second).col(1),
            expected.col(2));

  // Results.
  Eigen::Matrix3Xd tau(3, 4);
  Rows tau_rows(3, 4);
  Eigen::MatrixXd tau_turned(4, 3), block = Eigen::MatrixXd::Zero(5, 8);
  const Eigen::Map<Eigen::MatrixXd> map(tau.data(), 3, 4);
  solver->getTorquesBatch(q, q, q, map);
  EXPECT_EQ(tau, expected);
  solver->getTorquesBatch(q, q, q, tau_rows);
  EXPECT_EQ(tau_rows, expected);
  solver->getTorquesBatch(q, q, q, tau_turned.transpose());
  EXPECT_EQ(tau_turned.transpose(), expected);
  solver->getTorquesBatch(q, q, q, block.block(2, 1, 3, 4));
  EXPECT_EQ(block.block(2, 1, 3, 4), expected);
  EXPECT_EQ(block.sum(), expected.sum());
}

TEST(Batches, GiveInertiaMatricesSideBySideOrInAnyOtherOrder) {
  const auto solver = initialized(3);
  const Eigen::MatrixXd q = Eigen::MatrixXd::Random(3, 4);
  const Eigen::MatrixXd H = solver->getInertiaMatrixBatch(q);
  ASSERT_EQ(H.cols(), 12);
  EXPECT_EQ(H.middleCols(3, 3), solver->getInertiaMatrix(q.col(1)));
  EXPECT_NE(H(1, 0), H(0, 1));

  Rows rows(3, 12);
  solver->getInertiaMatrixBatch(q, rows);
  EXPECT_EQ(rows, H);

  // N x n x n in C order, as numpy has it: (k, i, j) at 9 k + 3 i + j.
  std::vector<double> array(36);
  solver->getInertiaMatrixBatch(q, StridedMatrices{array.data(), 3, 4, 3, 1, 9});
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(Eigen::Map<Rows>(array.data() + 9 * k, 3, 3), H.middleCols(3 * k, 3));
  }
}

// What would be written into a copy, or can't be, doesn't compile.
static_assert(std::is_constructible_v<States, Eigen::MatrixXd&>);
static_assert(std::is_constructible_v<States, Eigen::Block<Eigen::MatrixXd>>);
static_assert(!std::is_constructible_v<States, const Eigen::MatrixXd&>);
static_assert(!std::is_constructible_v<States, Eigen::MatrixXd>);
static_assert(!std::is_constructible_v<States, Eigen::MatrixXf&>);
static_assert(!std::is_constructible_v<States, Eigen::Map<const Eigen::MatrixXd>>);
static_assert(!std::is_constructible_v<StridedMatrices, const Eigen::MatrixXd&>);
static_assert(!std::is_constructible_v<ConstStates, Eigen::MatrixXf&>);

TEST(Batches, AreNotCopied) {
  if (!conformance::kAllocationGuardWorks) GTEST_SKIP() << "allocations can't be counted";
  const auto solver = initialized(64);
  const Rows q = Rows::Random(64, 10);
  const Eigen::MatrixXd qd = Eigen::MatrixXd::Random(10, 64);
  Rows tau(64, 10), H(64, 640);
  conformance::AllocationGuard guard;
  solver->getTorquesBatch(q, qd.transpose(), qd.transpose(), tau);
  solver->getInertiaMatrixBatch(q, H);
  EXPECT_EQ(guard.count(), 0);
}

// More joints than fit on the stack.
TEST(Batches, OfLongChainsMayHaveAnyLayout) {
  const auto solver = initialized(65);
  const Eigen::MatrixXd q = wholeNumbers(65, 3);
  Rows tau(65, 3), H(65, 195);
  solver->getTorquesBatch(Rows(q), q, Rows(q), tau);
  EXPECT_EQ(tau, solver->getTorquesBatch(q, q, q));
  solver->getInertiaMatrixBatch(Rows(q), H);
  EXPECT_EQ(H, solver->getInertiaMatrixBatch(q));
}

void expectThreads(MadeUp& solver, Eigen::Index states, std::size_t expected) {
  solver.seen.clear();
  solver.expected = expected;
  const Eigen::MatrixXd q = Eigen::MatrixXd::Random(3, states).cwiseAbs();
  EXPECT_EQ(solver.getGravityVectorBatch(q), 100.0 * q) << states;
  EXPECT_EQ(solver.seen.size(), expected) << states;
  EXPECT_EQ(solver.seen.count(std::this_thread::get_id()), 1U) << states;
}

TEST(Batches, AreSharedAmongThreadsOnlyWhenAskedAndWorthIt) {
  const auto alone = initialized(3);
  expectThreads(*alone, 100000, 1);

  const auto shared = initialized(3, 3);
  expectThreads(*shared, 0, 1);
  expectThreads(*shared, 2 * 2048 - 1, 1);
  expectThreads(*shared, 2 * 2048, 2);
  expectThreads(*shared, 100000, 3);
}

TEST(Batches, PassExceptionsOfThreadsOn) {
  const auto solver = initialized(3, 3);
  for (const Eigen::Index bad : {0, 9999, 19999}) {
    Eigen::MatrixXd q = Eigen::MatrixXd::Random(3, 20000).cwiseAbs();
    q(0, bad) = -1;
    EXPECT_THROW(solver->getGravityVectorBatch(q), std::domain_error) << bad;
  }
}

}  // namespace inverse_dynamics_solver::batches_test

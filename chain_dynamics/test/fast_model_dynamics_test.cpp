// SPDX-License-Identifier: Apache-2.0

// What FastModel computes beyond torques and their parts: derivatives, regressor, accelerations.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <string>

#include "allocation_guard.hpp"
#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/forward_dynamics.hpp"
#include "chain_dynamics/inertia_matrix.hpp"
#include "chain_dynamics/regressor.hpp"
#include "example_models.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// In matrices with a row too many, to see that nothing is written between the columns.
struct Results {
  explicit Results(Index joints) : n(joints) {
    for (MatrixXd* matrix : {&by_q, &by_qd, &by_qdd}) *matrix = MatrixXd::Constant(n + 1, n, 77);
    Y = MatrixXd::Constant(n + 1, 10 * n, 77);
    qdd = VectorXd::Constant(n, kNan);
  }
  Index n;
  MatrixXd by_q, by_qd, by_qdd, Y;
  VectorXd qdd;
};

void compute(const FastModel& fast, const State<double>& x, const VectorXd& tau, Results& out) {
  const double* q = x.q.data();
  const double* qd = x.qd.data();
  fast.torqueDerivatives(q, qd, x.qdd.data(), out.by_q.data(), out.by_qd.data(), out.by_qdd.data(),
                         out.n + 1);
  fast.regressor(q, qd, x.qdd.data(), out.Y.data(), out.n + 1);
  fast.forwardDynamics(q, qd, tau.data(), out.qdd.data());
}

Results resultsOf(const FastModel& fast, const State<double>& x, const VectorXd& tau) {
  Results out(x.q.size());
  compute(fast, x, tau, out);
  for (const MatrixXd* matrix : {&out.by_q, &out.by_qd, &out.by_qdd, &out.Y}) {
    EXPECT_TRUE((matrix->row(out.n).array() == 77).all()) << "written between columns";
  }
  return out;
}

void expectDerivatives(const Results& fast, const Model& model, const State<double>& x) {
  const Index n = x.q.size();
  MatrixXd by_q(n, n), by_qd(n, n), by_qdd(n, n);
  torqueDerivatives(model, x.q, x.qd, x.qdd, by_q, by_qd, by_qdd);
  addFrictionDerivatives(model, x.q, x.qd, by_q, by_qd);
  const double tolerance = 4 * rounding(model.chain);
  const double speed = std::max(1.0, largest(x.qd));
  const double rate = largest(by_qdd) * speed + largest(by_qd);
  EXPECT_TRUE(agree(fast.by_q.topRows(n), by_q, largest(by_q) + rate * speed, tolerance)) << "by q";
  EXPECT_TRUE(agree(fast.by_qd.topRows(n), by_qd, rate, tolerance)) << "by qd";
  EXPECT_TRUE(agree(fast.by_qdd.topRows(n), by_qdd, largest(by_qdd), tolerance)) << "by qdd";
}

void expectRegressor(const Results& fast, const Chain& chain, const State<double>& x) {
  const Index n = chain.jointCount();
  MatrixXd Y(n, 10 * n);
  regressor(chain, x.q, x.qd, x.qdd, Y);
  EXPECT_TRUE(agree(fast.Y.topRows(n), Y, largest(Y), 4 * rounding(chain))) << "regressor";
}

/// The torques of the accelerations found are those asked for.
void expectSolves(const Results& fast, const Model& model, const State<double>& x,
                  const VectorXd& tau) {
  const Index n = x.q.size();
  MatrixXd H(n, n);
  VectorXd c(n), g(n), f(n);
  dynamicComponents(model, x.q, x.qd, H, c, g);
  frictionVector(model, x.q, x.qd, f);
  const double terms = largest(H.cwiseAbs() * fast.qdd.cwiseAbs() + c.cwiseAbs() + g.cwiseAbs());
  const double tolerance = 4 * rounding(model.chain);
  EXPECT_TRUE(agree(H * fast.qdd + c + g + f, tau, terms + largest(tau), tolerance)) << "solution";
}

class FastModelOn : public ::testing::TestWithParam<std::string> {};

TEST_P(FastModelOn, GivesDerivativesRegressorAndAccelerationsOfThePlainFunctions) {
  for (const auto& [name, model] : models()) {
    const FastModel fast(model, GetParam());
    for (std::uint32_t seed = 0; seed < 3; ++seed) {
      const State<double> x = randomState(model.chain, seed);
      SCOPED_TRACE(name + "\n" + paste(model.chain, x));
      const VectorXd tau = 10 * x.qdd;
      const Results results = resultsOf(fast, x, tau);
      expectDerivatives(results, model, x);
      expectRegressor(results, model.chain, x);
      expectSolves(results, model, x, tau);
      if (HasFailure()) return;
    }
  }
}

TEST_P(FastModelOn, LargeAnglesInOneJointLeaveTheOthersRight) {
  const Model model(revolute(randomChain(7)));
  const FastModel fast(model, GetParam());
  for (const double angle : {1e4, 1e7, -3e12}) {
    State<double> x = randomState(model.chain, 2);
    x.q[3] = angle;
    const Results results = resultsOf(fast, x, x.qdd);
    expectDerivatives(results, model, x);
    expectRegressor(results, model.chain, x);
    expectSolves(results, model, x, x.qdd);
  }
}

// As no axis of this arm meets or parallels another, everything beyond what a first joint turns
// about depends on each position.
TEST_P(FastModelOn, NanGoesToEveryEntryThatDependsOnIt) {
  const Model model(revolute(randomChain(6)));
  const FastModel fast(model, GetParam());
  for (Index j = 1; j < 6; ++j) {
    State<double> x = randomState(model.chain, 1);
    x.q[j] = kNan;
    const Results results = resultsOf(fast, x, x.qdd);
    EXPECT_TRUE(results.by_q.topRows(6).array().isNaN().all()) << j << "\n" << results.by_q;
    EXPECT_TRUE(results.by_qdd.topLeftCorner(j, j).array().isNaN().all()) << results.by_qdd;
    EXPECT_TRUE(results.qdd.array().isNaN().all()) << results.qdd.transpose();
    EXPECT_TRUE(results.Y.row(0).middleCols(51, 3).array().isNaN().all()) << results.Y;
  }
  State<double> x = randomState(model.chain, 1);
  x.qd[0] = kNan;
  const Results results = resultsOf(fast, x, x.qdd);
  EXPECT_TRUE(results.by_q.topRightCorner(6, 5).array().isNaN().all()) << results.by_q;
  EXPECT_TRUE(results.qdd.array().isNaN().all()) << results.qdd.transpose();
  EXPECT_TRUE(results.by_qdd.topRows(6).allFinite());
}

TEST_P(FastModelOn, SlopesOfFrictionAreFiniteForAnyVelocityAndNanForNan) {
  const Model model = identified(randomChain(3), false, false, 5);
  const FastModel fast(model, GetParam());
  State<double> x = randomState(model.chain, 1);
  for (const double qd : {1e3, -1e5, 0.0}) {
    x.qd.setConstant(qd);
    EXPECT_TRUE(resultsOf(fast, x, x.qdd).by_qd.allFinite()) << qd;
  }
  x.qd[2] = kNan;
  EXPECT_TRUE(std::isnan(resultsOf(fast, x, x.qdd).by_qd(2, 2)));
}

TEST_P(FastModelOn, AJointThatMovesNothingHasNoFiniteAcceleration) {
  const Chain chain("nothing", {randomChain(1).joints()[0]}, {LinkParameters::zero()}, {0, 0, -9});
  const FastModel fast(Model(chain), GetParam());
  const State<double> x = randomState(chain, 1);
  EXPECT_FALSE(std::isfinite(resultsOf(fast, x, VectorXd::Ones(1)).qdd[0]));
}

TEST_P(FastModelOn, NoCallAllocates) {
  if (!CHAIN_DYNAMICS_COUNTS_ALLOCATIONS) {
    GTEST_SKIP() << "allocations are counted with the GNU C library, without sanitizers";
  }
  for (const auto& [name, model] : models()) {
    const FastModel fast(model, GetParam());
    const State<double> x = randomState(model.chain, 1);
    Results results(x.q.size());
    const AllocationGuard guard;
    compute(fast, x, x.qdd, results);
    EXPECT_EQ(guard.count(), 0) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Every, FastModelOn, ::testing::ValuesIn(FastModel::instructionSets()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace chain_dynamics

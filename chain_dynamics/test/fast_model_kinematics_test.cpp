// SPDX-License-Identifier: Apache-2.0

// The tip's pose and Jacobian and the Coriolis matrix by FastModel, of one state and of many.

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>

#include "allocation_guard.hpp"
#include "chain_dynamics/coriolis_matrix.hpp"
#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/tip_kinematics.hpp"
#include "example_models.hpp"

namespace chain_dynamics {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kNotWritten = 77;

/// All quantities of one state.
struct Results {
  explicit Results(Index n) : C(n, n), J(6, n), dJ(6, n) {}
  Matrix3<double> R;
  Eigen::Vector3d p;
  MatrixXd C, J, dJ;
};

/// A tip that lies and points anywhere, and a root as well.
Model withEnds(const Model& model) {
  Random random(5);
  const Chain& chain = model.chain;
  std::vector<Joint> joints = chain.joints();
  joints[0].placement = Transform<double>{random.rotation(), random.vector3()};
  Model result = model;
  result.chain = Chain(chain.name(), joints, chain.links(), chain.gravity(),
                       {random.rotation(), 0.3 * random.vector3()});
  return result;
}

Results plain(const Model& model, const State<double>& x) {
  Results out(x.q.size());
  const Transform<double> tip = tipPose(model.chain, x.q);
  out.R = tip.R;
  out.p = tip.p;
  tipJacobian(model.chain, x.q, out.J);
  tipJacobianDerivative(model.chain, x.q, x.qd, out.dJ);
  coriolisMatrix(model, x.q, x.qd, out.C);
  return out;
}

/// By matrices with a row too many, to see that nothing is written between the columns.
Results single(const FastModel& fast, const VectorXd& q, const VectorXd& qd) {
  const Index n = q.size();
  MatrixXd C = MatrixXd::Constant(n + 1, n, kNotWritten);
  MatrixXd J = MatrixXd::Constant(7, n, kNotWritten);
  MatrixXd dJ = J;
  Results out(n);
  fast.coriolisMatrix(q.data(), qd.data(), C.data(), n + 1);
  fast.tipPose(q.data(), out.R.data(), out.p.data());
  fast.tipJacobian(q.data(), J.data(), 7);
  fast.tipJacobianDerivative(q.data(), qd.data(), dJ.data(), 7);
  EXPECT_TRUE((C.row(n).array() == kNotWritten).all());
  EXPECT_TRUE((J.row(6).array() == kNotWritten).all() && (dJ.row(6).array() == kNotWritten).all());
  out.C = C.topRows(n);
  out.J = J.topRows(6);
  out.dJ = dJ.topRows(6);
  return out;
}

/// What lengths are added up from.
double reach(const Chain& chain, const VectorXd& q) {
  double length = 1 + chain.tip().p.norm() + q.cwiseAbs().sum();
  for (const Joint& joint : chain.joints()) length += joint.placement.p.norm();
  return length;
}

void expectEqual(const Results& a, const Results& b, const Model& model, const State<double>& x,
                 double tolerance) {
  const double length = reach(model.chain, x.q);
  const double speed = std::max(1.0, x.qd.cwiseAbs().sum());
  MatrixXd H(x.q.size(), x.q.size());
  inertiaMatrix(model, x.q, H);
  EXPECT_TRUE(agree(a.R, b.R, 1, tolerance)) << "R";
  EXPECT_TRUE(agree(a.p, b.p, length, tolerance)) << "p";
  EXPECT_TRUE(agree(a.J, b.J, length, tolerance)) << "J";
  EXPECT_TRUE(agree(a.dJ, b.dJ, length * speed, tolerance)) << "dJ";
  EXPECT_TRUE(agree(a.C, b.C, largest(b.C) + largest(H) * speed, tolerance)) << "C";
}

class FastModelOn : public ::testing::TestWithParam<std::string> {};

TEST_P(FastModelOn, GivesKinematicsAndCoriolisMatrixOfThePlainFunctions) {
  for (const auto& [name, like] : models()) {
    const Model model = withEnds(like);
    const FastModel fast(model, GetParam());
    for (std::uint32_t seed = 0; seed < 3; ++seed) {
      const State<double> x = randomState(model.chain, seed);
      SCOPED_TRACE(name + "\n" + paste(model.chain, x));
      expectEqual(single(fast, x.q, x.qd), plain(model, x), model, x, 4 * rounding(model.chain));
      if (HasFailure()) return;
    }
  }
}

/// Many states, and their results in some layout.
struct Batch {
  Batch(Index n, Index count) {
    Random random(static_cast<std::uint32_t>(7 + count));
    q = 3 * random.vector(n * count).reshaped(n, count);
    qd = 2 * random.vector(n * count).reshaped(n, count);
    C = MatrixXd::Constant(n, n * count, kNan);
    R = MatrixXd::Constant(3, 3 * count, kNan);
    p = MatrixXd::Constant(3, count, kNan);
    dJ = J = MatrixXd::Constant(6, n * count, kNan);
  }
  Index count() const { return q.cols(); }
  Index n() const { return q.rows(); }
  MatrixXd q, qd, C, R, p, J, dJ;
};

/// Columns, as Eigen has them.
void inColumns(const FastModel& fast, Batch& b) {
  fast.coriolisMatrixBatch(b.q, b.qd, b.C);
  fast.tipPoseBatch(b.q, b.R, b.p);
  fast.tipJacobianBatch(b.q, b.J);
  fast.tipJacobianDerivativeBatch(b.q, b.qd, b.dJ);
}

/// Rows, as numpy has them: states, matrices row after row.
void inRows(const FastModel& fast, Batch& b) {
  const Index n = b.n();
  const Index count = b.count();
  const RowMajor q = b.q, qd = b.qd;
  VectorXd C(n * n * count + 1), R(9 * count + 1), J(6 * n * count + 1), dJ(J);
  RowMajor p(3, count);
  fast.coriolisMatrixBatch(q, qd, StridedMatrices(C.data(), n, count, n, 1, n * n));
  fast.tipPoseBatch(q, StridedMatrices(R.data(), 3, count, 3, 1, 9), p);
  fast.tipJacobianBatch(q, StridedMatrices(J.data(), 6, n, count, n, 1, 6 * n));
  fast.tipJacobianDerivativeBatch(q, qd, StridedMatrices(dJ.data(), 6, n, count, n, 1, 6 * n));
  b.p = p;
  for (Index k = 0; k < count; ++k) {
    const auto matrix = [&](const VectorXd& from, Index rows, Index columns) {
      return Eigen::Map<const RowMajor>(from.data() + k * rows * columns, rows, columns);
    };
    b.C.middleCols(k * n, n) = matrix(C, n, n);
    b.R.middleCols(k * 3, 3) = matrix(R, 3, 3);
    b.J.middleCols(k * n, n) = matrix(J, 6, n);
    b.dJ.middleCols(k * n, n) = matrix(dJ, 6, n);
  }
}

/// A matrix of which every second row is another's; columns of matrices that are taller.
void withGaps(const FastModel& fast, Batch& b) {
  const Index n = b.n();
  using Gaps = Eigen::Map<MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, 2>>;
  const auto spread = [](MatrixXd& memory, Index rows, Index columns) {
    memory = MatrixXd::Constant(2 * rows, std::max<Index>(1, columns), kNan);
    return Gaps(memory.data(), rows, columns, Eigen::Stride<Eigen::Dynamic, 2>(2 * rows, 2));
  };
  MatrixXd memory[6];
  Gaps C = spread(memory[0], n, b.C.cols());
  Gaps R = spread(memory[1], 3, b.R.cols());
  Gaps p = spread(memory[2], 3, b.p.cols());
  Gaps J = spread(memory[3], 6, b.J.cols());
  MatrixXd taller = MatrixXd::Constant(8, std::max<Index>(1, b.dJ.cols()), kNan);
  auto dJ = taller.block(1, 0, 6, b.dJ.cols());
  fast.coriolisMatrixBatch(b.q, b.qd, C);
  fast.tipPoseBatch(b.q, R, p);
  fast.tipJacobianBatch(b.q, J);
  fast.tipJacobianDerivativeBatch(b.q, b.qd, dJ);
  for (const MatrixXd& numbers : {memory[0], memory[1], memory[2], memory[3]}) {
    for (Index row = 1; row < numbers.rows(); row += 2) {
      EXPECT_TRUE(numbers.row(row).array().isNaN().all()) << "written between the numbers";
    }
  }
  EXPECT_TRUE(taller.row(0).array().isNaN().all() && taller.row(7).array().isNaN().all());
  b.C = C;
  b.R = R;
  b.p = p;
  b.J = J;
  b.dJ = dJ;
}

TEST_P(FastModelOn, BatchesOfKinematicsEqualSingleCallsInAnyLayout) {
  for (const auto& [name, like] : models()) {
    const Model model = withEnds(like);
    const Index n = model.chain.jointCount();
    const FastModel fast(model, GetParam());
    SCOPED_TRACE(name);
    for (const Index count : {0, 1, 3, 8, 21}) {
      if (n > 30 && count > 8) continue;
      for (const auto layout : {inColumns, inRows, withGaps}) {
        Batch batch(n, count);
        layout(fast, batch);
        for (Index k = 0; k < count; ++k) {
          const State<double> x{batch.q.col(k), batch.qd.col(k), batch.qd.col(k)};
          Results of_state(n);
          of_state.C = batch.C.middleCols(k * n, n);
          of_state.R = batch.R.middleCols(3 * k, 3);
          of_state.p = batch.p.col(k);
          of_state.J = batch.J.middleCols(k * n, n);
          of_state.dJ = batch.dJ.middleCols(k * n, n);
          expectEqual(of_state, single(fast, x.q, x.qd), model, x, 1e-12);
        }
        if (HasFailure()) return;
      }
    }
  }
}

// A robot that stands far away has the same Jacobian to the last bit.
TEST_P(FastModelOn, JacobiansDoNotDependOnTheFirstJointsPlace) {
  for (const auto& [name, model] : models()) {
    std::vector<Joint> joints = model.chain.joints();
    joints[0].placement.p = {1e14, -3e13, 7e12};
    Model away = model;
    away.chain = Chain("away", joints, model.chain.links(), model.chain.gravity());
    Model here = model;
    joints[0].placement.p.setZero();
    here.chain = Chain("here", joints, model.chain.links(), model.chain.gravity());
    const State<double> x = randomState(model.chain, 3);
    const Results far = single(FastModel(away, GetParam()), x.q, x.qd);
    const Results near = single(FastModel(here, GetParam()), x.q, x.qd);
    EXPECT_EQ(far.J, near.J) << name;
    EXPECT_EQ(far.dJ, near.dJ) << name;
    EXPECT_EQ(far.R, near.R) << name;
  }
}

TEST_P(FastModelOn, NoCallOfKinematicsAllocates) {
  if (!CHAIN_DYNAMICS_COUNTS_ALLOCATIONS) {
    GTEST_SKIP() << "allocations are counted with the GNU C library, without sanitizers";
  }
  for (const auto& [name, model] : models()) {
    const Index n = model.chain.jointCount();
    const FastModel fast(model, GetParam());
    Batch b(n, 11);
    const VectorXd q = b.q.col(0);
    Results out(n);
    const AllocationGuard guard;
    fast.coriolisMatrix(q.data(), q.data(), out.C.data(), n);
    fast.tipPose(q.data(), out.R.data(), out.p.data());
    fast.tipJacobian(q.data(), out.J.data(), 6);
    fast.tipJacobianDerivative(q.data(), q.data(), out.dJ.data(), 6);
    if (n <= 16) inColumns(fast, b);
    EXPECT_EQ(guard.count(), 0) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Every, FastModelOn, ::testing::ValuesIn(FastModel::instructionSets()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace chain_dynamics

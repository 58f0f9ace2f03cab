// SPDX-License-Identifier: Apache-2.0

// FastModel's functions of many states.

#include <cstddef>
#include <string>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/fast_model.hpp"
#include "fast/robot.hpp"
#include "fast_branches.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using Eigen::Index;

/// The numbers of one state side by side.
struct OneState {
  double numbers[fast::kMaxJoints];

  const double* read(const ConstStates& from, Index k) {
    for (Index j = 0; j < from.joints; ++j) numbers[j] = from(j, k);
    return numbers;
  }
};

template <typename Number>
fast::Samples samples(const StridedStates<Number>& states) {
  // inputs are never written: see fast::ManyKernels
  return {const_cast<double*>(states.data), states.joint_step, states.state_step};
}
fast::Matrices matrices(const StridedMatrices& H) {
  return {H.data, H.row_step, H.column_step, H.state_step};
}

void requireStates(const char* what, const ConstStates& states, Index joints, Index count) {
  if (states.joints == joints && states.count == count) return;
  throw ModelError("samples of a Gram matrix", what,
                   std::to_string(joints) + " x " + std::to_string(count),
                   std::to_string(states.joints) + " x " + std::to_string(states.count), "");
}

/// Of sums for another robot.
void requireLinks(const fast::Robot& robot, Index joint, const std::vector<int>& links) {
  const auto j = static_cast<std::size_t>(joint);
  const auto& moved = static_cast<const FastBranches&>(robot).moved;
  const auto n = static_cast<std::size_t>(robot.joints);
  const bool fits = moved.empty() ? links.size() == n - j && links.front() == static_cast<int>(j)
                                  : links == moved[j];
  if (fits) return;
  throw ModelError("Gram matrix of the regressor",
                   "links that joint " + std::to_string(j + 1) + " moves", "those of this robot",
                   "others", "make it by emptyGram()");
}

/// Whether kernels for many states compute H: of short chains, and of trees.
bool packsMatrices(const fast::Robot& robot) {
  return robot.joints <= fast::kPackedMatrixJoints ||
         !static_cast<const FastBranches&>(robot).branches.empty();
}

}  // namespace

void FastModel::torquesBatch(ConstStates q, ConstStates qd, ConstStates qdd, States tau) const {
  many_->torques(robot(), structure_, q.count, samples(q), samples(qd), samples(qdd), samples(tau));
}

void FastModel::inertiaMatrixBatch(ConstStates q, StridedMatrices H) const {
  if (packsMatrices(robot())) {
    many_->inertia(robot(), structure_, q.count, samples(q), matrices(H));
    return;
  }
  OneState position;
  for (Index k = 0; k < q.count; ++k) {
    kernels_->inertia(robot(), structure_, position.read(q, k), matrices(H.middle(k, 1)));
  }
}

void FastModel::coriolisVectorBatch(ConstStates q, ConstStates qd, States c) const {
  many_->coriolis(robot(), structure_, q.count, samples(q), samples(qd), samples(c));
}

void FastModel::gravityVectorBatch(ConstStates q, States g) const {
  many_->gravity(robot(), structure_, q.count, samples(q), samples(g));
}

void FastModel::frictionVectorBatch(ConstStates q, ConstStates qd, States f) const {
  many_->friction(robot(), structure_, qd.count, samples(q), samples(qd), samples(f));
}

void FastModel::dynamicComponentsBatch(ConstStates q, ConstStates qd, StridedMatrices H, States c,
                                       States g) const {
  const bool packed = packsMatrices(robot());
  if (!packed) inertiaMatrixBatch(q, H);  // first: c and g may stand where q does
  const fast::Matrices to = packed ? matrices(H) : fast::Matrices{};
  many_->components(robot(), structure_, q.count, samples(q), samples(qd), to, samples(c),
                    samples(g));
}

void FastModel::forwardDynamicsBatch(ConstStates q, ConstStates qd, ConstStates tau,
                                     States qdd) const {
  if (robot().joints <= fast::kPackedMatrixJoints && robot().rows == nullptr) {
    many_->forward_dynamics(robot(), structure_, q.count, samples(q), samples(qd), samples(tau),
                            samples(qdd));
    return;
  }
  OneState position, velocity, torques, accelerations;
  for (Index k = 0; k < q.count; ++k) {
    forwardDynamics(position.read(q, k), velocity.read(qd, k), torques.read(tau, k),
                    accelerations.numbers);
    for (Index j = 0; j < q.joints; ++j) qdd(j, k) = accelerations.numbers[j];
  }
}

void FastModel::torqueDerivativesBatch(ConstStates q, ConstStates qd, ConstStates qdd,
                                       StridedMatrices dtau_dq, StridedMatrices dtau_dqd,
                                       StridedMatrices dtau_dqdd) const {
  if (robot().joints <= fast::kPackedMatrixJoints) {
    many_->torque_derivatives(robot(), structure_, q.count, samples(q), samples(qd), samples(qdd),
                              matrices(dtau_dq), matrices(dtau_dqd), matrices(dtau_dqdd));
    return;
  }
  OneState position, velocity, acceleration;
  const Index n = q.joints;
  Eigen::MatrixXd by_q(n, n), by_qd(n, n), by_qdd(n, n);
  for (Index k = 0; k < q.count; ++k) {
    torqueDerivatives(position.read(q, k), velocity.read(qd, k), acceleration.read(qdd, k),
                      by_q.data(), by_qd.data(), by_qdd.data(), n);
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i < n; ++i) {
        dtau_dq(i, j, k) = by_q(i, j);
        dtau_dqd(i, j, k) = by_qd(i, j);
        dtau_dqdd(i, j, k) = by_qdd(i, j);
      }
    }
  }
}

void FastModel::coriolisMatrixBatch(ConstStates q, ConstStates qd, StridedMatrices C) const {
  if (robot().joints <= fast::kPackedMatrixJoints) {
    many_->coriolis_matrix(robot(), structure_, q.count, samples(q), samples(qd), matrices(C));
    return;
  }
  OneState position, velocity;
  const Index n = q.joints;
  Eigen::MatrixXd one(n, n);
  for (Index k = 0; k < q.count; ++k) {
    coriolisMatrix(position.read(q, k), velocity.read(qd, k), one.data(), n);
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i < n; ++i) C(i, j, k) = one(i, j);
    }
  }
}

void FastModel::tipPoseBatch(ConstStates q, StridedMatrices R, States p) const {
  many_->tip_pose(robot(), structure_, q.count, samples(q), matrices(R), samples(p));
}

void FastModel::tipJacobianBatch(ConstStates q, StridedMatrices J) const {
  many_->tip_jacobian(robot(), structure_, q.count, samples(q), matrices(J.withColumns(q.joints)));
}

void FastModel::tipJacobianDerivativeBatch(ConstStates q, ConstStates qd,
                                           StridedMatrices dJ) const {
  many_->tip_jacobian_derivative(robot(), structure_, q.count, samples(q), samples(qd),
                                 matrices(dJ.withColumns(q.joints)));
}

void FastModel::regressorBatch(ConstStates q, ConstStates qd, ConstStates qdd,
                               StridedMatrices Y) const {
  many_->regressor(robot(), q.count, samples(q), samples(qd), samples(qdd),
                   matrices(Y.withColumns(10 * linkCount())));
}

void FastModel::addToGram(const GramSamples& given, RegressorGram& gram) const {
  const Index n = robot().joints;
  const Index count = given.q.count;
  if (gram.joints() != n || gram.ownColumns() != static_cast<Index>(given.own_columns.size())) {
    throw ModelError("Gram matrix of the regressor", "joints x own columns",
                     std::to_string(n) + " x " + std::to_string(given.own_columns.size()),
                     std::to_string(gram.joints()) + " x " + std::to_string(gram.ownColumns()), "");
  }
  std::ptrdiff_t row_numbers = 0;  // of all joints
  for (Index j = 0; j < n; ++j) {
    requireLinks(robot(), j, gram.moved_[static_cast<std::size_t>(j)]);
    row_numbers += fast::linksRow(static_cast<int>(gram.storedLinks(j) / 10), 0);
  }
  requireStates("q", given.q, n, count);
  requireStates("qd", given.qd, n, count);
  requireStates("qdd", given.qdd, n, count);
  requireStates("tau", given.tau, n, count);
  if (given.rows != nullptr && given.rows->samples_ != count) {
    throw ModelError("Gram matrix of the regressor", "rows", std::to_string(count) + " samples",
                     std::to_string(given.rows->samples_), "give those of the same samples");
  }
  std::vector<fast::Samples> columns;
  for (const ConstStates& column : given.own_columns) {
    requireStates("own column", column, n, count);
    columns.push_back(samples(column));
  }
  fast::Samples weights{};
  if (given.weights) {
    requireStates("weights", *given.weights, n, count);
    weights = samples(*given.weights);
  }
  const Index parts =
      given.keep != nullptr ? (count + fast::kGramStates - 1) / fast::kGramStates : 1;
  const auto size = static_cast<std::size_t>(parts * fast::kGramStates * row_numbers);
  RegressorRows here;
  RegressorRows& made = given.keep != nullptr ? *given.keep : here;
  if (given.rows == nullptr) made.numbers_.assign(size, 0.0);
  made.samples_ = count;
  const auto own_columns = static_cast<int>(columns.size());
  std::vector<double> own(
      static_cast<std::size_t>(n * fast::kGramStates * fast::ownRow(own_columns)));
  many_->gram(robot(), count,
              {samples(given.q), samples(given.qd), samples(given.qdd), samples(given.tau),
               columns.data(), own_columns, given.weights ? &weights : nullptr, given.links,
               given.rows != nullptr ? given.rows->numbers_.data() : nullptr},
              {made.numbers_.data(), given.keep != nullptr, own.data(), gram.sums_.data()});
  gram.samples_ += count;
}

}  // namespace v2
}  // namespace chain_dynamics

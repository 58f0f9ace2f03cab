// SPDX-License-Identifier: Apache-2.0

#include "effort_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::ArrayXXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Rows = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;

constexpr Index kParts = 8;           // each is left out once
constexpr Index kInPart = 2048;       // samples at most: errors of neighbours are alike
constexpr Index kTerms = 5;           // of a joint's fit beside those of the accelerations
constexpr double kRests = 0.01;       // of the greatest velocity; slower joints are at rest
constexpr double kStep = 0.02;        // of the greatest velocity; width of the step of friction
constexpr double kRidge = 1e-9;       // of a term's power, where terms depend on one another
constexpr double kRatio = 1.4142136;  // from one candidate to the next
constexpr double kAbove = 4.0;  // times what positions and velocities choose: the highest candidate
constexpr double kAboveMotion = 2.0;   // times the frequency of the motion: the lowest candidate
constexpr double kUnexplained = 0.01;  // of the efforts' deviation: a cut-off is worth a choice
constexpr double kLeastGain = 0.01;    // of the error
constexpr double kStandardErrors = 2.0;

// Normal equations of a part.
struct Sums {
  MatrixXd terms;
  VectorXd measured;
  double power;  // of the measured
  Index count;

  VectorXd fittedTo(const Sums& without) const {
    MatrixXd rest = terms - without.terms;
    rest.diagonal() *= 1 + kRidge;
    rest.diagonal().array() += std::numeric_limits<double>::min();
    return rest.ldlt().solve(measured - without.measured);
  }
  double errorOf(const VectorXd& fit) const {
    const double sum = power - 2 * fit.dot(measured) + fit.dot(terms * fit);
    return std::sqrt(std::max(sum, 0.0) / static_cast<double>(count));
  }
};

}  // namespace

std::unique_ptr<SampleTable> excerptOf(const SampleTable& table) {
  const Index size = table.size();
  if (size <= kParts * kInPart) return nullptr;
  // the windows with the most motion, in the order of time
  const Eigen::VectorXd fastest = table.qd.cwiseAbs().rowwise().maxCoeff().cwiseMax(1e-12);
  const Index windows = size / kInPart;
  Eigen::VectorXd power(windows);
  for (Index w = 0; w < windows; ++w) {
    const auto qd = table.qd.middleCols(w * kInPart, kInPart);
    power[w] = (qd.array().colwise() / fastest.array()).square().sum();
  }
  std::vector<Index> order(static_cast<std::size_t>(windows));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return power[a] > power[b]; });
  order.resize(kParts);
  std::sort(order.begin(), order.end());
  std::vector<Index> columns;
  for (const Index w : order) {
    for (Index k = 0; k < kInPart; ++k) columns.push_back(w * kInPart + k);
  }
  using Stamps = Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>;
  const auto picked = [&](const auto& numbers) { return MatrixXd(numbers(Eigen::all, columns)); };
  const Stamps header = table.header_stamps(columns), receive = table.receive_stamps(columns);
  const MatrixXd q = picked(table.q), qd = picked(table.qd), effort = picked(table.effort);
  return tableOf({header, receive, table.clock(), q, qd, effort, MatrixXd()});
}

EffortFit::EffortFit(const SampleTable& table,
                     const inverse_dynamics_solver::InverseDynamicsSolver& solver)
    : table_(table), fastest_(table.qd.cwiseAbs().rowwise().maxCoeff()) {
  for (Index k = 0; k < table.size(); ++k) {
    const bool moves = (table.qd.col(k).array().abs() > kRests * fastest_.array()).any();
    if (moves && table.kept[k] && table.used[k]) moving_.push_back(k);
  }
  q_ = table.q(Eigen::all, moving_);
  qd_ = table.qd(Eigen::all, moving_);
  effort_ = table.effort(Eigen::all, moving_);
  const MatrixXd zero = MatrixXd::Zero(q_.rows(), q_.cols());
  gravity_ = solver.getGravityVectorBatch(q_);
  other_ = solver.getTorquesBatch(q_, qd_, zero) - gravity_;
  inertia_ = solver.getInertiaMatrixBatch(q_);
}

ArrayXXd EffortFit::errors() const {
  const MatrixXd qdd = table_.qdd(Eigen::all, moving_);
  const Index joints = q_.rows(), samples = q_.cols();
  ArrayXXd found(kParts, joints);
  MatrixXd terms(kTerms + joints, samples);
  for (Index j = 0; j < joints; ++j) {
    // row j of each inertia matrix
    const Eigen::Map<const MatrixXd, 0, Rows> inertia(inertia_.data() + j, joints, samples,
                                                      Rows(joints * joints, joints));
    const double width = kStep * std::max(fastest_[j], std::numeric_limits<double>::min());
    terms.row(0) = gravity_.row(j);
    terms.row(1) = other_.row(j);
    terms.row(2) = qd_.row(j);
    terms.row(3) = (qd_.row(j) / width).array().tanh();
    terms.row(4).setOnes();
    terms.bottomRows(joints) = inertia.cwiseProduct(qdd);
    std::vector<Sums> parts;
    Sums all{MatrixXd::Zero(terms.rows(), terms.rows()), VectorXd::Zero(terms.rows()), 0, 0};
    for (Index p = 0; p < kParts; ++p) {
      const Index first = p * samples / kParts, count = (p + 1) * samples / kParts - first;
      const auto of = terms.middleCols(first, count);
      const VectorXd measured = effort_.row(j).segment(first, count);
      parts.push_back({of * of.transpose(), of * measured, measured.squaredNorm(), count});
      all.terms += parts.back().terms;
      all.measured += parts.back().measured;
    }
    for (Index p = 0; p < kParts; ++p) {
      const Sums& part = parts[static_cast<std::size_t>(p)];
      found(p, j) = part.errorOf(all.fittedTo(part));
    }
  }
  return found;
}

CutoffChoice EffortFit::choose(CutoffChoice motion, const Differentiate& differentiate) const {
  if (q_.cols() < kParts * 2 * (kTerms + q_.rows())) return motion;
  differentiate(motion.by_motion);
  const ArrayXXd before = errors();
  const Eigen::ArrayXd scale = before.square().colwise().mean().sqrt();
  // of each part, its errors in units of those of the motion's choice
  const auto scored = [&](const ArrayXXd& of) -> Eigen::ArrayXd {
    return (scale.transpose() > 0)
        .replicate(kParts, 1)
        .select(of.rowwise() / scale.transpose(), 1.0)
        .rowwise()
        .mean();
  };
  const VectorXd deviation =
      ((effort_.colwise() - effort_.rowwise().mean()).rowwise().squaredNorm() /
       static_cast<double>(q_.cols()))
          .cwiseSqrt();
  if (scale.sum() < kUnexplained * deviation.sum()) return motion;
  const Eigen::ArrayXd start = scored(before);
  const double lowest = std::max(motion.lowest, kAboveMotion * motion.motion);
  const double highest = std::min(motion.highest, kAbove * motion.by_motion);
  const auto clearly = [](const Eigen::ArrayXd& saved) {
    const double variance = (saved - saved.mean()).square().sum() / (kParts - 1) / kParts;
    return saved.mean() > kStandardErrors * std::sqrt(variance);
  };
  // from the highest on: a lower one takes away more of the motion, so it must be better
  Eigen::ArrayXd best = Eigen::ArrayXd::Zero(kParts);
  for (double cutoff = highest; cutoff >= lowest; cutoff /= kRatio) {
    differentiate(cutoff);
    const Eigen::ArrayXd saved = start - scored(errors());
    const double gain = saved.mean() / start.mean();
    if (gain > std::max(motion.gain, kLeastGain) && clearly(saved) && clearly(saved - best)) {
      motion.gain = gain;
      motion.cutoff = cutoff;
      best = saved;
    }
  }
  return motion;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

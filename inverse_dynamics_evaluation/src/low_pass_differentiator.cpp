// SPDX-License-Identifier: Apache-2.0

#include "low_pass_differentiator.hpp"

#include <algorithm>
#include <utility>

#include "ends.hpp"
#include "inverse_dynamics_evaluation/low_pass.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

constexpr double kFitPeriods = 1.2;     // of the cut-off, to which the ends' cubics are fitted
constexpr double kBeyondPeriods = 2.0;  // of the cut-off, by which they continue the ends
constexpr Index kBeside = 2;            // samples to either side that a difference needs

// Point reflection of the columns about the first one: 2 x_0 - x_k, k = count, ..., 1.
Eigen::MatrixXd mirrored(const Eigen::MatrixXd& samples, Index count) {
  return (2.0 * samples.col(0)).replicate(1, count) -
         samples.middleCols(1, count).rowwise().reverse();
}

Eigen::MatrixXd joined(const Eigen::MatrixXd& before,
                       const Eigen::Ref<const Eigen::MatrixXd>& after) {
  Eigen::MatrixXd result(after.rows(), before.cols() + after.cols());
  result << before, after;
  return result;
}

Index fitOf(Index count, double period) {
  return std::min(
      std::max(static_cast<Index>(std::min(kFitPeriods * period, 1.0 * count)), kLeastFit), count);
}

// Not further than the cubic may be trusted: as far as the samples that it is fitted to.
Index beyondOf(Index count, double period, int order) {
  const auto beyond = static_cast<Index>(
      std::min(kBeyondPeriods * period, kBeyondPeriods / kFitPeriods * static_cast<double>(count)));
  return std::max<Index>(beyond, 3 * (Index{order} + 1));
}

}  // namespace

LowPassDifferentiator::LowPassDifferentiator(Index joints, Index count, double sampling_frequency,
                                             double cutoff, int order, TakeColumns take)
    : count_(count),
      sampling_frequency_(sampling_frequency),
      fit_(fitOf(count, sampling_frequency / cutoff)),
      beyond_(beyondOf(count, sampling_frequency / cutoff, order)),
      mirror_(defaultPadding(count + 2 * beyond_, sampling_frequency, cutoff, order)),
      end_(std::min(std::max(fit_, mirror_ + 1 - beyond_), count)),
      take_(std::move(take)),
      filter_(joints, cutoff / sampling_frequency, order,
              ZeroPhaseFilter::overlapOf(cutoff / sampling_frequency, order),
              [this](const auto& filtered) { differentiate(filtered); }),
      first_(joints, 0),
      last_(joints, 0),
      skip_(mirror_ + beyond_ - kBeside),
      neighbours_(joints, 0) {}

void LowPassDifferentiator::push(const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  Index fresh = 0;
  if (first_.cols() < end_) {
    fresh = std::min(end_ - first_.cols(), samples.cols());
    first_ = joined(first_, samples.leftCols(fresh));
    if (first_.cols() == end_ && end_ < count_) {
      begin();
    }
  }
  filter_.push(samples.rightCols(samples.cols() - fresh));
  pushed_ += samples.cols();
  // the last samples, once they may be those of the end
  if (pushed_ > count_ - end_) {
    const Index more = std::min(pushed_ - (count_ - end_), samples.cols());
    last_ = joined(last_, samples.rightCols(more));
  }
}

// What lies before the first sample, and the first samples.
void LowPassDifferentiator::begin() {
  const Eigen::MatrixXd cubic = beyondEnd(first_.leftCols(fit_), beyond_);
  const Eigen::MatrixXd longer = joined(cubic.rowwise().reverse(), first_);
  filter_.push(mirrored(longer, mirror_));
  filter_.push(longer);
}

void LowPassDifferentiator::finish() {
  if (end_ == count_) {  // so short that the ends see each other
    filterWhole();
    return;
  }
  // the end, with time counted backwards, is a beginning
  const Eigen::MatrixXd backwards = last_.rowwise().reverse();
  const Eigen::MatrixXd cubic = beyondEnd(backwards.leftCols(fit_), beyond_);
  const Eigen::MatrixXd longer = joined(cubic.rowwise().reverse(), backwards);
  filter_.push(cubic);
  filter_.push(mirrored(longer, mirror_).rowwise().reverse());
  filter_.finish();
}

void LowPassDifferentiator::filterWhole() {
  const Eigen::MatrixXd backwards = first_.rowwise().reverse();
  const Eigen::MatrixXd before = beyondEnd(first_.leftCols(fit_), beyond_).rowwise().reverse();
  const Eigen::MatrixXd longer =
      joined(joined(before, first_), beyondEnd(backwards.leftCols(fit_), beyond_));
  filter_.push(mirrored(longer, mirror_));
  filter_.push(longer);
  filter_.push(mirrored(longer.rowwise().reverse(), mirror_).rowwise().reverse());
  filter_.finish();
}

void LowPassDifferentiator::differentiate(const Eigen::Ref<const Eigen::MatrixXd>& filtered) {
  const Index skipped = std::min(skip_, filtered.cols());
  skip_ -= skipped;
  const Eigen::MatrixXd x = joined(neighbours_, filtered.rightCols(filtered.cols() - skipped));
  const Index ready = std::min(x.cols() - 2 * kBeside, count_ - given_);
  if (ready <= 0) {
    neighbours_ = x.rightCols(std::min(x.cols(), 2 * kBeside));
    return;
  }
  const double period = 1.0 / sampling_frequency_;
  const Eigen::MatrixXd result = (8.0 * (x.middleCols(3, ready) - x.middleCols(1, ready)) -
                                  (x.middleCols(4, ready) - x.leftCols(ready))) /
                                 (12.0 * period);
  neighbours_ = x.rightCols(2 * kBeside);
  given_ += ready;
  take_(result);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/accelerations.hpp"

#include <algorithm>
#include <cmath>

#include "checks.hpp"
#include "low_pass_differentiator.hpp"
#include "quantile.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;
using ConstVector = Eigen::Ref<const Eigen::VectorXd>;

// Distances of samples that a cubic may run through, in periods: across a longer hole, the noise of
// the two samples at either end would set its slope.
constexpr double kLeastApart = 0.5;
constexpr double kMostApart = 3.0;

// Used samples between two gaps.
struct Piece {
  std::vector<Index> sample;
  double begin = 0;   // s
  double period = 0;  // s; of the equidistant samples
  Index count = 0;    // of them
};

// Weights of four samples at the instants `at` in the cubic through them, at instant t.
Eigen::Vector4d cubicWeights(const Eigen::Vector4d& at, double t) {
  Eigen::Vector4d weights = Eigen::Vector4d::Ones();
  for (Index i = 0; i < 4; ++i) {
    for (Index k = 0; k < 4; ++k) {
      weights[i] *= i == k ? 1.0 : (t - at[k]) / (at[i] - at[k]);
    }
  }
  return weights;
}

// Values at equidistant instants: on the cubic through the four samples around each, or on a
// straight line where two of these are so close, or so far apart, that a cubic would enlarge their
// noise.
Eigen::MatrixXd equidistant(const ConstVector& time, const ConstMatrix& values,
                            const Piece& piece) {
  Eigen::MatrixXd result(values.rows(), piece.count);
  const auto count = static_cast<Index>(piece.sample.size());
  const auto sample = [&](Index i) { return piece.sample[static_cast<std::size_t>(i)]; };
  Index right = 1;  // of the two samples around an instant
  for (Index i = 0; i < piece.count; ++i) {
    const double t = piece.begin + static_cast<double>(i) * piece.period;
    while (right + 1 < count && time[sample(right)] < t) {
      ++right;
    }
    const Index first = std::clamp<Index>(right - 2, 0, count - 4);
    Eigen::Vector4d at;
    for (Index k = 0; k < 4; ++k) {
      at[k] = time[sample(first + k)];
    }
    const Eigen::Vector3d apart = (at.tail<3>() - at.head<3>()) / piece.period;
    if (apart.minCoeff() >= kLeastApart && apart.maxCoeff() <= kMostApart) {
      const Eigen::Vector4d weights = cubicWeights(at, t);
      result.col(i).setZero();
      for (Index k = 0; k < 4; ++k) {
        result.col(i) += weights[k] * values.col(sample(first + k));
      }
    } else {
      const Index before = sample(right - 1);
      const Index after = sample(right);
      const double share = std::clamp((t - time[before]) / (time[after] - time[before]), 0.0, 1.0);
      result.col(i) = (1.0 - share) * values.col(before) + share * values.col(after);
    }
  }
  return result;
}

// Median distance in time of neighbours in a piece: a sample that was lost doesn't change it. At
// least half of the mean distance, as most samples of a recording may come in bursts.
double usualPeriod(const SampleReport& samples, const std::vector<Piece>& pieces) {
  std::vector<double> distances;
  for (const Piece& piece : pieces) {
    for (std::size_t i = 1; i < piece.sample.size(); ++i) {
      distances.push_back(samples.time[piece.sample[i]] - samples.time[piece.sample[i - 1]]);
    }
  }
  return distances.empty() ? samples.period
                           : std::max(quantile(distances, 0.5), 0.5 * samples.period);
}

std::vector<Piece> cutPieces(const SampleReport& samples) {
  std::vector<Piece> pieces;
  std::size_t next = 0;
  for (Index k = 0; k < samples.used.size(); ++k) {
    if (!samples.used[k]) {
      continue;
    }
    if (next < samples.pieces.size() && k == samples.pieces[next]) {
      pieces.emplace_back();
      ++next;
    }
    pieces.back().sample.push_back(k);
  }
  const double period = usualPeriod(samples, pieces);
  for (Piece& piece : pieces) {
    piece.begin = samples.time[piece.sample.front()];
    const double duration = samples.time[piece.sample.back()] - piece.begin;
    piece.count = std::max(static_cast<Index>(std::llround(duration / period)) + 1,
                           static_cast<Index>(piece.sample.size()));
    piece.period = duration / static_cast<double>(piece.count - 1);
  }
  return pieces;
}

// Of the equidistant samples of all pieces [Hz].
double samplingFrequency(const std::vector<Piece>& pieces) {
  double intervals = 0.0;
  double duration = 0.0;
  for (const Piece& piece : pieces) {
    intervals += static_cast<double>(piece.count - 1);
    duration += static_cast<double>(piece.count - 1) * piece.period;
  }
  return intervals / duration;
}

// Accelerations of equidistant samples at any instants that don't decrease; between two pieces on
// the straight line from the one to the other, beyond the ends constant.
Eigen::MatrixXd atInstants(const std::vector<Piece>& pieces,
                           const std::vector<Eigen::MatrixXd>& qdd, const Eigen::VectorXd& time) {
  Eigen::MatrixXd result(qdd.front().rows(), time.size());
  std::size_t p = 0;  // last piece that has begun
  for (Index k = 0; k < time.size(); ++k) {
    while (p + 1 < pieces.size() && time[k] >= pieces[p + 1].begin) {
      ++p;
    }
    const Eigen::MatrixXd& values = qdd[p];
    const auto last = static_cast<double>(values.cols() - 1);
    const double at = std::max((time[k] - pieces[p].begin) / pieces[p].period, 0.0);
    if (at < last) {
      const auto before = static_cast<Index>(at);
      const double share = at - static_cast<double>(before);
      result.col(k) = (1.0 - share) * values.col(before) + share * values.col(before + 1);
    } else if (p + 1 == pieces.size()) {
      result.col(k) = values.col(values.cols() - 1);
    } else {
      const double gap = pieces[p + 1].begin - pieces[p].begin - last * pieces[p].period;
      const double share = std::clamp((at - last) * pieces[p].period / gap, 0.0, 1.0);
      result.col(k) = (1.0 - share) * values.col(values.cols() - 1) + share * qdd[p + 1].col(0);
    }
  }
  return result;
}

void requirePieces(const std::vector<Piece>& pieces, const SampleRules& rules,
                   const SampleReport& samples) {
  if (pieces.empty()) {
    throw EvaluationError(
        "low-pass accelerations", "samples",
        std::to_string(rules.shortest_piece) + " or more that differ, without a gap",
        std::to_string((!samples.repeated).count()) + " with gaps of more than " +
            std::to_string(rules.longest_gap) + " s between them",
        "record for longer, or take backward differences");
  }
}

// Low-pass and derivative of each piece.
std::vector<Eigen::MatrixXd> filterPieces(const std::vector<Piece>& pieces,
                                          const std::vector<Stretch>& stretches,
                                          const FilterChoice& filter) {
  std::vector<Eigen::MatrixXd> qdd;
  qdd.reserve(pieces.size());
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    qdd.emplace_back(
        lowPassDerivative(stretches[p].qd, 1.0 / pieces[p].period, filter.cutoff, filter.order));
  }
  return qdd;
}

}  // namespace

OwnedMatrix backwardDifference(const Eigen::Ref<const Eigen::VectorXd>& time,
                               const Eigen::Ref<const Eigen::MatrixXd>& qd) {
  requireSamples("backward difference", "qd", qd, 1);
  requireStampPerSample("backward difference", time, qd);
  requireFiniteStamps("backward difference", time);
  requireFinite("backward difference", "qd", qd);
  Eigen::MatrixXd qdd = Eigen::MatrixXd::Zero(qd.rows(), qd.cols());
  for (Index k = 1; k < qd.cols(); ++k) {
    const double dt = time[k] - time[k - 1];
    if (dt > 0.0) {
      qdd.col(k) = (qd.col(k) - qd.col(k - 1)) / dt;
    }
  }
  return qdd;
}

OwnedMatrix derivative(const Eigen::Ref<const Eigen::MatrixXd>& samples, double period) {
  requireSamples("derivative", "samples", samples, 2);
  if (!(period > 0)) {
    throw EvaluationError("derivative", "period", "a positive number of seconds",
                          std::to_string(period), "give the distance of the samples");
  }
  const Index last = samples.cols() - 1;
  Eigen::MatrixXd result(samples.rows(), samples.cols());
  for (Index k = 0; k <= last; ++k) {
    if (k >= 2 && k + 2 <= last) {
      result.col(k) = (8.0 * (samples.col(k + 1) - samples.col(k - 1)) -
                       (samples.col(k + 2) - samples.col(k - 2))) /
                      (12.0 * period);
    } else {
      const Index before = std::max<Index>(k - 1, 0);
      const Index after = std::min(k + 1, last);
      result.col(k) = (samples.col(after) - samples.col(before)) /
                      (static_cast<double>(after - before) * period);
    }
  }
  return result;
}

OwnedMatrix lowPassDerivative(const Eigen::Ref<const Eigen::MatrixXd>& samples,
                              double sampling_frequency, double cutoff, int order) {
  requireSamples("low-pass derivative", "samples", samples, 3 * (order + 1) + 1);
  requireFinite("low-pass derivative", "samples", samples);
  requireFilter(sampling_frequency, cutoff, order);
  OwnedMatrix result(samples.rows(), samples.cols());
  Index given = 0;
  LowPassDifferentiator differentiator(samples.rows(), samples.cols(), sampling_frequency, cutoff,
                                       order, [&](const auto& derivatives) {
                                         result.middleCols(given, derivatives.cols()) = derivatives;
                                         given += derivatives.cols();
                                       });
  differentiator.push(samples);
  differentiator.finish();
  return result;
}

AccelerationEstimate lowPassAccelerations(const Eigen::Ref<const Eigen::VectorXd>& time,
                                          const Eigen::Ref<const Eigen::MatrixXd>& q,
                                          const Eigen::Ref<const Eigen::MatrixXd>& qd,
                                          const Eigen::Ref<const Eigen::MatrixXd>& effort,
                                          const LowPassOptions& options) {
  // what the filter needs, every piece must have
  SampleRules rules = options.rules;
  rules.shortest_piece = std::max<Index>(rules.shortest_piece, 3 * (options.order + 1) + 1);
  AccelerationEstimate estimate;
  estimate.samples = examineSamples(time, q, qd, effort, rules);
  const std::vector<Piece> pieces = cutPieces(estimate.samples);
  requirePieces(pieces, rules, estimate.samples);

  // equidistant samples, as the filter and the spectra need them
  std::vector<Stretch> stretches;
  stretches.reserve(pieces.size());
  for (const Piece& piece : pieces) {
    stretches.push_back({equidistant(estimate.samples.time, q, piece),
                         equidistant(estimate.samples.time, qd, piece)});
  }

  FilterChoice& filter = estimate.filter;
  filter.order = options.order;
  filter.sampling_frequency = samplingFrequency(pieces);
  filter.time_base = estimate.samples.time_base;
  filter.pieces = static_cast<Index>(pieces.size());
  filter.cutoff = options.cutoff;
  filter.chosen = options.cutoff == 0;
  if (filter.chosen) {
    filter.choice = chooseCutoff(stretches, filter.sampling_frequency, options.order);
    filter.cutoff = filter.choice.cutoff;
  }
  filter.method = "zero-phase Butterworth low-pass of the velocities, then central differences";

  estimate.qdd = atInstants(pieces, filterPieces(pieces, stretches, filter), estimate.samples.time);
  return estimate;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

// SPDX-License-Identifier: Apache-2.0

#include "table_accelerations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "checks.hpp"
#include "examination.hpp"
#include "figures.hpp"
#include "spectrum.hpp"
#include "zero_phase.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Equidistant samples whose spectra are computed at once: longer pieces are cut for that.
constexpr Index kMostInStretch = 262144;

// Distances of samples that a cubic may run through, in periods: across a longer hole, the noise of
// the two samples at either end would set its slope.
constexpr double kLeastApart = 0.5;
constexpr double kMostApart = 3.0;

// A piece, and the equidistant samples that stand for it.
struct Grid : Piece {
  // usual_period [s]: about their distance. There are at least as many as used samples.
  Grid(const Piece& piece, double usual_period) : Piece(piece) {
    const double duration = end - begin;
    count = std::max(static_cast<Index>(std::llround(duration / usual_period)) + 1, used);
    period = duration / static_cast<double>(count - 1);
  }

  Index count = 0;    // of the equidistant samples
  double period = 0;  // s; between them
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

// Weights on the straight line between the two samples around t.
Eigen::Vector4d linearWeights(const Eigen::Vector4d& at, double t) {
  Index after = 1;
  while (after < 3 && at[after] < t) ++after;
  const double share = std::clamp((t - at[after - 1]) / (at[after] - at[after - 1]), 0.0, 1.0);
  Eigen::Vector4d weights = Eigen::Vector4d::Zero();
  weights[after - 1] = 1.0 - share;
  weights[after] = share;
  return weights;
}

// Goes through the equidistant samples of a piece, which has at least four used samples.
//
// A value lies on the cubic through the four samples around its instant, or on a straight line where
// two of these are so close, or so far apart, that a cubic would enlarge their noise.
class Resampler {
 public:
  Resampler(const SampleTable& table, const Grid& grid)
      : table_(table), grid_(grid), ahead_(grid.first) {
    for (int i = 0; i < 4; ++i) advance();
  }

  // Weighs the neighbours of the next equidistant sample.
  void next() {
    const double t = grid_.begin + static_cast<double>(made_++) * grid_.period;
    // the instant lies between the middle two where there are samples beyond
    while (t > instants_[2] && advance()) {
    }
    const Eigen::Vector3d apart = (instants_.tail<3>() - instants_.head<3>()) / grid_.period;
    weights_ = apart.minCoeff() >= kLeastApart && apart.maxCoeff() <= kMostApart
                   ? cubicWeights(instants_, t)
                   : linearWeights(instants_, t);
  }

  // The value there of columns of the table.
  auto valueOf(const SampleTable::JointColumns& columns) const {
    return weights_[0] * columns.col(samples_[0]) + weights_[1] * columns.col(samples_[1]) +
           weights_[2] * columns.col(samples_[2]) + weights_[3] * columns.col(samples_[3]);
  }

 private:
  // Takes one sample further; false at the end of the piece.
  bool advance() {
    while (ahead_ < grid_.behind && !table_.used[ahead_]) ++ahead_;
    if (ahead_ == grid_.behind) return false;
    std::rotate(samples_.begin(), samples_.begin() + 1, samples_.end());
    instants_.head<3>() = instants_.tail<3>().eval();
    samples_[3] = ahead_;
    instants_[3] = table_.instant[ahead_++];
    return true;
  }

  const SampleTable& table_;
  const Grid& grid_;
  Index made_ = 0;
  Index ahead_;                         // first sample behind the four
  std::array<Index, 4> samples_{};      // neighbours in the table, all used
  Eigen::Vector4d instants_, weights_;  // s; of them
};

AccelerationMethod methodOf(const AccelerationOptions& options, bool recorded) {
  if (options.method == AccelerationMethod::kAuto) {
    return recorded && options.cutoff == 0 ? AccelerationMethod::kGiven
                                           : AccelerationMethod::kLowPass;
  }
  if (options.method == AccelerationMethod::kGiven && !recorded) {
    throw EvaluationError(
        "accelerations: the recording gives none; expected another method, such as auto");
  }
  return options.method;
}

std::vector<Grid> gridsOf(const Examination& found, const SampleRules& rules) {
  if (found.pieces.empty()) {
    const SampleCounts& counts = found.report.counts;
    throw EvaluationError(
        "low-pass accelerations", "samples",
        std::to_string(rules.shortest_piece) + " or more that differ, without a gap",
        std::to_string(counts.all - counts.repeated) + " with gaps of more than " +
            std::to_string(rules.longest_gap) + " s between them",
        "record for longer, or take backward differences");
  }
  std::vector<Grid> grids;
  for (const Piece& piece : found.pieces) {
    grids.emplace_back(piece, found.usual_period);
  }
  return grids;
}

// Of the equidistant samples of all pieces [Hz].
double samplingFrequency(const std::vector<Grid>& grids) {
  double intervals = 0.0;
  double duration = 0.0;
  for (const Grid& grid : grids) {
    intervals += static_cast<double>(grid.count - 1);
    duration += static_cast<double>(grid.count - 1) * grid.period;
  }
  return intervals / duration;
}

// The cut-off that suits the equidistant samples.
CutoffChoice choiceOf(const SampleTable& table, const std::vector<Grid>& grids,
                      double sampling_frequency, int order) {
  const Index joints = table.q.rows();
  Index longest = 0;
  for (const Grid& grid : grids) {
    longest = std::max(longest, grid.count);
  }
  requireLongEnough(longest);
  SpectrumSums sums(joints, std::min(longest, kMostInStretch), sampling_frequency);
  Stretch stretch;
  for (const Grid& grid : grids) {
    Resampler resampler(table, grid);
    const Index parts = (grid.count + kMostInStretch - 1) / kMostInStretch;
    for (Index part = 0; part < parts; ++part) {
      const Index length = (part + 1) * grid.count / parts - part * grid.count / parts;
      stretch.q.resize(joints, length);
      stretch.qd.resize(joints, length);
      for (Index i = 0; i < length; ++i) {
        resampler.next();
        stretch.q.col(i) = resampler.valueOf(table.q);
        stretch.qd.col(i) = resampler.valueOf(table.qd);
      }
      sums.add(stretch);
    }
  }
  return cutoffOf(sums.spectra(), static_cast<double>(longest - 1) / sampling_frequency,
                  sampling_frequency, order);
}

// Accelerations at the instants of samples in their order: on straight lines between those of
// equidistant samples, and between two pieces.
class Interpolation {
 public:
  explicit Interpolation(SampleTable& table) : table_(table) {}

  /// Those of a piece, and of what lies between it and the one before.
  void add(const Grid& grid, const Eigen::Ref<const MatrixXd>& accelerations) {
    for (; next_ < table_.size() && table_.instant[next_] < grid.begin; ++next_) {
      const double share =
          end_ < grid.begin ? (table_.instant[next_] - end_) / (grid.begin - end_) : 1.0;
      table_.qdd.col(next_) = accelerations.col(0);
      if (last_.size() > 0) {
        table_.qdd.col(next_) = (1.0 - share) * last_ + share * accelerations.col(0);
      }
    }
    const Index last = grid.count - 1;
    for (; next_ < table_.size(); ++next_) {
      const double place = (table_.instant[next_] - grid.begin) / grid.period;
      if (!(place < static_cast<double>(last))) break;
      const auto before = static_cast<Index>(place);
      const double share = place - static_cast<double>(before);
      table_.qdd.col(next_) =
          (1.0 - share) * accelerations.col(before) + share * accelerations.col(before + 1);
    }
    last_ = accelerations.col(last);
    end_ = grid.begin + static_cast<double>(last) * grid.period;
  }

  /// Samples behind the last piece.
  void finish() {
    for (; next_ < table_.size(); ++next_) {
      table_.qdd.col(next_) = last_;
    }
  }

 private:
  SampleTable& table_;
  Index next_ = 0;        // sample
  Eigen::VectorXd last_;  // acceleration of the last piece's end
  double end_ = 0;        // s; of it
};

FilterChoice lowPass(SampleTable& table, const Examination& found,
                     const AccelerationOptions& options) {
  const std::vector<Grid> grids = gridsOf(found, options.rules);
  FilterChoice filter;
  filter.method = "zero-phase Butterworth low-pass of the velocities, then central differences";
  filter.order = options.order;
  filter.sampling_frequency = samplingFrequency(grids);
  filter.time_base = found.report.time_base;
  filter.pieces = static_cast<Index>(grids.size());
  filter.cutoff = options.cutoff;
  filter.chosen = options.cutoff == 0;
  if (filter.chosen) {
    filter.choice = choiceOf(table, grids, filter.sampling_frequency, filter.order);
    filter.cutoff = filter.choice.cutoff;
  }
  for (const Grid& grid : grids) {
    requireFilter(1.0 / grid.period, filter.cutoff, filter.order);
  }
  Interpolation interpolation(table);
  for (const Grid& grid : grids) {
    const DerivativeRoom room(grid.count, 1.0 / grid.period, filter.cutoff, filter.order);
    auto columns = table.scratch(table.q.rows(), room.size());
    Resampler resampler(table, grid);
    for (Index i = 0; i < grid.count; ++i) {
      resampler.next();
      columns.col(room.begin() + i) = resampler.valueOf(table.qd);
    }
    interpolation.add(grid, room.differentiate(columns));
  }
  interpolation.finish();
  return filter;
}

}  // namespace

void checkLog(const JointLogView& log) {
  requireSamples("samples", "qd", log.qd, 2);
  requireStampPerSample("samples", log.header_stamps.cast<double>(), log.qd);
  requireStampPerSample("samples", log.receive_stamps.cast<double>(), log.qd);
  checkSamples(log.time(), log.q, log.qd, log.effort);
  if (log.qdd.size() > 0) {
    requireSameSize("samples", "qdd", log.qdd, "qd", log.qd);
  }
}

void checkCutoff(AccelerationMethod method, double cutoff) {
  const bool filtered =
      method == AccelerationMethod::kAuto || method == AccelerationMethod::kLowPass;
  if (cutoff != 0 && !filtered) {
    throw EvaluationError("accelerations: " + name(method) + " has no cut-off, got " +
                          formatted("%g", cutoff) + " Hz; use low-pass");
  }
  if (!(cutoff >= 0) || std::isinf(cutoff)) {
    throw EvaluationError("low-pass", "cut-off", "above 0 and below half the sampling frequency",
                          formatted("%g", cutoff) + " Hz", "lower it, or don't filter");
  }
}

void backwardDifference(const Eigen::Ref<const Eigen::VectorXd>& time,
                        const Eigen::Ref<const MatrixXd>& qd, Eigen::Ref<MatrixXd> qdd) {
  for (Index k = 0; k < qd.cols(); ++k) {
    const double dt = k > 0 ? time[k] - time[k - 1] : 0.0;
    if (dt > 0.0) {
      qdd.col(k) = (qd.col(k) - qd.col(k - 1)) / dt;
    } else {
      qdd.col(k).setZero();
    }
  }
}

LogAccelerations findAccelerations(SampleTable& table, const AccelerationOptions& asked) {
  checkCutoff(asked.method, asked.cutoff);
  AccelerationOptions options = asked;
  LogAccelerations result;
  result.method = methodOf(options, table.has_accelerations);
  const bool filtered = result.method == AccelerationMethod::kLowPass;
  // what the filter needs, every piece must have; without a filter none is too short
  options.rules.shortest_piece =
      filtered ? std::max(options.rules.shortest_piece, leastSamples(options.order)) : 1;
  Examination found = examine(table, options.rules);
  if (filtered) {
    result.filter = lowPass(table, found, options);
  } else if (result.method == AccelerationMethod::kBackwardDifference) {
    backwardDifference(table.time, table.qd, table.qdd);
  }
  result.samples = std::move(found.report);
  result.summary = accelerationSummary(result.method, result.filter.cutoff, result.filter.chosen);
  result.findings =
      sampleFindings(name(table.clock()), result.samples, filtered ? &result.filter : nullptr);
  return result;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

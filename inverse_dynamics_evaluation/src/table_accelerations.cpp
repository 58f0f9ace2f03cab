// SPDX-License-Identifier: Apache-2.0

#include "table_accelerations.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "checks.hpp"
#include "examination.hpp"
#include "figures.hpp"
#include "resampler.hpp"
#include "spectrum.hpp"
#include "zero_phase.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Equidistant samples whose spectra are computed at once: longer pieces are cut for that.
constexpr Index kMostInStretch = 262144;

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

// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/accelerations.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "checks.hpp"
#include "effort_fit.hpp"
#include "figures.hpp"
#include "filtering.hpp"
#include "spectrum.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Columns = Eigen::Ref<MatrixXd>;
using ConstColumns = Eigen::Ref<const MatrixXd>;
using ConstVector = Eigen::Ref<const Eigen::VectorXd>;

// ---------------------------------------------------------------------------------------------
// Filter

// y_k = b0 x_k + b1 x_(k-1) + b2 x_(k-2) - a1 y_(k-1) - a2 y_(k-2), with a gain of one at 0 Hz
struct Section {
  double b0, b1, b2, a1, a2;
};

// Pairs of complex poles as sections of second order, the real pole of an odd order as a first one.
// Analog poles lie on a circle of radius w_c; the bilinear transformation s = (z - 1) / (z + 1)
// with w_c = tan(pi f_c / f_s) takes them to the digital filter.
std::vector<Section> butterworth(int order, double cutoff_over_sampling) {
  const double w = std::tan(M_PI * cutoff_over_sampling);
  std::vector<Section> sections;
  for (int i = 0; i < order / 2; ++i) {
    // s^2 + 2 cos(theta) w s + w^2, theta the angle of the pole to the negative real axis
    const double theta = M_PI * (order - 1 - 2 * i) / (2.0 * order);
    const double damping = 2.0 * std::cos(theta) * w;
    const double a0 = 1.0 + damping + w * w;
    const double b = w * w / a0;
    sections.push_back({b, 2.0 * b, b, 2.0 * (w * w - 1.0) / a0, (1.0 - damping + w * w) / a0});
  }
  if (order % 2 == 1) {
    const double b = w / (1.0 + w);
    sections.push_back({b, b, 0.0, (w - 1.0) / (w + 1.0), 0.0});
  }
  return sections;
}

// Filters columns in place, from `first` on by steps of 1 or -1, in transposed direct form II; starts
// in the steady state of the first one.
void filter(const Section& section, Columns& columns, Index first, Index step) {
  Eigen::ArrayXd one = (1.0 - section.b0) * columns.col(first).array();
  Eigen::ArrayXd two = (section.b2 - section.a2) * columns.col(first).array();
  for (Index k = first; k >= 0 && k < columns.cols(); k += step) {
    double* const column = columns.col(k).data();
    for (Index j = 0; j < one.size(); ++j) {
      const double x = column[j];
      const double y = section.b0 * x + one[j];
      one[j] = section.b1 * x - section.a1 * y + two[j];
      two[j] = section.b2 * x - section.a2 * y;
      column[j] = y;
    }
  }
}

// Fills the first and the last `count` columns with point reflections, 2 x_0 - x_k, of the others.
void mirrorEnds(Columns samples, Index count) {
  const Index last = samples.cols() - 1 - count;
  for (Index k = 1; k <= count; ++k) {
    samples.col(count - k) = 2.0 * samples.col(count) - samples.col(count + k);
    samples.col(last + k) = 2.0 * samples.col(last) - samples.col(last - k);
  }
}

// Samples that a filter of this order needs, as each end is continued.
constexpr Index leastSamples(int order) { return 3 * (order + 1) + 1; }

void requireFilter(double sampling_frequency, double cutoff, int order) {
  constexpr int kGreatestOrder = 12;
  const auto number = [](double x) { return formatted("%g", x); };
  if (!(sampling_frequency > 0) || !std::isfinite(sampling_frequency)) {
    throw EvaluationError("low-pass", "sampling frequency", "a positive number of Hz",
                          number(sampling_frequency), "give samples per second");
  }
  if (!(cutoff > 0) || !(cutoff < sampling_frequency / 2)) {
    throw EvaluationError(
        "low-pass", "cut-off",
        "above 0 and below half the sampling frequency, " + number(sampling_frequency / 2) + " Hz",
        number(cutoff) + " Hz", "lower it, or don't filter");
  }
  if (order < 1 || order > kGreatestOrder) {
    throw EvaluationError("low-pass", "order", "1 to " + std::to_string(kGreatestOrder),
                          std::to_string(order), "2 is usual");
  }
}

// Forwards, then backwards, each row; starts in the steady state of the first value at either end.
void zeroPhase(Columns samples, double cutoff_over_sampling, int order) {
  const std::vector<Section> sections = butterworth(order, cutoff_over_sampling);
  for (const Section& section : sections) filter(section, samples, 0, 1);
  for (const Section& section : sections) filter(section, samples, samples.cols() - 1, -1);
}

}  // namespace

double lowPassGain(double frequency, double cutoff, double sampling_frequency, int order) {
  if (frequency >= sampling_frequency / 2) return 0.0;
  const double ratio = std::tan(M_PI * frequency / sampling_frequency) /
                       std::tan(M_PI * cutoff / sampling_frequency);
  return 1.0 / (1.0 + std::pow(ratio * ratio, order));
}

Index defaultPadding(Index samples, double sampling_frequency, double cutoff, int order) {
  const double periods = std::ceil(1.5 * sampling_frequency / cutoff);
  const auto least = static_cast<double>(3 * (order + 1));
  const auto available = static_cast<double>(samples - 1);
  return static_cast<Index>(std::min(std::max(periods, least), available));
}

OwnedMatrix lowPass(const ConstColumns& samples, double sampling_frequency, double cutoff,
                    int order, Index padding) {
  requireFilter(sampling_frequency, cutoff, order);
  requireSamples("low-pass", "samples", samples, leastSamples(order));
  requireFinite("low-pass", "samples", samples);
  const Index count = samples.cols();
  if (padding >= count) {
    throw EvaluationError("low-pass", "padding", "fewer than " + std::to_string(count) + " samples",
                          std::to_string(padding), "leave it out");
  }
  const Index pad =
      padding < 0 ? defaultPadding(count, sampling_frequency, cutoff, order) : padding;

  MatrixXd extended(samples.rows(), count + 2 * pad);
  extended.middleCols(pad, count) = samples;
  mirrorEnds(extended, pad);
  zeroPhase(extended, cutoff / sampling_frequency, order);
  return extended.middleCols(pad, count);
}

// ---------------------------------------------------------------------------------------------
// Derivative of equidistant samples

namespace {

constexpr Index kCoefficients = 4;  // of a cubic
constexpr Index kLeastFit = 6;  // samples that an end's cubic is fitted to, if there are as many

// Powers of the instants, in units of the fitted length; one row per instant.
MatrixXd powers(const Eigen::ArrayXd& instants) {
  MatrixXd result(instants.size(), kCoefficients);
  for (Index p = 0; p < kCoefficients; ++p) {
    result.col(p) = instants.pow(static_cast<double>(p)).matrix();
  }
  return result;
}

// The `count` samples beyond the first one, the nearest first, by the cubic that fits best there.
//
// The point reflection of lowPass() keeps value and slope, but the noise of the last sample becomes a
// step of twice its size, and the curvature changes its sign. A cubic averages the noise and goes on
// with slope and curvature. Weights fall from one at the first sample to zero behind the last (cos^2
// of the amplitude). docs/accuracy.md has the errors at the ends.
MatrixXd beyondEnd(const ConstColumns& samples, Index count) {
  const Index fit = samples.cols();
  const auto length = static_cast<double>(fit);
  const Eigen::ArrayXd inside = Eigen::ArrayXd::LinSpaced(fit, 0.0, (length - 1.0) / length);
  const Eigen::ArrayXd outside =
      Eigen::ArrayXd::LinSpaced(count, -1.0 / length, -static_cast<double>(count) / length);
  const Eigen::VectorXd weight = (M_PI / 2.0 * inside).cos().square().square().matrix();
  const MatrixXd weighted = weight.asDiagonal() * powers(inside);
  const Eigen::Matrix4d normal = weighted.transpose() * powers(inside);
  const Eigen::Matrix<double, kCoefficients, Eigen::Dynamic> coefficients =
      Eigen::LDLT<Eigen::Matrix4d>(normal).solve(weighted.transpose() * samples.transpose());
  return (powers(outside) * coefficients).transpose();
}

}  // namespace

DerivativeRoom::DerivativeRoom(Index samples, double frequency, double cutoff_frequency,
                               int filter_order)
    : count(samples), sampling_frequency(frequency), cutoff(cutoff_frequency), order(filter_order) {
  constexpr double kFitPeriods = 1.2;     // of the cut-off, to which the ends' cubics are fitted
  constexpr double kBeyondPeriods = 2.0;  // of the cut-off, by which they continue the ends
  const double period = sampling_frequency / cutoff;
  const auto all = static_cast<double>(count);
  fit =
      std::min(std::max(static_cast<Index>(std::min(kFitPeriods * period, all)), kLeastFit), count);
  // not further than the cubic may be trusted: as far as the samples that it is fitted to
  beyond = std::max<Index>(
      static_cast<Index>(std::min(kBeyondPeriods * period, kBeyondPeriods / kFitPeriods * all)),
      3 * (Index{order} + 1));
  mirror = defaultPadding(count + 2 * beyond, sampling_frequency, cutoff, order);
}

Columns DerivativeRoom::differentiate(Columns room) const {
  const Index first = begin();
  room.middleCols(mirror, beyond) =
      beyondEnd(room.middleCols(first, fit), beyond).rowwise().reverse();
  // the end, with time counted backwards, is a beginning
  room.middleCols(first + count, beyond) =
      beyondEnd(room.middleCols(first + count - fit, fit).rowwise().reverse(), beyond);
  mirrorEnds(room, mirror);
  zeroPhase(room, cutoff / sampling_frequency, order);
  // central differences; each takes the place of the sample two before, which no later one needs
  const double factor = sampling_frequency / 12.0;
  for (Index k = first; k < first + count; ++k) {
    room.col(k - 2) =
        factor * (8.0 * (room.col(k + 1) - room.col(k - 1)) - (room.col(k + 2) - room.col(k - 2)));
  }
  return room.middleCols(first - 2, count);
}

// ---------------------------------------------------------------------------------------------
// Accelerations of a table

namespace {

// Equidistant samples whose spectra are computed at once: longer pieces are cut for that.
constexpr Index kMostInStretch = 262144;

// How many times longer the longest piece is than a short one.
constexpr Index kShortest = 8;

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
    for (Index k = 0; k < 4; ++k) weights[i] *= i == k ? 1.0 : (t - at[k]) / (at[i] - at[k]);
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
// two of these are so close, or so far apart, that a cubic would enlarge their noise. Across a gap,
// the outer two of the four are as far from it as it is long, so that noise isn't enlarged.
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
    taken_ = samples_;
    if (apart.minCoeff() >= kLeastApart && apart.maxCoeff() <= kMostApart) {
      weights_ = cubicWeights(instants_, t);
    } else if (apart[1] > kMostApart && t > instants_[1] && t < instants_[2] && widen()) {
      weights_ = cubicWeights(
          {table_.instant[taken_[0]], instants_[1], instants_[2], table_.instant[taken_[3]]}, t);
    } else {
      weights_ = linearWeights(instants_, t);
    }
  }

  // The value there of columns of the table.
  auto valueOf(const SampleTable::JointColumns& columns) const {
    return weights_[0] * columns.col(taken_[0]) + weights_[1] * columns.col(taken_[1]) +
           weights_[2] * columns.col(taken_[2]) + weights_[3] * columns.col(taken_[3]);
  }

 private:
  // Takes the outer two as far from the middle two as these are apart; not if the piece ends before.
  bool widen() {
    const double length = instants_[2] - instants_[1];
    const auto beyond = [&](Index k, double from) {
      return table_.used[k] && std::abs(table_.instant[k] - from) >= length;
    };
    while (taken_[0] >= grid_.first && !beyond(taken_[0], instants_[1])) --taken_[0];
    while (taken_[3] < grid_.behind && !beyond(taken_[3], instants_[2])) ++taken_[3];
    const bool found = taken_[0] >= grid_.first && taken_[3] < grid_.behind;
    if (!found) taken_ = samples_;
    return found;
  }

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
  std::array<Index, 4> taken_{};        // those that are weighed
  Eigen::Vector4d instants_, weights_;  // s; of them
};

std::vector<Grid> gridsOf(const SampleReport& found, const SampleRules& rules) {
  if (found.pieces.empty()) {
    const SampleCounts& counts = found.counts;
    throw EvaluationError(
        "low-pass accelerations", "samples",
        std::to_string(rules.shortest_piece) + " or more that differ, without a gap",
        std::to_string(counts.all - counts.repeated) + " with gaps of more than " +
            std::to_string(rules.longest_gap) + " s between them",
        "record for longer, or take backward differences");
  }
  std::vector<Grid> grids;
  grids.reserve(found.pieces.size());
  for (const Piece& piece : found.pieces) grids.emplace_back(piece, found.usual_period);
  return grids;
}

Index longestOf(const std::vector<Grid>& grids) {
  return std::max_element(grids.begin(), grids.end(),
                          [](const Grid& a, const Grid& b) { return a.count < b.count; })
      ->count;
}

// Mean frequency of the equidistant samples of all pieces [Hz].
double samplingFrequency(const std::vector<Grid>& grids) {
  double intervals = 0.0;
  double duration = 0.0;
  for (const Grid& grid : grids) {
    intervals += static_cast<double>(grid.count - 1);
    duration += static_cast<double>(grid.count - 1) * grid.period;
  }
  return intervals / duration;
}

// Spectra of the pieces that have at least so many equidistant samples.
VelocitySpectra spectraOf(const SampleTable& table, const std::vector<Grid>& grids, Index shortest,
                          double sampling_frequency) {
  const Index joints = table.q.rows();
  SpectrumSums sums(joints, std::min(longestOf(grids), kMostInStretch), sampling_frequency);
  Stretch stretch;
  for (const Grid& grid : grids) {
    if (grid.count < shortest) continue;
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
  return sums.spectra();
}

// The cut-off that suits the equidistant samples.
//
// A short piece smears its motion over higher frequencies, where the long ones have noise alone: it is
// left out, unless it has more samples than the long ones have in motion.
CutoffChoice choiceOf(const SampleTable& table, const std::vector<Grid>& grids,
                      double sampling_frequency, int order) {
  const Index longest = longestOf(grids);
  requireLongEnough(longest);
  const Index shortest = longest / kShortest;
  double kept = 0, left_out = 0;  // samples
  for (const Grid& grid : grids) {
    (grid.count < shortest ? left_out : kept) += static_cast<double>(grid.count);
  }
  VelocitySpectra spectra = spectraOf(table, grids, shortest, sampling_frequency);
  if (spectra.moving * kept < left_out) spectra = spectraOf(table, grids, 0, sampling_frequency);
  return cutoffOf(spectra, static_cast<double>(longest - 1) / sampling_frequency,
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
    for (; next_ < table_.size(); ++next_) table_.qdd.col(next_) = last_;
  }

 private:
  SampleTable& table_;
  Index next_ = 0;        // sample
  Eigen::VectorXd last_;  // acceleration of the last piece's end
  double end_ = 0;        // s; of it
};

// Of the method that is taken.
void backwardDifferences(const ConstVector& time, const ConstColumns& qd, Columns qdd) {
  for (Index k = 0; k < qd.cols(); ++k) {
    const double dt = k > 0 ? time[k] - time[k - 1] : 0.0;
    if (dt > 0.0) {
      qdd.col(k) = (qd.col(k) - qd.col(k - 1)) / dt;
    } else {
      qdd.col(k).setZero();
    }
  }
}

// Accelerations of the pieces' samples.
void differentiate(SampleTable& table, const std::vector<Grid>& grids, double cutoff, int order) {
  for (const Grid& grid : grids) {
    requireFilter(1.0 / grid.period, cutoff, order);
  }
  Interpolation interpolation(table);
  for (const Grid& grid : grids) {
    const DerivativeRoom room(grid.count, 1.0 / grid.period, cutoff, order);
    auto columns = table.scratch(table.q.rows(), room.size());
    Resampler resampler(table, grid);
    for (Index i = 0; i < grid.count; ++i) {
      resampler.next();
      columns.col(room.begin() + i) = resampler.valueOf(table.qd);
    }
    interpolation.add(grid, room.differentiate(columns));
  }
  interpolation.finish();
}

// The choice, with the cut-off that lets a robot's torques explain the efforts best.
CutoffChoice choiceByEfforts(SampleTable& table, const std::vector<Grid>& grids,
                             const LowPassOptions& options, const CutoffChoice& motion) {
  const auto choose = [&](SampleTable& samples, const std::vector<Grid>& pieces) {
    return EffortFit(samples, *options.solver).choose(motion, [&](double cutoff) {
      differentiate(samples, pieces, cutoff, options.order);
    });
  };
  const std::unique_ptr<SampleTable> excerpt = excerptOf(table);
  if (excerpt == nullptr) return choose(table, grids);
  const SampleReport found = examineSamples(*excerpt, options.rules);
  return found.pieces.empty() ? motion : choose(*excerpt, gridsOf(found, options.rules));
}

FilterChoice filterOf(SampleTable& table, const SampleReport& found,
                      const LowPassOptions& options) {
  const std::vector<Grid> grids = gridsOf(found, options.rules);
  FilterChoice filter;
  filter.method = "zero-phase Butterworth low-pass of the velocities, then central differences";
  filter.order = options.order;
  filter.sampling_frequency = samplingFrequency(grids);
  filter.time_base = found.time_base;
  filter.pieces = static_cast<Index>(grids.size());
  filter.cutoff = options.cutoff;
  filter.chosen = options.cutoff == 0;
  if (filter.chosen) {
    filter.choice = choiceOf(table, grids, filter.sampling_frequency, filter.order);
    if (options.solver != nullptr && table.effort.size() > 0) {
      filter.choice = choiceByEfforts(table, grids, options, filter.choice);
    }
    filter.cutoff = filter.choice.cutoff;
  }
  differentiate(table, grids, filter.cutoff, filter.order);
  return filter;
}

AccelerationMethod methodOf(AccelerationMethod asked, double cutoff, bool recorded) {
  if (asked == AccelerationMethod::kAuto) {
    return recorded && cutoff == 0 ? AccelerationMethod::kGiven : AccelerationMethod::kLowPass;
  }
  if (asked == AccelerationMethod::kGiven && !recorded) {
    throw EvaluationError(
        "accelerations: the recording gives none; expected another method, such as auto");
  }
  return asked;
}

}  // namespace

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

AccelerationReport findAccelerations(SampleTable& table, AccelerationMethod method,
                                     LowPassOptions options) {
  checkCutoff(method, options.cutoff);
  AccelerationReport result;
  result.method = methodOf(method, options.cutoff, table.has_accelerations);
  const bool filtered = result.method == AccelerationMethod::kLowPass;
  // every piece must be long enough for the filter; without a filter none is too short
  options.rules.shortest_piece =
      filtered ? std::max(options.rules.shortest_piece, leastSamples(options.order)) : 1;
  result.samples = examineSamples(table, options.rules);
  if (filtered) {
    result.filter = filterOf(table, result.samples, options);
  } else if (result.method == AccelerationMethod::kBackwardDifference) {
    backwardDifferences(table.time, table.qd, table.qdd);
  }
  result.summary = accelerationSummary(result.method, result.filter.cutoff, result.filter.chosen);
  result.findings =
      sampleFindings(name(table.clock()), result.samples, filtered ? &result.filter : nullptr);
  return result;
}

OwnedMatrix backwardDifference(const ConstVector& time, const ConstColumns& qd) {
  requireSamples("backward difference", "qd", qd, 1);
  requireStampPerSample("backward difference", time, qd);
  requireFiniteStamps("backward difference", time);
  requireFinite("backward difference", "qd", qd);
  OwnedMatrix qdd(qd.rows(), qd.cols());
  backwardDifferences(time, qd, qdd);
  return qdd;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

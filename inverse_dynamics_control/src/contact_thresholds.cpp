// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/contact_thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <random>
#include <utility>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

using Index = Eigen::Index;
using Series = Eigen::VectorXd;

constexpr double kMostPeaks = 100.0;
constexpr double kLeastPeaks = 20.0;
constexpr double kPeakShare = 0.2;  // of the independent samples
constexpr double kApart = 3.0;      // correlation times between two peaks
constexpr double kMostShape = 0.5;
constexpr double kHour = 3600.0;       // s
constexpr double kLeastAlarms = 1e-6;  // per hour: one in a century
constexpr std::size_t kDraws = 400;    // of the bootstrap

[[noreturn]] void refuse(const std::string& joint, const std::string& what,
                         const std::string& expected, const std::string& got,
                         const std::string& remedy) {
  throw inverse_dynamics_solver::InvalidParameterValueException(inverse_dynamics_solver::errorText(
      "contact thresholds: joint " + joint, what, expected, got, remedy));
}

/// Samples after which the autocorrelation is below 1/e; half of all if it never is.
Index correlationLength(const Series& values) {
  const Series x = (values.array() - values.mean()).matrix();
  const Index count = x.size();
  const double variance = x.squaredNorm() / static_cast<double>(count);
  for (Index lag = 1; lag <= count / 2; lag += std::max<Index>(1, lag / 8)) {
    const double covariance =
        x.head(count - lag).dot(x.tail(count - lag)) / static_cast<double>(count - lag);
    if (covariance < variance / std::exp(1.0)) return lag;
  }
  return std::max<Index>(1, count / 2);
}

struct Peaks {
  double level = 0.0;
  std::vector<double> heights;  // above the level, ascending
};

/// Peaks above the level that so many samples exceed; peaks are more than `apart` samples apart.
Peaks peaksAbove(const Series& heights, Index exceeding, Index apart) {
  std::vector<double> sorted(heights.data(), heights.data() + heights.size());
  const auto at = sorted.end() - 1 - std::min(exceeding, heights.size() - 1);
  std::nth_element(sorted.begin(), at, sorted.end());
  Peaks peaks{*at, {}};
  Index last = -apart - 1;
  for (Index k = 0; k < heights.size(); ++k) {
    const double height = heights[k] - peaks.level;
    if (!(height > 0)) continue;
    if (k - last > apart) {
      peaks.heights.push_back(height);
    } else {
      peaks.heights.back() = std::max(peaks.heights.back(), height);
    }
    last = k;
  }
  std::sort(peaks.heights.begin(), peaks.heights.end());
  return peaks;
}

/// About as many peaks as wanted, or the most that there are, by the level.
Peaks highestPeaks(const Series& heights, double wanted, Index apart) {
  // From above: at low levels the peaks run into one another.
  Peaks most;
  const double half = 0.5 * static_cast<double>(heights.size());
  for (double exceeding = wanted; exceeding < half; exceeding *= 1.2) {
    Peaks peaks = peaksAbove(heights, static_cast<Index>(exceeding), apart);
    if (peaks.heights.size() > most.heights.size()) most = std::move(peaks);
    if (static_cast<double>(most.heights.size()) >= wanted) break;
  }
  return most;
}

struct Tail {
  double scale, shape;
};

/// Generalised Pareto distribution by its probability-weighted moments, its shape within bounds.
Tail tailOf(const std::vector<double>& ascending, double least_shape) {
  const std::size_t count = ascending.size();
  const auto most = static_cast<double>(count - 1);
  // With a_r the mean of (1 - F)^r x: a_0 and a_0 - 2 a_1. The latter in pairs, so that it is never
  // negative, and zero where all are equal.
  double mean = 0.0, spread = 0.0;
  for (const double height : ascending) mean += height / static_cast<double>(count);
  for (std::size_t i = 0; i < count / 2; ++i) {
    const double weight = (most - 2.0 * static_cast<double>(i)) / most / static_cast<double>(count);
    spread += weight * (ascending[count - 1 - i] - ascending[i]);
  }
  const double shape =
      spread > 0 ? std::clamp(2.0 - mean / spread, least_shape, kMostShape) : least_shape;
  return {mean * (1.0 - shape), shape};  // so that the mean is kept
}

/// Height that is exceeded `ratio` times less often than the level; ratio >= 1.
double heightOf(const Tail& tail, double ratio) {
  const double log_ratio = std::log(ratio);
  if (std::abs(tail.shape) < 1e-9) return tail.scale * log_ratio;
  return tail.scale * std::expm1(tail.shape * log_ratio) / tail.shape;
}

/// Where heightOf() lies, by peaks drawn from those found: with a confidence of 90 %. Below, the tail
/// may end, as Gaussian noise's seems to; above, it doesn't, as for the threshold itself.
std::pair<double, double> rangeOf(const std::vector<double>& heights, double ratio) {
  std::mt19937_64 random(1);  // the same range each time
  std::vector<double> drawn(heights.size()), low(kDraws), high(kDraws);
  for (std::size_t k = 0; k < kDraws; ++k) {
    for (double& peak : drawn) peak = heights[random() % heights.size()];
    std::sort(drawn.begin(), drawn.end());
    low[k] = heightOf(tailOf(drawn, -kMostShape), ratio);
    high[k] = heightOf(tailOf(drawn, 0.0), ratio);
  }
  std::sort(low.begin(), low.end());
  std::sort(high.begin(), high.end());
  return {low[kDraws / 20], high[kDraws - 1 - kDraws / 20]};
}

void requireAlarms(double per_hour) {
  requireNumber("contact thresholds: false_alarms_per_hour", per_hour, Range::kPositive, "1/h");
  if (per_hour >= kLeastAlarms) return;
  throw inverse_dynamics_solver::InvalidParameterValueException(inverse_dynamics_solver::errorText(
      "contact thresholds: false_alarms_per_hour", "wrong value",
      "a number of at least " + number(kLeastAlarms) + " (one in a century) [1/h]",
      number(per_hour), "state more"));
}

void requireSeries(const Eigen::Ref<const Eigen::MatrixXd>& quiet,
                   const std::vector<std::string>& joint_names) {
  for (Index j = 0; j < quiet.rows(); ++j) {
    const std::string& joint = joint_names[static_cast<std::size_t>(j)];
    if (!quiet.row(j).allFinite()) {
      refuse(joint, "wrong value", "finite external torques", "NaN or infinity",
             "leave out what an estimator gave without status kOk");
    }
    if (quiet.cols() < 2 || (quiet.row(j).array() == quiet(j, 0)).all()) {
      refuse(
          joint, "no noise", "external torques that vary", "the same in all samples",
          "make thresholds from estimates without a friction band, of a robot that is switched on");
    }
  }
}

/// Peaks of a joint; enough of them, and more than stated (per second).
Peaks requirePeaks(const Series& heights, Index correlation, double period, double stated,
                   Index joints, const std::string& joint) {
  const double duration = static_cast<double>(heights.size()) * period;
  const double time = static_cast<double>(correlation) * period;
  const double independent = duration / (2.0 * time);
  Peaks peaks = highestPeaks(heights, std::min(kMostPeaks, kPeakShare * independent),
                             static_cast<Index>(kApart * static_cast<double>(correlation)));
  const auto found = static_cast<double>(peaks.heights.size());
  if (found < kLeastPeaks) {
    refuse(joint, "too few independent samples",
           number(kLeastPeaks) + " peaks at least, about " +
               number(std::ceil(kLeastPeaks / kPeakShare * 4.0 * time)) +
               " s at this correlation time of " + number(time) + " s",
           number(found) + " in " + number(duration) + " s", "take a longer recording");
  }
  if (stated > found / duration) {
    const double per_hour = kHour * static_cast<double>(joints);
    refuse(joint, "too many false alarms",
           "at most " + number(std::floor(found / duration * per_hour)) +
               " per hour, which is as often as its torque shows a peak",
           number(stated * per_hour), "state fewer");
  }
  return peaks;
}

}  // namespace

ContactThresholds contactThresholds(const Eigen::Ref<const Eigen::MatrixXd>& quiet, double period,
                                    double false_alarms_per_hour,
                                    const std::vector<std::string>& joint_names) {
  const std::string name = "contact thresholds";
  const Index n = quiet.rows(), count = quiet.cols();
  requireJointNumbers(name + ": quiet", Series::Zero(n), Range::kAny, "N m", joint_names);
  requireNumber(name + ": period", period, Range::kPositive, "s");
  requireAlarms(false_alarms_per_hour);
  requireSeries(quiet, joint_names);

  ContactThresholds result;
  result.false_alarms_per_hour = false_alarms_per_hour;
  for (OwnedVector* vector :
       {&result.torques, &result.noise, &result.correlation_time, &result.independent,
        &result.peaks, &result.level, &result.scale, &result.shape, &result.low, &result.high}) {
    vector->setZero(n);
  }
  const double duration = static_cast<double>(count) * period;
  const double stated = false_alarms_per_hour / kHour / static_cast<double>(n);
  for (Index j = 0; j < n; ++j) {
    const Series values = quiet.row(j);
    const Index correlation = correlationLength(values);
    const Peaks peaks = requirePeaks(values.cwiseAbs(), correlation, period, stated, n,
                                     joint_names[static_cast<std::size_t>(j)]);
    const auto found = static_cast<double>(peaks.heights.size());
    const double ratio = found / duration / stated;
    const Tail tail = tailOf(peaks.heights, 0.0);
    const auto [low, high] = rangeOf(peaks.heights, ratio);
    result.torques[j] = peaks.level + heightOf(tail, ratio);
    result.noise[j] = std::sqrt(values.squaredNorm() / static_cast<double>(count));
    result.correlation_time[j] = static_cast<double>(correlation) * period;
    result.independent[j] = duration / (2.0 * result.correlation_time[j]);
    result.peaks[j] = found;
    result.level[j] = peaks.level;
    result.scale[j] = tail.scale;
    result.shape[j] = tail.shape;
    result.low[j] = peaks.level + low;
    result.high[j] = peaks.level + high;
  }
  return result;
}

}  // namespace v2
}  // namespace inverse_dynamics_control

// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/contact_thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <string>
#include <utility>
#include <vector>

#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

using Index = Eigen::Index;
using Series = Eigen::VectorXd;

constexpr double kMostPeaks = 100.0;   // more of them tell of lower torques than the tail's
constexpr double kFewPeaks = 20.0;     // wanted where the level of fewer is the tail's
constexpr double kPeakShare = 0.2;     // of the independent samples: above it peaks run together
constexpr double kHour = 3600.0;       // s
constexpr double kLeastAlarms = 1e-6;  // per hour: one in a century

[[noreturn]] void refuse(const std::string& joint, const std::string& what,
                         const std::string& expected, const std::string& got,
                         const std::string& remedy) {
  throw inverse_dynamics_solver::InvalidParameterValueException(
      "contact thresholds: joint " + joint, what, expected, got, remedy);
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
  std::vector<double> heights;  // above the level
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
  return peaks;
}

/// About as many peaks as wanted, or the most that there are, by the level.
Peaks highestPeaks(const Series& heights, double wanted, Index apart) {
  // From above: at low levels the peaks run into one another.
  Peaks most;
  const double half = 0.5 * static_cast<double>(heights.size());
  for (double exceeding = std::min(wanted, 0.5 * half); exceeding < half; exceeding *= 1.2) {
    Peaks peaks = peaksAbove(heights, static_cast<Index>(exceeding), apart);
    if (peaks.heights.size() > most.heights.size()) most = std::move(peaks);
    if (static_cast<double>(most.heights.size()) >= wanted) break;
  }
  return most;
}

struct Tail {
  double scale, shape;
};

/// Generalised Pareto distribution that predicts the next peaks; see the head of contact_thresholds.hpp.
Tail tailOf(const std::vector<double>& heights) {
  const Eigen::Map<const Series> x(heights.data(), static_cast<Index>(heights.size()));
  const auto count = static_cast<double>(x.size());
  const double mean = x.mean(), variance = (x.array() - mean).square().sum() / (count - 1.0);
  // moments; what the shape has beyond its standard error
  const double heavy = std::max(0.0, 0.5 * (1.0 - mean * mean / variance) - 1.0 / std::sqrt(count));
  return {mean * (1.0 - heavy), std::max(heavy, 1.0 / count)};
}

void requireAlarms(double per_hour) {
  requireNumber("contact thresholds: false_alarms_per_hour", per_hour, Range::kPositive, "1/h");
  if (per_hour >= kLeastAlarms) return;
  throw inverse_dynamics_solver::InvalidParameterValueException(
      "contact thresholds: false_alarms_per_hour", "wrong value",
      "a number of at least " + numberText(kLeastAlarms) + " (one in a century) [1/h]",
      numberText(per_hour), "state more");
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

/// Peaks of a joint; more than stated (per second).
Peaks requirePeaks(const Series& heights, Index correlation, double period, double stated,
                   Index joints, const std::string& joint) {
  const double duration = static_cast<double>(heights.size()) * period;
  const Index apart = heights.size() / correlation;
  const double independent = 0.5 * static_cast<double>(apart);
  const double wanted = std::clamp(kPeakShare * independent, kFewPeaks, kMostPeaks);
  Peaks peaks = highestPeaks(heights, wanted, correlation);
  const auto found = static_cast<double>(peaks.heights.size());
  if (stated > found / duration) {
    const double per_hour = kHour * static_cast<double>(joints);
    const double most = std::floor(found / duration * per_hour);
    if (most < 1.0) {
      refuse(joint, "too few samples", "a part without contact that shows a peak of its torque",
             numberText(static_cast<double>(heights.size())), "take a longer part");
    }
    refuse(
        joint, "too many false alarms",
        "at most " + numberText(most) + " per hour, which is as often as its torque shows a peak",
        numberText(stated * per_hour), "state fewer");
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
  for (OwnedVector* vector : {&result.torques, &result.noise, &result.correlation_time,
                              &result.peaks, &result.level, &result.scale, &result.shape}) {
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
    const Tail tail = tailOf(peaks.heights);
    // exceeded as often as stated
    const double excess = std::expm1(tail.shape * std::log(found / duration / stated)) / tail.shape;
    result.torques[j] = peaks.level + tail.scale * excess;
    result.noise[j] = std::sqrt(values.squaredNorm() / static_cast<double>(count));
    result.correlation_time[j] = static_cast<double>(correlation) * period;
    result.peaks[j] = found;
    result.level[j] = peaks.level;
    result.scale[j] = tail.scale;
    result.shape[j] = tail.shape;
  }
  return result;
}

}  // namespace v2
}  // namespace inverse_dynamics_control

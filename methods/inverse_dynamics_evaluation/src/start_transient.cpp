// SPDX-License-Identifier: Apache-2.0

#include "start_transient.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;

constexpr double kTransientQuantile = 0.9;  // of the roughness of the efforts,
constexpr double kTransientFactor = 5.0;    // and how far a transient exceeds it
constexpr Index kLeastForTransient = 50;    // samples without which that quantile says nothing

// A quantile of numbers; `share` is 0.5 for the median.
double quantile(std::vector<double> values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

// Second difference of three samples, as if they lay `period` apart: a sample that was missed
// beside them makes none of it. (Distances far below the period are those of stamps that jitter.)
double secondDifference(const Eigen::Vector3d& value, double before, double after, double period) {
  const double h1 = std::max(before / period, 0.5);
  const double h2 = std::max(after / period, 0.5);
  return 2.0 * ((value[2] - value[1]) / h2 - (value[1] - value[0]) / h1) / (h1 + h2);
}

// Roughness of the efforts about each inner one of the samples: second differences in units of each
// joint's median, root mean square over the joints that change.
std::vector<double> roughness(const ConstMatrix& effort, const Eigen::VectorXd& instant,
                              double period) {
  const Index inner = instant.size() - 2;
  std::vector<double> sum(static_cast<std::size_t>(inner), 0.0);
  double joints = 0.0;
  std::vector<double> second(sum.size());
  for (Index j = 0; j < effort.rows(); ++j) {
    for (Index i = 0; i < inner; ++i) {
      second[static_cast<std::size_t>(i)] = std::abs(
          secondDifference(effort.row(j).segment<3>(i).transpose(), instant[i + 1] - instant[i],
                           instant[i + 2] - instant[i + 1], period));
    }
    const double scale = quantile(second, 0.5);
    if (scale > 0) {
      joints += 1.0;
      for (std::size_t i = 0; i < second.size(); ++i) sum[i] += std::pow(second[i] / scale, 2);
    }
  }
  for (double& value : sum) value = joints > 0 ? std::sqrt(value / joints) : 0.0;
  return sum;
}

}  // namespace

Index startTransient(const ConstMatrix& effort, const Eigen::VectorXd& instant, double period,
                     double window) {
  if (instant.size() < kLeastForTransient) return 0;
  const std::vector<double> rough = roughness(effort, instant, period);
  const double limit = kTransientFactor * quantile(rough, kTransientQuantile);
  Index end = 0;
  for (Index i = 1; i + 1 < instant.size() && instant[i] - instant[0] <= window; ++i) {
    if (rough[static_cast<std::size_t>(i - 1)] > limit) {
      end = i + 1;  // the sample in the middle of the three
    }
  }
  return end;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

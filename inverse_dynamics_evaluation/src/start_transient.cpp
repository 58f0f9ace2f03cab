// SPDX-License-Identifier: Apache-2.0

#include "start_transient.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "quantile.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;
using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;

constexpr double kTransientQuantile = 0.9;  // of the roughness of the efforts,
constexpr double kTransientFactor = 5.0;    // and how far a transient exceeds it
constexpr Index kLeastForTransient = 50;    // samples without which that quantile says nothing

// Second difference of three samples, as if they lay `period` apart: a sample that was missed
// beside them makes none of it. (Distances far below the period are those of stamps that jitter.)
double secondDifference(const Eigen::Vector3d& value, double before, double after, double period) {
  const double h1 = std::max(before / period, 0.5);
  const double h2 = std::max(after / period, 0.5);
  return 2.0 * ((value[2] - value[1]) / h2 - (value[1] - value[0]) / h1) / (h1 + h2);
}

// Roughness of the efforts about each inner one of the samples: second differences in units of each
// joint's median, root mean square over the joints that change.
std::vector<double> roughness(const ConstMatrix& effort, const std::vector<Index>& sample,
                              const Eigen::VectorXd& time, double period) {
  const std::size_t inner = sample.size() - 2;
  std::vector<double> sum(inner, 0.0);
  double joints = 0.0;
  std::vector<double> second(inner);
  for (Index j = 0; j < effort.rows(); ++j) {
    for (std::size_t i = 0; i < inner; ++i) {
      const Index a = sample[i];
      const Index b = sample[i + 1];
      const Index c = sample[i + 2];
      second[i] = std::abs(secondDifference({effort(j, a), effort(j, b), effort(j, c)},
                                            time[b] - time[a], time[c] - time[b], period));
    }
    const double scale = quantile(second, 0.5);
    if (scale > 0) {
      joints += 1.0;
      for (std::size_t i = 0; i < inner; ++i) {
        sum[i] += std::pow(second[i] / scale, 2);
      }
    }
  }
  for (double& value : sum) {
    value = joints > 0 ? std::sqrt(value / joints) : 0.0;
  }
  return sum;
}

}  // namespace

Mask startTransient(const ConstMatrix& effort, const std::vector<Index>& sample,
                    const Eigen::VectorXd& time, double period, double window) {
  Mask transient = Mask::Constant(time.size(), false);
  if (effort.size() == 0 || static_cast<Index>(sample.size()) < kLeastForTransient) {
    return transient;
  }
  const std::vector<double> rough = roughness(effort, sample, time, period);
  const double limit = kTransientFactor * quantile(rough, kTransientQuantile);
  Index end = 0;
  for (std::size_t i = 0; i < rough.size() && time[sample[i + 1]] - time[0] <= window; ++i) {
    if (rough[i] > limit) {
      end = sample[i + 1] + 1;  // the sample in the middle of the three
    }
  }
  transient.head(end).setConstant(true);
  return transient;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

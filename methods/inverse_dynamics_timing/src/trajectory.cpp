// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_timing/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <iomanip>
#include <sstream>
#include <utility>

namespace inverse_dynamics_timing {
inline namespace v2 {

using Eigen::Index;
using Eigen::VectorXd;

Trajectory::Trajectory(Path path, const Eigen::Ref<const VectorXd>& s,
                       const Eigen::Ref<const VectorXd>& speed)
    : path_(std::move(path)), time_(s.size()), s_(s), speed_(speed) {
  time_[0] = 0.0;
  for (Index k = 0; k + 1 < s.size(); ++k) {
    const double way = s[k + 1] - s[k];
    time_[k + 1] = time_[k] + (way > 0.0 ? 2 * way / (speed[k] + speed[k + 1]) : 0.0);
  }
}

void Trajectory::evaluate(double t, Eigen::Ref<VectorXd> q, Eigen::Ref<VectorXd> qd,
                          Eigen::Ref<VectorXd> qdd) const {
  const double* const begin = time_.data();
  const Index last = time_.size() - 1;
  const Index k =
      std::clamp<Index>(std::upper_bound(begin, begin + last, t) - begin - 1, 0, last - 1);
  t = std::clamp(t, 0.0, time_[last]) - time_[k];
  const double interval = time_[k + 1] - time_[k];
  const double u = interval > 0.0 ? (speed_[k + 1] - speed_[k]) / interval : 0.0;
  const double speed = speed_[k] + u * t;
  const double s = std::min(s_[k] + (speed_[k] + speed) / 2 * t, s_[k + 1]);
  path_->evaluate(s, q, qd, qdd, s == s_[k + 1]);
  qdd = qdd * (speed * speed) + qd * u;
  qd *= speed;
}

chain_dynamics::OwnedVector sampleTimes(double duration, double rate) {
  constexpr double kMost = 1e6;
  const auto number = [](double value) {
    std::ostringstream digits;
    digits << std::setprecision(3) << value;
    return digits.str();
  };
  if (duration * rate > kMost) {
    throw inverse_dynamics_solver::InvalidParameterValueException(
        "rate", "",
        "at most " + number(kMost / duration) + " Hz for a motion of " + number(duration) +
            " s, a million samples",
        number(rate), "lower it, or raise the limits that make the motion so long");
  }
  const auto steps = std::max<Index>(static_cast<Index>(std::ceil(duration * rate - 0.5)), 1);
  chain_dynamics::OwnedVector times(steps + 1);
  for (Index k = 0; k < steps; ++k) times[k] = static_cast<double>(k) / rate;
  times[steps] = duration;
  return times;
}

Trajectory slowed(const Trajectory& motion, double factor) {
  return {motion.path(), motion.s(), motion.speed() / factor};
}

}  // namespace v2
}  // namespace inverse_dynamics_timing

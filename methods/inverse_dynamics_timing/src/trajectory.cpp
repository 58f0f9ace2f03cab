// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_timing/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace inverse_dynamics_timing {
inline namespace v2 {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// A part of a motion between two stops: points first to last of its grid.
struct Section {
  Index first, last;
};

std::vector<Section> sectionsOf(const Trajectory& motion) {
  std::vector<Section> sections{{0, 0}};
  for (Index k = 1; k < motion.s().size(); ++k) {
    if (motion.s()[k] == motion.s()[k - 1]) sections.push_back({k, k});
    sections.back().last = k;
  }
  return sections;
}

/// s at a time, from the section's start on; beyond its ends it stands still.
double positionAt(const Trajectory& motion, const Section& section, double t) {
  const auto& time = motion.time();
  t += time[section.first];
  if (t <= time[section.first]) return motion.s()[section.first];
  if (t >= time[section.last]) return motion.s()[section.last];
  const double* const begin = time.data();
  const Index k = std::upper_bound(begin + section.first, begin + section.last, t) - begin - 1;
  const double share = (t - time[k]) / (time[k + 1] - time[k]);
  const double speed = motion.speed()[k] + share * (motion.speed()[k + 1] - motion.speed()[k]);
  return motion.s()[k] + (motion.speed()[k] + speed) / 2 * (t - time[k]);
}

constexpr double kStep = 1e-3;  // s, of smoothed motions

/// The motion with its speed averaged over a span of time; stops stay stops.
Trajectory averaged(const Trajectory& motion, double span) {
  std::vector<double> s, speed;
  for (const Section& section : sectionsOf(motion)) {
    const double duration = motion.time()[section.last] - motion.time()[section.first] + span;
    // Steps of at least kStep, so that acceleration changes once within it.
    const auto steps = std::max<Index>(static_cast<Index>(duration / kStep), 4);
    const double step = duration / static_cast<double>(steps);
    const double from = motion.s()[section.first], to = motion.s()[section.last];
    const std::size_t begin = s.size();
    for (Index i = 0; i <= steps; ++i) {
      const double t = static_cast<double>(i) * step;
      const double v =
          i == 0 || i == steps
              ? 0.0
              : (positionAt(motion, section, t) - positionAt(motion, section, t - span)) / span;
      s.push_back(i == 0 ? from : s.back() + (speed.back() + v) / 2 * step);
      speed.push_back(v);
    }
    // Sums of trapezoids miss the end by little.
    const double scale = (to - from) / (s.back() - from);
    for (std::size_t i = begin; i < s.size(); ++i) s[i] = from + (s[i] - from) * scale;
    s.back() = to;
  }
  const auto count = static_cast<Index>(s.size());
  return {motion.path(), Eigen::Map<const VectorXd>(s.data(), count),
          Eigen::Map<const VectorXd>(speed.data(), count)};
}

/// The greatest acceleration and jerk of a joint, each over the joint's limit of jerk.
struct Peaks {
  double acceleration = 0.0;  // s
  double jerk = 0.0;
};

/// Joint accelerations of a motion in its intervals; it rests before the first and after the last.
class Accelerations {
 public:
  explicit Accelerations(const Trajectory& motion)
      : motion_(motion), q_(motion.path().jointCount()), dq_(q_), qdd_(q_) {}

  /// At a share of interval k: 0 is after its first point, 1 before its last one.
  const VectorXd& at(Index k, double share) {
    const auto &time = motion_.time(), &speed = motion_.speed();
    if (k < 0 || k + 1 >= time.size()) return qdd_.setZero();
    const double u = (speed[k + 1] - speed[k]) / (time[k + 1] - time[k]);
    const double dt = share * (time[k + 1] - time[k]), v = speed[k] + u * dt;
    const double s = share < 1.0 ? motion_.s()[k] + (speed[k] + v) / 2 * dt : motion_.s()[k + 1];
    motion_.path().evaluate(s, q_, dq_, qdd_, share == 1.0);
    return qdd_ = qdd_ * (v * v) + dq_ * u;
  }

 private:
  const Trajectory& motion_;
  VectorXd q_, dq_, qdd_;
};

/// Jerk is that over kStep, of a motion with intervals of kStep or little more. Between points of the
/// grid and knots of the path acceleration is about linear in time, so its greatest change over an
/// interval begins or ends at one of them.
Peaks peaksOf(const Trajectory& motion, const Eigen::Ref<const VectorXd>& limit) {
  constexpr int kBentParts = 8;  // of an interval with a knot
  const auto &time = motion.time(), &s = motion.s(), &knots = motion.path().knots();
  Accelerations accelerations(motion);
  VectorXd begin = VectorXd::Zero(limit.size()), end = begin, change = begin;
  Peaks most;
  const auto raise = [&limit](double& peak, const VectorXd& values, double share) {
    peak = std::max(peak, share * (values.cwiseAbs().array() / limit.array()).maxCoeff());
  };
  Index knot = 0, before = -1;  // the interval before: not that of a stop
  bool bent = false;            // whether it has a knot
  for (Index k = 0; k < time.size(); ++k) {
    const bool last = k + 1 == time.size();
    if (!last && time[k + 1] == time[k]) continue;
    const double per_second = 1 / (last ? kStep : std::min(time[k + 1] - time[k], kStep));
    raise(most.jerk, change = accelerations.at(k, 0.0) - begin, per_second);
    raise(most.acceleration, begin += change, 1.0);
    raise(most.jerk, change = accelerations.at(k, 1.0) - end, per_second);
    raise(most.acceleration, end += change, 1.0);
    while (knot < knots.size() && knots[knot] <= s[k]) ++knot;
    const bool bends = !last && knots[knot] < s[k + 1];
    for (int part = 1; part < kBentParts && (bends || bent); ++part) {
      const double share = static_cast<double>(part) / kBentParts;
      change = -accelerations.at(before, share);
      raise(most.jerk, change += accelerations.at(k, share), per_second);
    }
    before = k, bent = bends;
  }
  return most;
}

}  // namespace

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
  const auto steps = std::max<Index>(static_cast<Index>(std::ceil(duration * rate - 0.5)), 1);
  chain_dynamics::OwnedVector times(steps + 1);
  for (Index k = 0; k < steps; ++k) times[k] = static_cast<double>(k) / rate;
  times[steps] = duration;
  return times;
}

double accelerationTime(const Trajectory& motion, const Eigen::Ref<const VectorXd>& jerk) {
  return peaksOf(motion, jerk).acceleration;
}

Trajectory smoothJerk(const Trajectory& motion, const Eigen::Ref<const VectorXd>& jerk) {
  // The longest span turns the greatest acceleration into its opposite.
  double too_short = 0.0, span = std::max(2 * accelerationTime(motion, jerk), 2 * kStep);
  for (int halving = 0; halving < 8; ++halving) {
    const double middle = (too_short + span) / 2;
    (peaksOf(averaged(motion, middle), jerk).jerk > 1.0 ? too_short : span) = middle;
  }
  // The other jerk is that of the path's bends, in proportion to the cube of speed.
  Trajectory smooth = averaged(motion, span);
  double factor = 1.0;
  for (double over = 0.0; (over = peaksOf(smooth, jerk).jerk) > 1.0;) {
    constexpr double kRounding = 1e-4;
    factor *= std::cbrt(over) + kRounding;
    smooth = averaged(slowed(motion, factor), factor * span);
  }
  return smooth;
}

Trajectory slowed(const Trajectory& motion, double factor) {
  return {motion.path(), motion.s(), motion.speed() / factor};
}

}  // namespace v2
}  // namespace inverse_dynamics_timing

// SPDX-License-Identifier: Apache-2.0
#include "smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <inverse_dynamics_solver/friction_memory.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <vector>

namespace inverse_dynamics_timing {

using inverse_dynamics_solver::InverseDynamicsSolver;

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
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
constexpr Index kShares = 8;    // of an interval near a knot

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

/// States of an averaged motion, one per column: at rest, at both ends of each interval, and at rest.
/// Between points of the grid and knots of the path accelerations are about linear in time, so the
/// greatest change over kStep begins or ends at one of them: near knots, intervals have more states.
struct States {
  std::vector<Index> intervals;  // those that take time
  std::vector<Index> first;      // of each: the number of its first state
  std::vector<bool> divided;     // of each: whether it has kShares + 1 states, and not two
  MatrixXd q, qd, qdd;

  explicit States(const Trajectory& motion);

  /// The number of the state at a part, 0 to kShares, of interval i; of -1 and of the last: at rest.
  Index at(Index i, Index part) const {
    if (i < 0) return 0;
    if (i == static_cast<Index>(intervals.size())) return q.cols() - 1;
    const auto here = static_cast<std::size_t>(i);
    return first[here] + (divided[here] ? part : part / kShares);
  }
};

States::States(const Trajectory& motion) {
  const auto &time = motion.time(), &s = motion.s(), &speed = motion.speed();
  const auto& knots = motion.path().knots();
  for (Index k = 0; k + 1 < time.size(); ++k) {
    if (time[k + 1] > time[k]) intervals.push_back(k);
  }
  divided.resize(intervals.size());
  Index knot = 0, count = 1;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    while (knots[knot] <= s[intervals[i]]) ++knot;
    if (knots[knot] >= s[intervals[i] + 1]) continue;
    const std::size_t last = std::min(i + 1, intervals.size() - 1);
    for (std::size_t near = i == 0 ? 0 : i - 1; near <= last; ++near) divided[near] = true;
  }
  for (const bool more : divided) first.push_back(count), count += more ? kShares + 1 : 2;

  const Index n = motion.path().jointCount();
  q.resize(n, count + 1), qd.resize(n, count + 1), qdd.resize(n, count + 1);
  for (const Index rest : {Index{0}, count}) {
    motion.path().evaluate(rest == 0 ? s[0] : s[s.size() - 1], q.col(rest), qd.col(rest),
                           qdd.col(rest));
    qd.col(rest).setZero(), qdd.col(rest).setZero();
  }
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const Index k = intervals[i], parts = divided[i] ? kShares : 1;
    const double u = (speed[k + 1] - speed[k]) / (time[k + 1] - time[k]);
    for (Index part = 0; part <= parts; ++part) {
      const Index to = first[i] + part;
      const double t =
          static_cast<double>(part) / static_cast<double>(parts) * (time[k + 1] - time[k]);
      const double v = speed[k] + u * t;
      const double place = part < parts ? s[k] + (speed[k] + v) / 2 * t : s[k + 1];
      motion.path().evaluate(place, q.col(to), qd.col(to), qdd.col(to), part == parts);
      qdd.col(to) = qdd.col(to) * (v * v) + qd.col(to) * u;
      qd.col(to) *= v;
    }
  }
}

}  // namespace

Change fastestChange(const InverseDynamicsSolver& solver, const Trajectory& motion,
                     const MotionLimits& limits) {
  const States states(motion);
  const Index n = states.q.rows(), jerks = limits.jerk.size(), rates = limits.torque_rate.size();
  MatrixXd values(jerks + 2 * rates, states.q.cols());  // over their limits
  if (jerks > 0) {
    values.topRows(n) = states.qdd.array().colwise() / limits.jerk.array();
  }
  if (rates > 0) {
    MatrixXd least(n, states.q.cols());
    solver.getTorquesBatch(states.q, states.qd, states.qdd, least);
    MatrixXd most = least;
    chain_dynamics::FrictionState friction = frictionState(solver);
    for (Index k = 0; k < least.cols(); ++k) {
      friction.move(states.q.col(k));
      friction.addRange(states.qd.col(k), least.col(k), most.col(k));
    }
    values.middleRows(jerks, n) = least.array().colwise() / limits.torque_rate.array();
    values.bottomRows(n) = most.array().colwise() / limits.torque_rate.array();
  }
  Change fastest;
  const auto count = static_cast<Index>(states.intervals.size());
  const auto divided = [&](Index i) {
    return i < 0 || i == count || states.divided[static_cast<std::size_t>(i)];
  };
  for (Index i = 0; i <= count; ++i) {
    const Index k = states.intervals[static_cast<std::size_t>(std::min(i, count - 1))];
    const Index l = states.intervals[static_cast<std::size_t>(std::max(i - 1, Index{0}))];
    const auto& time = motion.time();
    const double per_second = 1 / std::min({time[k + 1] - time[k], time[l + 1] - time[l], kStep});
    const Index step = divided(i - 1) && divided(i) ? 1 : kShares;
    for (Index part = 0; part <= kShares; part += step) {
      const auto before = values.col(states.at(i - 1, part)), here = values.col(states.at(i, part));
      Index row = 0;
      const double share = (here - before).cwiseAbs().maxCoeff(&row) * per_second;
      if (share > fastest.share)
        fastest = {share, motion.s()[k], row < jerks ? -1 : (row - jerks) % n};
    }
  }
  return fastest;
}

double accelerationTime(const Trajectory& motion, const VectorXd& jerk) {
  const States states(motion);
  return (states.qdd.array().abs().colwise() / jerk.array()).maxCoeff();
}

Trajectory smoothed(const InverseDynamicsSolver& solver, const Trajectory& motion,
                    const MotionLimits& limits, const VectorXd& jerk, double longest,
                    Change& fastest) {
  constexpr int kHalvings = 8;
  // The longest span turns the greatest acceleration into its opposite.
  double too_short = 0.0, span = std::max(2 * accelerationTime(motion, jerk), 2 * kStep);
  for (int halving = 0; halving < kHalvings; ++halving) {
    const double middle = (too_short + span) / 2;
    const bool fast = fastestChange(solver, averaged(motion, middle), limits).share > 1.0;
    (fast ? too_short : span) = middle;
  }
  // What is left is due to the path's bends, and falls with the cube of speed, or with less of it: of
  // torques, gravity and friction.
  Trajectory smooth = averaged(motion, span);
  fastest = fastestChange(solver, smooth, limits);
  double factor = 1.0;
  while (fastest.share > 1.0 && smooth.duration() <= longest) {
    constexpr double kRounding = 1e-4, kNoLess = 0.9;
    factor *= std::cbrt(fastest.share) + kRounding;
    smooth = averaged(slowed(motion, factor), factor * span);
    const double share = fastest.share;
    fastest = fastestChange(solver, smooth, limits);
    if (fastest.share - 1.0 > kNoLess * (share - 1.0)) break;
  }
  return smooth;
}

}  // namespace inverse_dynamics_timing

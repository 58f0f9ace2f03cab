// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_timing/retime.hpp"

#include <algorithm>
#include <chain_dynamics/owned.hpp>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <inverse_dynamics_solver/friction_memory.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "path_dynamics.hpp"
#include "phase_plane.hpp"
#include "smoothing.hpp"

namespace inverse_dynamics_timing {
inline namespace v2 {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kLeastOfPiece = 4;  // intervals of each polynomial piece
constexpr Index kLeastAtStop = 40;  // and of one that begins or ends at rest
constexpr double kBend = 0.05;      // of q' within an interval, relative
constexpr double kMostParts = 20;   // into which a bend divides an interval
constexpr double kBeside = 0.01;    // of an interval

/// The grid with intervals divided where the path bends, and with points on both sides of where a joint
/// turns back: friction steps there.
///
/// @param turns  path.turningPoints().
VectorXd dividedAtBends(const Path& path, const std::vector<double>& turns,
                        const std::vector<double>& grid) {
  const Index n = path.jointCount();
  VectorXd q(n), here(n), next(n), ddq(n);
  auto turn = std::upper_bound(turns.begin(), turns.end(), grid.front());
  std::vector<double> s{grid.front()};
  path.evaluate(grid.front(), q, next, ddq);
  for (std::size_t k = 0; k + 1 < grid.size(); ++k) {
    const double from = grid[k], length = grid[k + 1] - from;
    here = next;
    path.evaluate(grid[k + 1], q, next, ddq, k + 2 == grid.size());
    const double greatest = std::max(here.norm(), next.norm());
    const double bend = greatest > 0.0 ? (next - here).norm() / (kBend * greatest) : 0.0;
    const double parts = std::ceil(std::clamp(bend, 1.0, kMostParts)),
                 beside = kBeside * length / parts;
    const auto add = [&](double at) {
      if (at > s.back() + beside / 2 && at < grid[k + 1] - beside / 2) s.push_back(at);
    };
    for (double part = 1.0; part <= parts; ++part) {
      const double to = from + length * part / parts;
      for (; turn != turns.end() && *turn < to; ++turn) add(*turn - beside), add(*turn + beside);
      part < parts ? add(to) : s.push_back(grid[k + 1]);
    }
  }
  return Eigen::Map<const VectorXd>(s.data(), static_cast<Index>(s.size()));
}

/// Points of the pieces from knot `first` to knot `last`. Towards stops they lie quadratically
/// denser: there speed grows with the root of the way.
VectorXd gridOf(const Path& path, const std::vector<double>& turns, Index first, Index last,
                Index points) {
  std::vector<double> s{path.knots()[first]};
  const double whole = path.end() - path.start();
  for (Index k = first; k < last; ++k) {
    const double from = path.knots()[k], length = path.knots()[k + 1] - from;
    const bool starts = k == first, ends = k + 1 == last;
    const auto wanted =
        static_cast<Index>(std::lround(static_cast<double>(points) * length / whole));
    const Index count = std::max(wanted, starts || ends ? kLeastAtStop : kLeastOfPiece);
    for (Index i = 1; i <= count; ++i) {
      const double x = static_cast<double>(i) / static_cast<double>(count);
      double share = x;
      if (starts && ends) share = (1 - std::cos(M_PI * x)) / 2;
      if (starts && !ends) share = x * x;
      if (!starts && ends) share = 1 - (1 - x) * (1 - x);
      s.push_back(i == count ? path.knots()[k + 1] : from + share * length);
    }
  }
  return dividedAtBends(path, turns, s);
}

/// Numbers of the knots at which sections begin and end.
std::vector<Index> borders(const Path& path) {
  std::vector<Index> result{0};
  const double* const knots = path.knots().data();
  for (const double stop : path.stops()) {
    result.push_back(std::lower_bound(knots, knots + path.knots().size(), stop) - knots);
  }
  result.push_back(path.knots().size() - 1);
  return result;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kAllowed = 1e-3;   // above a limit between points, share of it
constexpr double kLongest = 600.0;  // s, of motions with limits of jerk or torque rate
constexpr int kRefinements = 10;
constexpr Index kMostFiner = 16;  // times as many points as before refinements
constexpr int kTries = 2;         // finer grids before a path is refused
constexpr Index kParts = 4;

/// The grid with intervals split within which limits are passed: friction, or how fast a joint may move
/// along the path, changes within them, as a joint turns back. Empty: none are.
VectorXd refined(const VectorXd& grid, const VectorXd& excess) {
  std::vector<double> s{grid[0]};
  for (Index k = 0; k + 1 < grid.size(); ++k) {
    for (Index i = 1; i < kParts && excess[k] > kAllowed; ++i) {
      s.push_back(grid[k] + (grid[k + 1] - grid[k]) * static_cast<double>(i) / kParts);
    }
    s.push_back(grid[k + 1]);
  }
  if (static_cast<Index>(s.size()) == grid.size()) return {};
  return Eigen::Map<const VectorXd>(s.data(), static_cast<Index>(s.size()));
}

/// Where along a motion a limit is passed furthest, and by which share of it.
double overload(const InverseDynamicsSolver& solver, const Trajectory& motion,
                const MotionLimits& limits, double margin, double& s) {
  constexpr Index kAtOnce = 500;  // points, which fit into a cache
  double worst = 0.0;
  const VectorXd grid = motion.s(), z = motion.speed().array().square();
  FrictionState friction = frictionState(solver);
  Index first = 0, at = 0;
  for (Index k = 1; k <= grid.size(); ++k) {
    const bool stops = k == grid.size() || grid[k] == grid[k - 1];
    if (!stops && k - first < kAtOnce) continue;
    const Index count = k - first + (stops ? 0 : 1);
    if (count > 1) {
      const double over = excess(solver, motion.path(), grid.segment(first, count),
                                 z.segment(first, count), limits, margin, true, friction)
                              .maxCoeff(&at);
      if (over > worst) worst = over, s = grid[first + at];
    }
    first = k;
  }
  return worst;
}

/// The motion with its changes in limits, and then as slow as torques demand; refused unless it takes less
/// than `most`, s.
Retimed withoutJumps(const InverseDynamicsSolver& solver, const Trajectory& motion,
                     const MotionLimits& limits, const VectorXd& jerk, double margin, double most) {
  constexpr double kSlower = 1.01, kLeastStep = 1.001, kSlowest = 4.0;
  const auto too_slow = [](const Trajectory& slow) {
    return Retimed{{}, {Refusal::Reason::kTooSlow, 0.0, -1, slow.duration()}};
  };
  if (motion.duration() > kLongest) return too_slow(motion);
  Change fastest;
  const Trajectory smooth = smoothed(solver, motion, limits, jerk, kLongest, fastest);
  if (smooth.duration() > kLongest) return too_slow(smooth);
  if (fastest.share > 1.0 && fastest.joint >= 0) {
    const double rate = fastest.share * limits.torque_rate[fastest.joint];
    return {{}, {Refusal::Reason::kRateTooLow, fastest.s, fastest.joint, rate}};
  }
  double s = 0.0, factor = 1.0, last = 0.0, last_over = 0.0;
  while (factor < kSlowest && factor * smooth.duration() < most) {
    Trajectory slower = slowed(smooth, factor);
    const double over = overload(solver, slower, limits, margin, s);
    if (over <= kAllowed) return {std::move(slower), {}};
    // The excess falls ever more slowly with the factor, so its secant doesn't lead too far.
    double next = factor * (last == 0.0 ? kSlower : kLeastStep);
    if (over < last_over) {
      next = std::max(next, factor + (over - kAllowed / 2) * (factor - last) / (last_over - over));
    }
    last = factor, last_over = over, factor = next;
  }
  return {{}, {Refusal::Reason::kNoWayOn, s, -1, 0.0}};
}

/// About the jerks that limits of jerk and of the torques' rates allow, n.
VectorXd typicalJerk(const InverseDynamicsSolver& solver, const Path& path,
                     const MotionLimits& limits) {
  constexpr double kMost = 1e9;  // rad/s^3
  constexpr int kPlaces = 20;
  const Index n = path.jointCount();
  VectorXd jerk = VectorXd::Constant(n, kMost), q(n), dq(n), ddq(n), inertia = VectorXd::Zero(n);
  if (limits.jerk.size() > 0) jerk = limits.jerk;
  if (limits.torque_rate.size() == 0) return jerk;
  for (int i = 0; i <= kPlaces; ++i) {
    path.evaluate(path.start() + (path.end() - path.start()) * i / kPlaces, q, dq, ddq);
    inertia = inertia.cwiseMax(solver.getInertiaMatrix(q).diagonal().cwiseAbs());
  }
  return jerk.cwiseMin((limits.torque_rate.array() / inertia.array()).matrix());
}

/// The fastest motion, whatever its jerk and torque rates.
Retimed withJumps(const InverseDynamicsSolver& solver, const Path& path, const MotionLimits& limits,
                  const RetimeOptions& options) {
  const std::vector<Index> knots = borders(path);
  const std::vector<double> turns = path.turningPoints();
  std::vector<double> s, speed;
  FrictionState before = frictionState(solver), after;  // a section
  for (std::size_t section = 0; section + 1 < knots.size(); ++section) {
    const bool first = section == 0, last = section + 2 == knots.size();
    const double start = first ? options.start_speed : 0.0, end = last ? options.end_speed : 0.0;
    VectorXd grid = gridOf(path, turns, knots[section], knots[section + 1], options.points);
    VectorXd finer, z;
    const Index most = kMostFiner * grid.size();
    for (int round = 0, refused = 0;; ++round) {
      const PathDynamics dynamics(solver, path, grid, limits, options.margin, before);
      PhasePlane plane(dynamics);
      if (plane.solve(start * start, end * end)) {
        z = plane.z();
        after = before;
        finer = refined(grid, excess(solver, path, grid, z, limits, options.margin, false, after));
        if (finer.size() == 0 || finer.size() > most || round == kRefinements) break;
      } else {
        // Intervals that are too coarse may leave no way where finer ones do.
        if (plane.refusal().reason != Refusal::Reason::kNoWayOn || refused++ == kTries) {
          return {{}, plane.refusal()};
        }
        finer = refined(grid, VectorXd::Ones(grid.size() - 1));
      }
      grid = finer;
    }
    before = after;
    s.insert(s.end(), grid.begin(), grid.end());
    for (const double squared : z) speed.push_back(std::sqrt(squared));
  }
  const auto count = static_cast<Index>(s.size());
  return {Trajectory(path, Eigen::Map<const VectorXd>(s.data(), count),
                     Eigen::Map<const VectorXd>(speed.data(), count)),
          {}};
}

/// The fastest of the motions without jumps whose accelerations, before they are averaged, the joints
/// reach within one time: the longer it is, the longer is the span of averaging.
Retimed fastestWithoutJumps(const InverseDynamicsSolver& solver, const Trajectory& fastest,
                            const MotionLimits& limits, const RetimeOptions& options) {
  constexpr double kWorse = 2.0, kSame = 1.001, kLeastStep = 1.1;
  constexpr int kHalvings = 30;
  if (fastestChange(solver, fastest, limits).share <= 1.0) return {fastest, {}};
  const VectorXd jerk = typicalJerk(solver, fastest.path(), limits);
  Retimed best{{}, {Refusal::Reason::kNoWayOn, 0.0, -1, 0.0}};
  // About 2.5 times the best time of a motion that is all acceleration, or one that limits nothing.
  const double duration = fastest.duration(), limitless = 2 * accelerationTime(fastest, jerk);
  double time = std::min(std::cbrt(duration * duration * limitless), limitless), best_time = time;
  // How long the motion with another time takes, as a share of the best one.
  const auto attempt = [&](double reached) {
    MotionLimits softer = limits;
    softer.acceleration = reached * jerk;
    if (limits.acceleration.size() > 0) {
      softer.acceleration = softer.acceleration.cwiseMin(limits.acceleration).eval();
    }
    Retimed motion = withJumps(solver, fastest.path(), softer, options);
    const double most = best ? kSame * best.trajectory.duration() : kInfinity;
    if (motion && motion.trajectory.duration() >= most) return kWorse;  // as with less time
    if (motion) {
      motion = withoutJumps(solver, motion.trajectory, limits, jerk, options.margin, most);
    }
    if (motion.refusal.reason >= Refusal::Reason::kTooSlow) {  // slower ones are refused as well
      if (!best) best = std::move(motion);
      return kWorse;
    }
    if (best && !motion) return kSame;
    const double share = best ? motion.trajectory.duration() / best.trajectory.duration() : 1.0;
    best_time = reached;  // also where times that are longer limit nothing
    if (!best || share < 1.0) best = std::move(motion);
    return share;
  };
  const auto shortest = [&] { return best && best.trajectory.duration() < kSame * duration; };
  for (int halving = 0; halving < kHalvings && attempt(time) < kWorse && !shortest(); ++halving) {
    time /= 2;
  }
  for (double step = std::sqrt(2.0); step > kLeastStep && !shortest(); step = std::sqrt(step)) {
    const double middle = best_time;
    attempt(middle * step), attempt(middle / step);
  }
  return best;
}

}  // namespace

Retimed retime(const InverseDynamicsSolver& solver, const Path& path, const MotionLimits& limits,
               const RetimeOptions& options) {
  check(solver, path, limits, options);
  Retimed fastest = withJumps(solver, path, limits, options);
  if (!fastest || limits.jerk.size() + limits.torque_rate.size() == 0) return fastest;
  return fastestWithoutJumps(solver, fastest.trajectory, limits, options);
}

chain_dynamics::OwnedVector speedLimit(const InverseDynamicsSolver& solver,
                                       const Trajectory& trajectory, const MotionLimits& limits,
                                       const RetimeOptions& options) {
  check(solver, trajectory.path(), limits, options);
  const VectorXd s = trajectory.s();
  const PathDynamics dynamics(solver, trajectory.path(), s, limits, options.margin,
                              frictionState(solver));
  PhasePlane plane(dynamics);
  chain_dynamics::OwnedVector limit(s.size());
  for (Index k = 0; k < s.size(); ++k) limit[k] = std::sqrt(plane.greatest(k));
  return limit;
}

std::string text(const Refusal& refusal, const std::vector<std::string>& joint_names) {
  const auto number = [](double value) {
    std::string digits(32, '\0');
    digits.resize(
        static_cast<std::size_t>(std::snprintf(digits.data(), digits.size(), "%.4g", value)));
    return digits;
  };
  const std::string place = "at s = " + number(refusal.s) + " of the path";
  switch (refusal.reason) {
    case Refusal::Reason::kNone:
      return {};
    case Refusal::Reason::kTorqueAtRest:
      return place + " joint " + joint_names[static_cast<std::size_t>(refusal.joint)] + " lacks " +
             number(refusal.missing) +
             " N m to hold the robot, and no speed helps; lighten the "
             "payload, change the path, or raise the limit";
    case Refusal::Reason::kNoWayOn:
      return place +
             " each speed leads to where limits can't be kept; change the path, or raise "
             "the limits";
    case Refusal::Reason::kStartTooFast:
      return "the start's speed is too high: expected ds/dt of at most " + number(refusal.missing) +
             "; start slower";
    case Refusal::Reason::kEndTooFast:
      return "the end's speed is too high: expected ds/dt of at most " + number(refusal.missing) +
             "; end slower";
    case Refusal::Reason::kTooSlow:
      return "within the limits the motion takes at least " + number(refusal.missing) +
             " s: with limits of jerk or torque rate, expected at most " + number(kLongest) +
             " s; raise the limits, or divide the path";
    case Refusal::Reason::kRateTooLow:
      return place + " the torque of joint " +
             joint_names[static_cast<std::size_t>(refusal.joint)] + " changes by " +
             number(refusal.missing) +
             " N m/s, however slow the motion is: friction steps there; raise the limit of its "
             "rate, or "
             "use a model whose friction rises smoothly";
  }
  return {};
}

}  // namespace v2
}  // namespace inverse_dynamics_timing

// SPDX-License-Identifier: Apache-2.0
#include "phase_plane.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace inverse_dynamics_timing {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Linear programs of a step, each with friction at the solution of the last one.
constexpr int kPrograms = 40;
constexpr int kDampedFrom = 10;
// Relative change of z that ends them. Newton's method leaves about its square.
constexpr double kSame = 1e-4;

// Faster than limits of torque allow anywhere, and as good as standing still.
constexpr double kFastest = 1e12, kAtRest = 1e-12;
// Friction and the torque of motors bend: where lines that touch them leave no room, those that touch
// them at a slower speed may.
constexpr double kNearer = 0.1;

bool same(double z, double other) { return std::abs(z - other) <= kSame * std::max(z, other); }

}  // namespace

PhasePlane::PhasePlane(const PathDynamics& dynamics)
    : dynamics_(dynamics),
      here_(dynamics.emptyRoom()),
      next_(dynamics.emptyRoom()),
      low_(VectorXd::Zero(dynamics.points())),
      high_(low_),
      z_(low_) {
  planes_.reserve(static_cast<std::size_t>(4 * dynamics.rows() + 2));
}

/// The room at a point for about this z.
void PhasePlane::look(Index k, double z, Room& room) const {
  if (room.k != k || !same(room.z, z)) dynamics_.room(k, z, room);
}

/// Limits `p y + r x <= room` of row j, and of its other direction, the room being that of x or of y.
void PhasePlane::addLimits(Index j, double p, double r, const Room& room, double of_x,
                           double of_y) {
  planes_.add(p - of_y * room.up_slope[j], r - of_x * room.up_slope[j], room.up[j]);
  planes_.add(-p - of_y * room.down_slope[j], -r - of_x * room.down_slope[j], room.down[j]);
}

/// Limits of the squared speeds x and y at the ends of interval k, where `u = m (y - x)`,
/// `m = 1 / (2 ds)`.
void PhasePlane::addInterval(Index k) {
  const double m = 0.5 / (dynamics_.s(k + 1) - dynamics_.s(k));
  planes_.clear();
  planes_.add(1.0, 0.0, high_[k + 1]);
  planes_.add(-1.0, 0.0, -low_[k + 1]);
  const auto a = dynamics_.a(k), b = dynamics_.b(k), next_a = dynamics_.a(k + 1),
             next_b = dynamics_.b(k + 1);
  for (Index j = 0; j < dynamics_.rows(); ++j) {
    addLimits(j, a[j] * m, b[j] - a[j] * m, here_, 1.0, 0.0);
    addLimits(j, next_b[j] + next_a[j] * m, -next_a[j] * m, next_, 0.0, 1.0);
  }
}

/// z at point k on the parabola through the next three points, or through those before it (step -1).
double PhasePlane::extrapolated(const VectorXd& z, Index k, Index step) const {
  const Index a = k + step, b = a + step, c = b + step;
  if (c < 0 || c >= dynamics_.points()) return z[a];
  const auto slope = [&](Index i, Index j) {
    return (z[j] - z[i]) / (dynamics_.s(j) - dynamics_.s(i));
  };
  const double bend = (slope(b, c) - slope(a, b)) / (dynamics_.s(c) - dynamics_.s(a));
  const double way = dynamics_.s(k) - dynamics_.s(a);
  return z[a] + way * (slope(a, b) + (dynamics_.s(k) - dynamics_.s(b)) * bend);
}

/// The greatest or least x at point k from which a y in low_[k + 1] to high_[k + 1] is reached.
bool PhasePlane::backward(Index k, End end, double& x) {
  const bool greatest = end == End::kGreatest;
  const double cap = std::min(dynamics_.cap(k), kFastest);
  double y = greatest ? high_[k + 1] : low_[k + 1];
  x = greatest ? std::clamp(extrapolated(high_, k, 1), 0.0, cap) : 0.0;
  for (int program = 0; program < kPrograms; ++program) {
    look(k, x, here_);
    look(k + 1, y, next_);
    addInterval(k);
    double to = greatest ? cap : 0.0;
    if (!planes_.approach(to, greatest ? 0.0 : cap)) {
      if (!greatest || x < kAtRest) return false;
      x *= kNearer, y *= kNearer;
      continue;
    }
    const HalfPlanes::Range range = planes_.range(to);
    const double y_to = std::max(greatest ? range.high : range.low, 0.0);
    const bool done = same(to, here_.z) && same(y_to, next_.z);
    x = program < kDampedFrom ? to : (x + to) / 2;
    y = program < kDampedFrom ? y_to : (y + y_to) / 2;
    if (done) break;
  }
  return true;
}

/// The greatest y that is reached from z_[k].
double PhasePlane::forward(Index k) {
  const double x = z_[k];
  look(k, x, here_);
  double y = std::clamp(extrapolated(z_, k + 1, -1), low_[k + 1], high_[k + 1]);
  for (int program = 0; program < kPrograms; ++program) {
    look(k + 1, y, next_);
    addInterval(k);
    HalfPlanes::Range range = planes_.range(x);
    double near = x;
    if (range.empty() && planes_.approach(near, 0.0)) range = planes_.range(near);
    // Rounding, or friction that makes what is reachable more than an interval, leaves no room.
    const double to = range.low > range.high ? (range.low + range.high) / 2 : range.high;
    const double y_to = std::clamp(to, low_[k + 1], high_[k + 1]);
    const bool done = same(y_to, next_.z);
    y = program < kDampedFrom ? y_to : (y + y_to) / 2;
    if (done) break;
  }
  std::swap(here_, next_);
  return y;
}

bool PhasePlane::refuse(Index k, Refusal::Reason reason) {
  refusal_ = {reason, dynamics_.s(k), -1, 0.0};
  return false;
}

bool PhasePlane::solve(double start, double end) {
  const Index last = dynamics_.points() - 1;
  for (Index k = 0; k <= last; ++k) {
    double missing = 0.0;
    const Index joint = dynamics_.weakest(k, missing);
    stands_.push_back(joint < 0);
    const bool rests = (k == 0 && start == 0.0) || (k == last && end == 0.0);
    if (joint < 0 || (!rests && greatest(k) >= 0.0)) continue;
    refuse(k, Refusal::Reason::kTorqueAtRest);
    refusal_.joint = joint, refusal_.missing = missing;
    return false;
  }
  const double most = greatest(last);
  if ((end == 0.0 || end <= most * (1 + kSame)) && reach(start, end, end)) return true;
  if (end == 0.0 || refusal_.reason == Refusal::Reason::kStartTooFast) return false;
  if (!reach(start, 0.0, most)) return false;
  refuse(last, Refusal::Reason::kEndTooFast);
  refusal_.missing = std::sqrt(z_[last]);
  return false;
}

/// Sets z() from z = start to the greatest z at the end, of those from `least` to `most`.
bool PhasePlane::reach(double start, double least, double most) {
  const Index last = dynamics_.points() - 1;
  low_.setZero();
  low_[last] = least, high_[last] = most;
  for (Index k = last - 1; k >= 0; --k) {
    if (!backward(k, End::kGreatest, high_[k])) return refuse(k, Refusal::Reason::kNoWayOn);
    const auto here = static_cast<std::size_t>(k);
    const bool rest = low_[k + 1] == 0.0 && stands_[here] && stands_[here + 1];
    if (!rest && !backward(k, End::kLeast, low_[k])) low_[k] = high_[k];
    std::swap(here_, next_);
  }
  if (start > high_[0] * (1 + 1e-9)) {
    refuse(0, Refusal::Reason::kStartTooFast);
    refusal_.missing = std::sqrt(high_[0]);
    return false;
  }
  if (start < low_[0] * (1 - 1e-9)) return refuse(0, Refusal::Reason::kNoWayOn);
  z_[0] = start;
  for (Index k = 0; k < last; ++k) z_[k + 1] = forward(k);
  for (Index k = 1; k < last; ++k) {
    if (!(z_[k] > 0.0)) return refuse(k, Refusal::Reason::kNoWayOn);  // time has no end
  }
  return true;
}

double PhasePlane::greatest(Index k) {
  double z = std::min(dynamics_.cap(k), kFastest);
  double x = std::min(z, 1.0);
  for (int program = 0; program < kPrograms; ++program) {
    look(k, x, here_);
    planes_.clear();
    for (Index j = 0; j < dynamics_.rows(); ++j) {
      addLimits(j, dynamics_.a(k)[j], dynamics_.b(k)[j], here_, 1.0, 0.0);  // y: the acceleration
    }
    double to = z;
    if (!planes_.approach(to, 0.0)) {
      if (x < kAtRest) return -1.0;
      x *= kNearer;
      continue;
    }
    const bool done = same(to, here_.z);
    x = program < kDampedFrom ? to : (x + to) / 2;
    if (done) break;
  }
  return x;
}

}  // namespace inverse_dynamics_timing

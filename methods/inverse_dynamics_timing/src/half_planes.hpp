// SPDX-License-Identifier: Apache-2.0
/// @file
/// Linear programs of two unknowns: the first x, from one side, that leaves room for a y.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace inverse_dynamics_timing {

/// Half planes `p y + r x <= t`.
class HalfPlanes {
 public:
  struct Line {
    double at_zero, slope;  // y = at_zero + slope x
  };
  /// The y of an x: from the highest lower line to the lowest upper one.
  struct Range {
    double low, high;
    double low_slope, high_slope;
    bool empty() const { return low - high > 1e-12 * (std::abs(low) + std::abs(high)); }
  };

  void reserve(std::size_t count) { upper_.reserve(count), lower_.reserve(count); }
  void clear() { upper_.clear(), lower_.clear(); }

  void add(double p, double r, double t) {
    constexpr double kLeast = 1e-100;  // y unbounded, for all that x can be
    if (std::abs(p) < kLeast) p = kLeast;
    const double inverse = 1 / p;
    (p > 0 ? upper_ : lower_).push_back({t * inverse, -r * inverse});
  }

  Range range(double x) const {
    Range result{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                 0.0, 0.0};
    for (const Line& line : upper_) {
      const double y = line.at_zero + line.slope * x;
      if (y < result.high) result.high = y, result.high_slope = line.slope;
    }
    for (const Line& line : lower_) {
      const double y = line.at_zero + line.slope * x;
      if (y > result.low) result.low = y, result.low_slope = line.slope;
    }
    return result;
  }

  /// Moves x >= 0 to the nearest place from it towards `to` that leaves room for a y; false: there is none.
  bool approach(double& x, double to) const {
    const double from = x;
    if (!newton(x, to)) return false;
    // Steps from far away round off what matters here; the last ones begin nearby.
    x += (from - x) * 1e-9;
    return newton(x, to);
  }

 private:
  static constexpr double kRounding = 1e-13;  // share of x

  // `low - high` is convex in x, so Newton's method comes monotonously, in as many steps as lines.
  bool newton(double& x, double to) const {
    for (std::size_t step = 0; step <= upper_.size() + lower_.size(); ++step) {
      const Range here = range(x);
      if (!here.empty()) return true;
      const double next = x - (here.low - here.high) / (here.low_slope - here.high_slope);
      if (std::abs(next - x) <= kRounding * x) {
        // Rounding of a steep line hides the place: a little beyond it there is room.
        const double beyond = 10 * kRounding * x;
        x = to < x ? std::max(to, next - beyond) : std::min(to, next + beyond);
        return true;
      }
      // Also false for a NaN: parallel lines.
      const bool towards = to < x ? next < x && next >= to : next > x && next <= to;
      if (!towards) return false;
      x = next;
    }
    return !range(x).empty();
  }

  std::vector<Line> upper_, lower_;
};

}  // namespace inverse_dynamics_timing

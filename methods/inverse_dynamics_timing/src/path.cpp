// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_timing/path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_timing {
inline namespace v2 {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

[[noreturn]] void refusePath(const std::string& what, const std::string& expected,
                             const std::string& got, const std::string& remedy = "") {
  throw inverse_dynamics_solver::InvalidParameterValueException("path", what, expected, got,
                                                                remedy);
}

/// Waypoints without repetitions, and the path's parameter at each.
struct Way {
  MatrixXd points;            // n x m
  std::vector<double> at;     // m, rising
  std::vector<Index> number;  // of each waypoint given, its column
};

Way wayThrough(const Path::Points& waypoints) {
  if (!waypoints.allFinite()) {
    refusePath("a waypoint isn't finite", "finite positions, rad (sliders: m)",
               "a NaN or infinity");
  }
  // Nearer than rounding of the positions themselves: the same waypoint.
  const double same = waypoints.size() > 0 ? 1e-9 * (1.0 + waypoints.cwiseAbs().maxCoeff()) : 0.0;
  Way way{MatrixXd(waypoints.rows(), waypoints.cols()), {}, {}};
  for (Index k = 0; k < waypoints.cols(); ++k) {
    const auto m = static_cast<Index>(way.at.size());
    const double step = m == 0 ? 0.0 : (waypoints.col(k) - way.points.col(m - 1)).norm();
    if (m == 0 || step > same) {
      way.points.col(m) = waypoints.col(k);
      way.at.push_back(m == 0 ? 0.0 : way.at.back() + step);
    }
    way.number.push_back(static_cast<Index>(way.at.size()) - 1);
  }
  way.points.conservativeResize(Eigen::NoChange, static_cast<Index>(way.at.size()));
  if (way.at.size() < 2) {
    refusePath("nothing moves", "two different waypoints at least",
               std::to_string(waypoints.cols()) + ", all at one place");
  }
  return way;
}

/// Whether the robot stops at each waypoint of a way.
std::vector<bool> stopsOf(const Way& way, const std::vector<Index>& stops) {
  std::vector<bool> result(way.at.size(), false);
  for (const Index stop : stops) {
    if (stop < 0 || stop >= static_cast<Index>(way.number.size())) {
      refusePath("no waypoint of a stop's number", "0 to " + std::to_string(way.number.size() - 1),
                 std::to_string(stop));
    }
    result[static_cast<std::size_t>(way.number[static_cast<std::size_t>(stop)])] = true;
  }
  return result;
}

/// Second derivatives of the natural cubic spline at its waypoints, one per column.
MatrixXd curvatures(const Way& way) {
  const Index m = way.points.cols(), n = way.points.rows();
  const auto step = [&](Index k) {
    return way.at[static_cast<std::size_t>(k + 1)] - way.at[static_cast<std::size_t>(k)];
  };
  // h[k-1] M[k-1] + 2 (h[k-1] + h[k]) M[k] + h[k] M[k+1] = 6 (slope[k] - slope[k-1])
  MatrixXd M = MatrixXd::Zero(n, m);
  VectorXd diagonal(m);
  for (Index k = 1; k + 1 < m; ++k) {
    diagonal[k] = 2 * (step(k - 1) + step(k));
    M.col(k) = 6 * ((way.points.col(k + 1) - way.points.col(k)) / step(k) -
                    (way.points.col(k) - way.points.col(k - 1)) / step(k - 1));
    if (k == 1) continue;
    const double factor = step(k - 1) / diagonal[k - 1];
    diagonal[k] -= factor * step(k - 1);
    M.col(k) -= factor * M.col(k - 1);
  }
  for (Index k = m - 2; k > 0; --k) M.col(k) = (M.col(k) - step(k) * M.col(k + 1)) / diagonal[k];
  return M;
}

/// A waypoint of straight lines: how far before and after it the curve of the corner reaches.
struct Corner {
  double reach = 0.0;
  bool stop = false;
};

/// A polynomial of powers of x, at most of fourth degree.
struct Polynomial {
  std::array<double, 5> c;
  std::size_t terms;

  double operator()(double x) const {
    double value = 0.0;
    for (std::size_t i = terms; i-- > 0;) value = value * x + c[i];
    return value;
  }
};

/// Appends where the polynomial changes its sign between 0 and h, rising.
void findSignChanges(Polynomial f, double h, std::vector<double>& found) {
  constexpr int kHalvings = 24;  // an extreme is known to the square of 2^-24
  while (f.terms > 0 && f.c[f.terms - 1] == 0.0) --f.terms;
  if (f.terms < 2) return;
  Polynomial slope{{}, f.terms - 1};
  for (std::size_t i = 1; i < f.terms; ++i) slope.c[i - 1] = static_cast<double>(i) * f.c[i];
  // Between its extremes it rises or falls throughout.
  std::vector<double> extremes;
  findSignChanges(slope, h, extremes);
  extremes.push_back(h);
  double from = 0.0;
  for (const double to : extremes) {
    double low = from, high = to;
    from = to;
    const bool negative = f(low) < 0.0;
    if (negative == (f(high) < 0.0)) continue;
    for (int halving = 0; halving < kHalvings; ++halving) {
      const double middle = (low + high) / 2;
      ((f(middle) < 0.0) == negative ? low : high) = middle;
    }
    found.push_back(high);
  }
}

// The middle of the curve is 3/16 reach |d2 - d1| from the corner.
constexpr double kCornerDistance = 3.0 / 16.0;

}  // namespace

Path::Path(Index joints, const std::vector<double>& knots)
    : knots_(Eigen::Map<const VectorXd>(knots.data(), static_cast<Index>(knots.size()))),
      coefficients_(MatrixXd::Zero(joints, kTerms * (static_cast<Index>(knots.size()) - 1))) {}

Path Path::polynomials(const Points& coefficients, const Eigen::Ref<const VectorXd>& knots,
                       const Eigen::Ref<const VectorXd>& stops) {
  Path path(coefficients.rows(), {knots.data(), knots.data() + knots.size()});
  path.coefficients_ = coefficients;
  path.stops_ = stops;
  return path;
}

Path Path::spline(const Points& waypoints, const std::vector<Index>& stops) {
  const Way way = wayThrough(waypoints);
  const MatrixXd M = curvatures(way);
  Path path(waypoints.rows(), way.at);
  for (Index k = 0; k + 1 < way.points.cols(); ++k) {
    const double h = path.knots_[k + 1] - path.knots_[k];
    auto c = path.piece(k);
    c.col(0) = way.points.col(k);
    c.col(1) =
        (way.points.col(k + 1) - way.points.col(k)) / h - h / 6 * (2 * M.col(k) + M.col(k + 1));
    c.col(2) = M.col(k) / 2;
    c.col(3) = (M.col(k + 1) - M.col(k)) / (6 * h);
  }
  std::vector<double> at;
  const std::vector<bool> stopped = stopsOf(way, stops);
  for (std::size_t k = 1; k + 1 < stopped.size(); ++k) {
    if (stopped[k]) at.push_back(way.at[k]);
  }
  path.stops_ = Eigen::Map<const VectorXd>(at.data(), static_cast<Index>(at.size()));
  return path;
}

Path Path::lines(const Points& waypoints, double deviation, const std::vector<Index>& stops) {
  if (!(deviation >= 0.0) || !std::isfinite(deviation)) {
    refusePath("deviation at corners", "a distance, >= 0 rad", std::to_string(deviation));
  }
  const Way way = wayThrough(waypoints);
  const std::vector<bool> stopped = stopsOf(way, stops);
  const Index m = way.points.cols();
  const auto length = [&](Index k) {
    return way.at[static_cast<std::size_t>(k + 1)] - way.at[static_cast<std::size_t>(k)];
  };
  const auto direction = [&](Index k) -> VectorXd {
    return (way.points.col(k + 1) - way.points.col(k)) / length(k);
  };

  std::vector<Corner> corners(static_cast<std::size_t>(m));
  for (Index k = 1; k + 1 < m; ++k) {
    Corner& corner = corners[static_cast<std::size_t>(k)];
    const double turn = (direction(k) - direction(k - 1)).norm();  // 2: back the way it came
    const double widest = std::min(length(k - 1), length(k)) / 2;
    if (turn < 1e-9) continue;  // no corner
    corner.reach = std::min(widest, deviation / (kCornerDistance * turn));
    corner.stop =
        stopped[static_cast<std::size_t>(k)] || corner.reach < 1e-6 * widest || turn > 1.999;
    if (corner.stop) corner.reach = 0.0;
  }
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) corners[k].stop |= stopped[k];

  std::vector<double> knots{0.0}, at;
  std::vector<Index> curve{};  // of each piece: its corner, or -1: a line
  const auto add = [&](double to, Index corner) {
    if (to - knots.back() <= 1e-12 * way.at.back()) return;
    knots.push_back(to);
    curve.push_back(corner);
  };
  for (Index k = 1; k < m; ++k) {
    const Corner& corner = corners[static_cast<std::size_t>(k)];
    const double here = way.at[static_cast<std::size_t>(k)];
    add(here - corner.reach, -k);
    if (corner.reach > 0.0) add(here + corner.reach, k);
    if (corner.stop) at.push_back(knots.back());
  }
  Path path(waypoints.rows(), knots);
  for (Index p = 0; p < static_cast<Index>(curve.size()); ++p) {
    auto c = path.piece(p);
    const Index k = std::abs(curve[static_cast<std::size_t>(p)]);
    const VectorXd d = direction(k - 1);
    const double before = way.at[static_cast<std::size_t>(k)] - path.knots_[p];
    c.col(0) = way.points.col(k) - before * d;
    c.col(1) = d;
    if (curve[static_cast<std::size_t>(p)] < 0) continue;
    // q' = d1 + (d2 - d1) (3 x^2 - 2 x^3), x from 0 to 1 along the curve
    const double whole = path.knots_[p + 1] - path.knots_[p];
    const VectorXd turn = direction(k) - d;
    c.col(3) = turn / (whole * whole);
    c.col(4) = -turn / (2 * whole * whole * whole);
  }
  path.stops_ = Eigen::Map<const VectorXd>(at.data(), static_cast<Index>(at.size()));
  return path;
}

Path Path::function(const Function& evaluate, Index joints,
                    const Eigen::Ref<const VectorXd>& knots) {
  for (Index k = 0; k < knots.size(); ++k) {
    if (!std::isfinite(knots[k]) || (k > 0 && !(knots[k] > knots[k - 1]))) {
      refusePath("knots", "finite, rising", "knot " + std::to_string(k) + " isn't");
    }
  }
  if (knots.size() < 2) refusePath("knots", "two at least", std::to_string(knots.size()));
  Path path(joints, std::vector<double>(knots.data(), knots.data() + knots.size()));
  VectorXd q0(joints), v0(joints), a0(joints), q1(joints), v1(joints), a1(joints);
  evaluate(knots[0], q0, v0, a0);
  for (Index k = 0; k + 1 < knots.size(); ++k) {
    evaluate(knots[k + 1], q1, v1, a1);
    if (!q0.allFinite() || !q1.allFinite() || !v0.allFinite() || !v1.allFinite() ||
        !a0.allFinite() || !a1.allFinite()) {
      refusePath("the function isn't finite", "finite q, q', q''",
                 "a NaN or infinity near knot " + std::to_string(k));
    }
    const double h = knots[k + 1] - knots[k];
    // The polynomial's rest beyond the parabola of the start must give q, q', q'' of the end.
    const VectorXd e = q1 - q0 - h * v0 - h * h / 2 * a0;
    const VectorXd de = h * (v1 - v0 - h * a0);
    const VectorXd dde = h * h * (a1 - a0);
    auto c = path.piece(k);
    c.col(0) = q0;
    c.col(1) = v0;
    c.col(2) = a0 / 2;
    c.col(3) = (10 * e - 4 * de + dde / 2) / std::pow(h, 3);
    c.col(4) = (-15 * e + 7 * de - dde) / std::pow(h, 4);
    c.col(5) = (6 * e - 3 * de + dde / 2) / std::pow(h, 5);
    q0 = q1, v0 = v1, a0 = a1;
  }
  return path;
}

std::vector<double> Path::turningPoints() const {
  std::vector<double> all, found;
  for (Index k = 0; k + 1 < knots_.size(); ++k) {
    const auto c = coefficients_.middleCols(kTerms * k, kTerms);
    found.clear();
    for (Index j = 0; j < c.rows(); ++j) {
      const Polynomial slope{{c(j, 1), 2 * c(j, 2), 3 * c(j, 3), 4 * c(j, 4), 5 * c(j, 5)}, 5};
      findSignChanges(slope, knots_[k + 1] - knots_[k], found);
    }
    std::sort(found.begin(), found.end());
    for (const double x : found) all.push_back(knots_[k] + x);
  }
  return all;
}

chain_dynamics::OwnedMatrix Path::positionRanges() const {
  std::vector<double> extremes = turningPoints();
  extremes.insert(extremes.end(), knots_.data(), knots_.data() + knots_.size());
  VectorXd q(jointCount()), dq(q), ddq(q);
  MatrixXd ranges(jointCount(), 2);
  evaluate(start(), q, dq, ddq);
  ranges.colwise() = q;
  for (const double s : extremes) {
    evaluate(s, q, dq, ddq);
    ranges.col(0) = ranges.col(0).cwiseMin(q), ranges.col(1) = ranges.col(1).cwiseMax(q);
  }
  return ranges;
}

void Path::evaluate(double s, Eigen::Ref<VectorXd> q, Eigen::Ref<VectorXd> dq,
                    Eigen::Ref<VectorXd> ddq, bool before) const {
  const double* const first = knots_.data();
  const double* const last = first + knots_.size();
  const double* next = before ? std::lower_bound(first, last, s) : std::upper_bound(first, last, s);
  const Index k = std::clamp<Index>(next - first - 1, 0, knots_.size() - 2);
  const double x = std::clamp(s, start(), end()) - knots_[k];
  const auto c = coefficients_.middleCols(kTerms * k, kTerms);
  for (Index j = 0; j < c.rows(); ++j) {
    const double c2 = c(j, 2), c3 = c(j, 3), c4 = c(j, 4), c5 = c(j, 5);
    q[j] = ((((c5 * x + c4) * x + c3) * x + c2) * x + c(j, 1)) * x + c(j, 0);
    dq[j] = (((5 * c5 * x + 4 * c4) * x + 3 * c3) * x + 2 * c2) * x + c(j, 1);
    ddq[j] = ((20 * c5 * x + 12 * c4) * x + 6 * c3) * x + 2 * c2;
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_timing

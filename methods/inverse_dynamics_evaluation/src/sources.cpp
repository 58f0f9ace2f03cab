// SPDX-License-Identifier: Apache-2.0

#include "sources.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "inverse_dynamics_evaluation/error.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::Index;

constexpr Index kLongestRun = 3;     // samples of the second source between two of the first
constexpr double kMoves = 0.05;      // of a joint's greatest velocity
constexpr double kJumps = 5.0;       // times the way between the samples around a jump
constexpr Index kFewest = 3;         // samples that show how the second source looks
constexpr double kLeastJump = 0.02;  // rad (prismatic m); of a source that moves
constexpr double kMostJumps = 0.1;   // of the samples; more are a second motion
constexpr Index kAhead = 10;         // samples in which stamps stay where a step took them
constexpr double kStep = 1.5;        // periods; a shorter step is jitter
constexpr double kForward = 3.0;  // periods; a shorter distance is jitter or a sample that was lost
constexpr double kContradicts = 0.05;  // of the disagreement with the stamps, squared
constexpr Index kStuck = 4;       // samples from one that is fresh to the next but one: some repeat
constexpr double kTypical = 9.0;  // times the typical disagreement, squared
constexpr Index kMostIntervals = 4096;  // that tell what is typical

bool standsStill(const SampleTable& table, Index k) { return table.qd.col(k).isZero(0); }

bool lacksEfforts(const SampleTable& table, Index k) {
  return table.effort.size() > 0 && table.effort.col(k).isZero(0);
}

// Whether some joint goes on in the same direction from sample `before` to `after`.
bool goesOn(const SampleTable& table, const Eigen::ArrayXd& fastest, Index before, Index after) {
  const auto a = table.qd.col(before).array(), b = table.qd.col(after).array();
  return (a * b > 0 && a.abs().min(b.abs()) > kMoves * fastest).any();
}

// Whether the positions of sample k lie off the way from sample `before` to `after`.
bool jumps(const SampleTable& table, Index before, Index k, Index after) {
  const auto from = table.q.col(before), to = table.q.col(after);
  return (table.q.col(k) - 0.5 * (from + to)).norm() > kJumps * (to - from).norm();
}

// Median distance of stamps that increase; 0: there is none.
double usualPeriod(const SampleTable& table) {
  std::vector<double> distances;
  const Index every = 1 + table.size() / kMostIntervals;
  for (Index k = 1; k < table.size(); k += every) {
    const double distance = table.time[k] - table.time[k - 1];
    if (distance > 0) distances.push_back(distance);
  }
  if (distances.empty()) return 0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

// Samples whose positions leave the motion around them and return, or lie off it at one of its ends; in the
// order of the table.
std::vector<Index> offTheWay(const SampleTable& table) {
  const double period = usualPeriod(table);
  // Farther than joints turn in the meantime.
  const auto is_far = [&](Index from, Index to, Index periods, double distance) {
    const double speed = std::max(table.qd.col(from).norm(), table.qd.col(to).norm());
    return distance > std::max(kLeastJump, kJumps * speed * period * static_cast<double>(periods));
  };
  std::vector<Index> found, run, first;  // first: samples before any leap
  std::size_t leaps = 0;                 // that don't return
  Index before = -1;                     // the last sample on the way
  for (Index k = 0; k < table.size(); ++k) {
    if (table.repeated[k]) continue;
    const auto periods = static_cast<Index>(run.size()) + 1;
    const double distance = before < 0 ? 0 : (table.q.col(k) - table.q.col(before)).norm();
    if (before >= 0 && distance > kLeastJump && is_far(before, k, periods, distance)) {
      run.push_back(k);
      if (static_cast<Index>(run.size()) <= kLongestRun) continue;
      // the way goes on from there, or begins there
      if (leaps == 0 && static_cast<Index>(first.size()) <= kLongestRun) {
        found.insert(found.begin(), first.begin(), first.end());
        first.resize(kLongestRun + 1);
      } else {
        ++leaps;
      }
      k = run.front();
    } else {
      for (const Index i : run) {
        const double off = (table.q.col(i) - 0.5 * (table.q.col(before) + table.q.col(k))).norm();
        if (off > kJumps * distance && is_far(before, k, periods, off)) found.push_back(i);
      }
    }
    run.clear();
    before = k;
    if (static_cast<Index>(first.size()) <= kLongestRun) first.push_back(k);
  }
  found.insert(found.end(), run.begin(), run.end());
  // Where most don't, velocities are wrong throughout, or positions: those of a joint in degrees return where
  // it turns back.
  if (leaps > found.size()) found.clear();
  return found;
}

// Squared disagreement of positions with velocities over a duration [s].
double disagreement(const SampleTable& table, Index before, Index k, double duration) {
  return (table.q.col(k) - table.q.col(before) -
          0.5 * duration * (table.qd.col(before) + table.qd.col(k)))
      .squaredNorm();
}

// Median over an interval of this duration [s]; 0: as stamped.
double typicalDisagreement(const SampleTable& table, double period) {
  std::vector<double> found;
  const Index every = 1 + table.size() / kMostIntervals;
  for (Index k = 1; k < table.size(); k += every) {
    if (table.repeated[k] || table.repeated[k - 1]) continue;
    const double duration = period > 0 ? period : table.time[k] - table.time[k - 1];
    found.push_back(disagreement(table, k - 1, k, duration));
  }
  if (found.empty()) return 0;
  const auto middle = found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2);
  std::nth_element(found.begin(), middle, found.end());
  return *middle;
}

// Number of the next sample that isn't marked; the size of the table: there is none.
Index nextFresh(const SampleTable& table, Index k) {
  do ++k;
  while (k < table.size() && table.repeated[k]);
  return k;
}

}  // namespace

SecondSource markSecondSource(SampleTable& table) {
  const Index size = table.size();
  const Eigen::ArrayXd fastest = table.qd.cwiseAbs().rowwise().maxCoeff();
  std::vector<Index> found;
  Index before = -1;  // the last sample in motion
  for (Index k = 0; k < size; ++k) {
    if (standsStill(table, k)) continue;
    const Index run = k - before - 1;
    if (before >= 0 && run > 0 && run <= kLongestRun && goesOn(table, fastest, before, k)) {
      for (Index i = before + 1; i < k; ++i) {
        const bool silent = lacksEfforts(table, i) && !lacksEfforts(table, before);
        if (silent || jumps(table, before, i, k)) found.push_back(i);
      }
    }
    before = k;
  }
  SecondSource other;
  const auto mark = [&](Index k) {
    other.first = other.count++ == 0 ? k : std::min(other.first, k);
    table.repeated[k] = true;
  };
  if (static_cast<Index>(found.size()) < kFewest) {
    for (const Index k : found) mark(k);
  } else {
    // the same source where the arm rests
    const Index one = found.front();
    const bool silent = lacksEfforts(table, one);
    for (Index k = 0; k < size; ++k) {
      const bool same = silent ? lacksEfforts(table, k) : table.q.col(k) == table.q.col(one);
      if (standsStill(table, k) && same) mark(k);
    }
  }
  const std::vector<Index> off = offTheWay(table);
  const auto count = static_cast<double>(off.size());
  if (count > kMostJumps * static_cast<double>(size - table.repeated.count())) {
    throw EvaluationError(
        "samples", "positions", "those of one robot",
        "two sequences of positions that alternate in " + std::to_string(off.size()) + " of " +
            std::to_string(size) + " samples, first in sample " + std::to_string(off.front() + 1) +
            " (counted from 1)",
        "two publishers use the same joint names: record one of them, or sort the samples");
  }
  for (const Index k : off) mark(k);
  return other;
}

std::vector<ClockStep> undoClockSteps(SampleTable& table, double gap) {
  std::vector<ClockStep> steps;
  const double period = usualPeriod(table);
  if (period == 0) return steps;
  const double typical = typicalDisagreement(table, period);
  // Whether the next samples, too, are on that side of where the period would take them.
  const auto stays = [&](Index before, Index k, double from, double side) {
    Index count = 0;
    for (Index i = k; i < table.size() && count < kAhead; ++i) {
      if (table.repeated[i]) continue;
      ++count;
      const double expected = from + static_cast<double>(i - before) * period;
      if (side * (table.time[i] - expected) < kStep * period) return false;
    }
    return count > 1;
  };
  double offset = 0;
  Index before = -1;   // the last sample that isn't late or early by itself
  double stamped = 0;  // s; of that sample, as recorded
  for (Index k = 0; k < table.size(); ++k) {
    const double recorded = table.time[k], distance = recorded - stamped;
    bool usual = !table.repeated[k];
    if (usual && before >= 0 && !(distance > 0 && distance <= kForward * period)) {
      const double by_stamps = disagreement(table, before, k, distance);
      const double by_period = disagreement(table, before, k, period);
      usual = stays(before, k, stamped, distance < 0 ? -1.0 : 1.0);
      const bool contradicted =
          distance <= gap && by_period < kContradicts * by_stamps && by_stamps > kTypical * typical;
      if (usual && (distance < 0 || (distance > 0 && contradicted))) {
        const bool confirmed = distance > 0 || by_period <= kTypical * typical;
        const double length = confirmed ? period : std::max(gap, period);
        steps.push_back({k, distance - length});
        offset += length - distance;
      }
    }
    if (usual) {
      before = k;
      stamped = recorded;
    }
    table.time[k] = recorded + offset;
  }
  return steps;
}

void markLate(SampleTable& table) {
  const double typical = kTypical * typicalDisagreement(table, 0);
  const auto between = [&](Index a, Index b) {
    return disagreement(table, a, b, table.time[b] - table.time[a]);
  };
  Index before = -1;
  for (Index k = nextFresh(table, -1), after = 0; k < table.size(); k = after) {
    after = nextFresh(table, k);
    if (before >= 0 && after < table.size() && after - before > kStuck) {
      const double least = std::min(between(before, k), between(k, after));
      if (least > typical && between(before, after) < kContradicts * least) {
        table.repeated[k] = true;
        continue;
      }
    }
    before = k;
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

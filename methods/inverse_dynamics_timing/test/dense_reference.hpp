// SPDX-License-Identifier: Apache-2.0
/// @file
/// The fastest motion along a path by dynamic programming on a dense grid of places and speeds: knows
/// nothing of linear programs, of intervals of speeds, or of friction's slope.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <limits>
#include <vector>

#include "inverse_dynamics_timing/path.hpp"

namespace inverse_dynamics_timing {

/// A grid of places along the path and of speeds from 0 to `fastest`.
struct DenseGrid {
  int places = 300, speeds = 3000, accelerations = 40;
  double fastest = 1.0;
};

/// Accelerations d2s/dt2 that torques allow at a place with speed v.
struct Accelerations {
  double least, greatest;
};

inline Accelerations accelerationsAt(const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                                     const Path& path, const Eigen::VectorXd& torque, double s,
                                     double v) {
  const Eigen::Index n = torque.size();
  Eigen::VectorXd q(n), dq(n), ddq(n), zero = Eigen::VectorXd::Zero(n);
  path.evaluate(s, q, dq, ddq);
  const Eigen::VectorXd coasting = solver.getTorques(q, dq * v, ddq * (v * v));
  const Eigen::VectorXd more = solver.getTorques(q, zero, dq) - solver.getTorques(q, zero, zero);
  Accelerations u{-1e9, 1e9};
  for (Eigen::Index j = 0; j < n; ++j) {
    const double up = (torque[j] - coasting[j]) / more[j],
                 down = (-torque[j] - coasting[j]) / more[j];
    u.least = std::max(u.least, std::min(up, down));
    u.greatest = std::min(u.greatest, std::max(up, down));
  }
  return u;
}

/// Shortest duration from rest to rest, s; infinite: there is none on the grid.
inline double denseDuration(const inverse_dynamics_solver::InverseDynamicsSolver& solver,
                            const Path& path, const Eigen::VectorXd& torque,
                            const DenseGrid& grid) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double step = (path.end() - path.start()) / grid.places, unit = grid.fastest / grid.speeds;
  std::vector<double> later(static_cast<std::size_t>(grid.speeds) + 1,
                            infinity);  // time to the end
  later[0] = 0.0;
  const auto timeFrom = [&](double speed) {
    const double place = speed / unit;
    const auto below = static_cast<std::size_t>(place);
    if (below + 1 >= later.size()) return infinity;
    const double share = place - static_cast<double>(below);
    // At the end only standing counts: what comes nearest to it may.
    return share == 0.0 ? later[below] : (1 - share) * later[below] + share * later[below + 1];
  };
  for (int k = grid.places - 1; k >= 0; --k) {
    std::vector<double> time(later.size(), infinity);
    for (std::size_t i = 0; i < time.size(); ++i) {
      const double v = unit * static_cast<double>(i), s = path.start() + k * step;
      const Accelerations u = accelerationsAt(solver, path, torque, s, v);
      for (int c = 0; c <= grid.accelerations && u.least <= u.greatest; ++c) {
        double chosen = u.least + (u.greatest - u.least) * c / grid.accelerations;
        // Of the last step: the acceleration that ends at rest.
        if (k == grid.places - 1) chosen = std::clamp(-v * v / (2 * step), u.least, u.greatest);
        const double squared = v * v + 2 * step * chosen;
        if (squared < 0.0) continue;
        const double w = k == grid.places - 1 && squared < unit * unit ? 0.0 : std::sqrt(squared);
        if (v + w > 0.0) time[i] = std::min(time[i], 2 * step / (v + w) + timeFrom(w));
      }
    }
    later = time;
  }
  return later[0];
}

}  // namespace inverse_dynamics_timing

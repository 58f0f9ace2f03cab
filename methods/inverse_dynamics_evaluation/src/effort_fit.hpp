// SPDX-License-Identifier: Apache-2.0

/// @file
/// The cut-off at which a robot's torques explain recorded efforts best: see cutoff.hpp.
///
///     const EffortFit fit(table, solver);
///     const CutoffChoice choice = fit.choose(motion, [&](double cutoff) { differentiate(table, cutoff); });

#pragma once

#include <Eigen/Core>
#include <functional>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <vector>

#include "inverse_dynamics_evaluation/cutoff.hpp"
#include "inverse_dynamics_evaluation/sample_table.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// The parts of a long table with the fastest motion, as a table; null: the table is short.
std::unique_ptr<SampleTable> excerptOf(const SampleTable& table);

/// Fits of computed to recorded torques, by accelerations that a filter made.
class EffortFit {
 public:
  /// Fills a table with the accelerations of a cut-off [Hz].
  using Differentiate = std::function<void(double cutoff)>;

  /// @param table  n joints; with efforts and flags. Must stay.
  EffortFit(const SampleTable& table, const inverse_dynamics_solver::InverseDynamicsSolver& solver);

  /// The choice of positions and velocities, or that of the efforts where they know better.
  CutoffChoice choose(CutoffChoice motion, const Differentiate& differentiate) const;

 private:
  // Root mean square error of each part by a fit to the others, one part per row; N m (prismatic N).
  Eigen::ArrayXXd errors() const;

  const SampleTable& table_;
  std::vector<Eigen::Index> moving_;  // samples that are fitted to
  Eigen::MatrixXd q_, qd_, effort_;   // n x M; of these
  Eigen::MatrixXd gravity_, other_;   // n x M; N m (prismatic N); other: Coriolis and friction
  Eigen::MatrixXd inertia_;           // n x (n M)
  Eigen::VectorXd fastest_;           // n; greatest velocities
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

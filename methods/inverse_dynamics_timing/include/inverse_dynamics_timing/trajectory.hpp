// SPDX-License-Identifier: Apache-2.0
/// @file
/// A path with its time.
///
///     for (double t = 0; t < trajectory.duration(); t += 0.002) trajectory.evaluate(t, q, qd, qdd);
#pragma once

#include <Eigen/Core>
#include <optional>

#include "chain_dynamics/owned.hpp"
#include "inverse_dynamics_timing/path.hpp"

namespace inverse_dynamics_timing {
inline namespace v2 {

/// A motion along a path with constant `d2s/dt2` between the points of a grid.
class Trajectory {
 public:
  Trajectory() = default;

  /// @param s      rising; at a stop its number stands twice.
  /// @param speed  ds/dt at each, >= 0; zero at stops only and at the ends.
  Trajectory(Path path, const Eigen::Ref<const Eigen::VectorXd>& s,
             const Eigen::Ref<const Eigen::VectorXd>& speed);

  double duration() const { return time_.size() == 0 ? 0.0 : time_[time_.size() - 1]; }
  const Path& path() const { return *path_; }

  /// @name At the points of the grid
  /// @{
  const chain_dynamics::OwnedVector& time() const { return time_; }  ///< s
  const chain_dynamics::OwnedVector& s() const { return s_; }        ///< parameter of the path
  const chain_dynamics::OwnedVector& speed() const {
    return speed_;
  }  ///< ds/dt, 1/s times its unit
  /// @}

  /// q, qd, qdd at a time, limited to 0 to duration(). Allocates nothing.
  ///
  /// Accelerations jump at points of the grid: there those after it.
  void evaluate(double t, Eigen::Ref<Eigen::VectorXd> q, Eigen::Ref<Eigen::VectorXd> qd,
                Eigen::Ref<Eigen::VectorXd> qdd) const;

 private:
  std::optional<Path> path_;
  chain_dynamics::OwnedVector time_, s_, speed_;
};

/// Times at which a motion is sampled for a controller, s: 0, 1 / rate, 2 / rate, ..., duration.
///
/// They rise strictly: the last step takes half a period to one and a half, and one step is all of a
/// motion that is shorter.
///
/// @param duration,rate  > 0; s, Hz.
/// @throws inverse_dynamics_solver::InvalidParameterValueException  more than a million samples.
chain_dynamics::OwnedVector sampleTimes(double duration, double rate);

/// The motion slower by a factor >= 1, the same along the whole path.
Trajectory slowed(const Trajectory& motion, double factor);

}  // namespace v2
}  // namespace inverse_dynamics_timing

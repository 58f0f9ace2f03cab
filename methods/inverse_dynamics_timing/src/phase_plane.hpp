// SPDX-License-Identifier: Apache-2.0
/// @file
/// The fastest speed along a path between two stops: a backward and a forward pass over its points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "half_planes.hpp"
#include "path_dynamics.hpp"

namespace inverse_dynamics_timing {

class PhasePlane {
 public:
  explicit PhasePlane(const PathDynamics& dynamics);

  /// The greatest squared speeds from z = start to z = end; false: refusal() says why.
  bool solve(double start, double end);

  const Eigen::VectorXd& z() const { return z_; }
  const Refusal& refusal() const { return refusal_; }

  /// The greatest squared speed at point k for which an acceleration keeps the limits; negative: none.
  double greatest(Eigen::Index k);

 private:
  enum class End { kGreatest, kLeast };

  void look(Eigen::Index k, double z, Room& room) const;
  void addLimits(Eigen::Index j, double p, double r, const Room& room, double of_x, double of_y);
  void addInterval(Eigen::Index k);
  double extrapolated(const Eigen::VectorXd& z, Eigen::Index k, Eigen::Index step) const;
  bool backward(Eigen::Index k, End end, double& x);
  double forward(Eigen::Index k);
  bool reach(double start, double least, double most);
  bool refuse(Eigen::Index k, Refusal::Reason reason);

  const PathDynamics& dynamics_;
  HalfPlanes planes_;
  Room here_, next_;            // of both ends of an interval
  std::vector<bool> stands_;    // whether torques hold the robot still
  Eigen::VectorXd low_, high_;  // squared speeds from which the end can be reached
  Eigen::VectorXd z_;
  Refusal refusal_;
};

}  // namespace inverse_dynamics_timing

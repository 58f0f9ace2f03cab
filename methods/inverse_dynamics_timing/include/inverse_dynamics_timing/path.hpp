// SPDX-License-Identifier: Apache-2.0
/// @file
/// A path: where the joints go, without saying when.
///
///     Eigen::MatrixXd waypoints(6, 4);                      // one waypoint per column, rad
///     Path smooth = Path::spline(waypoints);                // through all of them
///     Path straight = Path::lines(waypoints, 0.05);         // past the corners by at most 0.05 rad
///
/// `q(s)` is a piecewise polynomial of the path's parameter s, twice continuously differentiable
/// between stops. s counts the length of the way from waypoint to waypoint, so its unit is that of
/// the joints (rad, of sliders m).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "chain_dynamics/owned.hpp"

namespace inverse_dynamics_timing {
inline namespace v2 {

class Path {
 public:
  using Points = Eigen::Ref<const Eigen::MatrixXd>;

  /// Cubic spline with `q'' = 0` at both ends: a straight line of two waypoints.
  ///
  /// @param waypoints  n x m, rad; those equal to the one before are left out.
  /// @param stops      numbers of waypoints, from 0, at which the robot stands still for an instant.
  /// @throws inverse_dynamics_solver::InvalidParameterValueException  fewer than two different
  ///   waypoints, a number that isn't finite, or no waypoint of a stop's number.
  static Path spline(const Points& waypoints, const std::vector<Eigen::Index>& stops = {});

  /// Straight lines whose corners are rounded by quartic curves with continuous `q''`.
  ///
  /// A corner's curve takes at most half of both lines. Where the way turns back, or `deviation` is
  /// zero, the robot stops instead.
  ///
  /// @param deviation  greatest Euclidean distance of the path from a corner, >= 0; rad.
  /// @throws as spline(); a negative deviation.
  static Path lines(const Points& waypoints, double deviation,
                    const std::vector<Eigen::Index>& stops = {});

  /// Writes q, q' and q'' at s.
  using Function =
      std::function<void(double s, Eigen::Ref<Eigen::VectorXd> q, Eigen::Ref<Eigen::VectorXd> dq,
                         Eigen::Ref<Eigen::VectorXd> ddq)>;

  /// A function's path: quintic polynomials that have its `q`, `q'` and `q''` at the ends of pieces.
  ///
  /// @param evaluate  `q'` must not vanish.
  /// @param joints    n.
  /// @param knots     rising, the ends of the pieces; at least two.
  /// @throws as spline(); a number of the function, or a knot, that isn't finite.
  static Path function(const Function& evaluate, Eigen::Index joints,
                       const Eigen::Ref<const Eigen::VectorXd>& knots);

  /// A path of coefficients(), knots() and stops() of another one.
  static Path polynomials(const Points& coefficients,
                          const Eigen::Ref<const Eigen::VectorXd>& knots,
                          const Eigen::Ref<const Eigen::VectorXd>& stops);

  Eigen::Index jointCount() const { return coefficients_.rows(); }
  /// n x (6 K), of K quintic polynomials side by side: of powers of `s` minus the piece's knot.
  const chain_dynamics::OwnedMatrix& coefficients() const { return coefficients_; }
  /// Ends of the polynomial pieces; the first is the path's start, the last its end.
  const chain_dynamics::OwnedVector& knots() const { return knots_; }
  double start() const { return knots_[0]; }
  double end() const { return knots_[knots_.size() - 1]; }
  /// Where the robot stands still between start and end, rising; each is a knot.
  const chain_dynamics::OwnedVector& stops() const { return stops_; }

  /// Where joints turn back: s, rising, at which an element of `q'` changes its sign within a piece.
  std::vector<double> turningPoints() const;
  /// Least and greatest position of each joint on the whole path, n x 2.
  chain_dynamics::OwnedMatrix positionRanges() const;

  /// `q`, `q' = dq/ds` and `q''` at s, n numbers each; s is limited to the path. Allocates nothing.
  ///
  /// At a stop `q'` and `q''` may jump: those of the piece after it, or `before` it.
  void evaluate(double s, Eigen::Ref<Eigen::VectorXd> q, Eigen::Ref<Eigen::VectorXd> dq,
                Eigen::Ref<Eigen::VectorXd> ddq, bool before = false) const;

 private:
  static constexpr Eigen::Index kTerms = 6;  // of a quintic polynomial

  Path(Eigen::Index joints, const std::vector<double>& knots);
  auto piece(Eigen::Index k) { return coefficients_.middleCols(kTerms * k, kTerms); }

  chain_dynamics::OwnedVector knots_;         // K + 1
  chain_dynamics::OwnedMatrix coefficients_;  // n x (6 K), of powers of s - knots[k]
  chain_dynamics::OwnedVector stops_;
};

}  // namespace v2
}  // namespace inverse_dynamics_timing

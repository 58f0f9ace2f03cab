// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/damping.hpp"

#include <Eigen/Core>
#include <cmath>

#include "inverse_dynamics_control/model_terms.hpp"
#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

using inverse_dynamics_solver::errorText;
using inverse_dynamics_solver::InvalidParameterValueException;

void require(bool fulfilled, const std::string& argument, const std::string& expected,
             const std::string& got, const std::string& remedy) {
  if (fulfilled) return;
  throw InvalidParameterValueException(
      errorText("dampingFor: " + argument, "wrong value", expected, got, remedy));
}

/// Of a symmetric matrix: whether elimination has positive pivots only.
bool isPositiveDefinite(Eigen::MatrixXd A) {
  const Eigen::Index n = A.cols();
  for (Eigen::Index k = 0; k < n; ++k) {
    if (!(A(k, k) > 0)) return false;
    for (Eigen::Index j = k + 1; j < n; ++j) {
      A.col(j).tail(n - j) -= A(j, k) / A(k, k) * A.col(k).tail(n - j);
    }
  }
  return true;
}

/// The greatest s of D v = s H v, above which s H - D is positive definite, by bisection; infinite
/// if H isn't positive definite. D = rate diag(H): a unit vector's v'Dv / v'Hv is `rate`.
double fastestDecay(const Eigen::MatrixXd& H, const Eigen::MatrixXd& D, double rate) {
  double low = rate, high = 2 * rate;
  while (std::isfinite(high) && !isPositiveDefinite(high * H - D)) {
    low = high;
    high *= 2;
  }
  while (high - low > 1e-13 * high) {
    const double middle = 0.5 * (low + high);
    (isPositiveDefinite(middle * H - D) ? high : low) = middle;
  }
  return high;
}

}  // namespace

OwnedVector dampingFor(const InverseDynamicsSolver& solver, const ConstVectorRef& q, double rate,
                       double period) {
  require(solver.inertiaIsPhysical(), "solver", "a symmetric, positive definite H(q)",
          "inertiaIsPhysical() is false",
          "take a solver made from the robot's URDF, or choose the damping of each joint");
  require(std::isfinite(rate) && rate > 0, "rate", "a finite number above zero [1/s]", number(rate),
          "5 1/s brakes an arm within a second");
  require(std::isfinite(period) && period > 0, "period", "a finite number above zero [s]",
          number(period), "take the period of the control loop");
  require(q.allFinite(), "q", "finite positions", "NaN or infinity", "take a common posture");

  const Eigen::MatrixXd H = solver.getInertiaMatrix(q);
  OwnedVector damping = rate * H.diagonal();
  const double fastest = fastestDecay(H, damping.asDiagonal(), rate);
  require(fastest * period < 1.0, "rate",
          "no decay faster than 1 / period, " + number(1.0 / period) + " 1/s", number(fastest),
          "lower the rate " + number(rate) + " 1/s");
  return damping;
}

}  // namespace v2
}  // namespace inverse_dynamics_control

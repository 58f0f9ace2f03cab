// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/damping.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <string>

#include "inverse_dynamics_control/model_terms.hpp"
#include "option_checks.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

using inverse_dynamics_solver::InvalidParameterValueException;

void require(bool fulfilled, const std::string& argument, const std::string& expected,
             const std::string& got, const std::string& remedy) {
  if (fulfilled) return;
  throw InvalidParameterValueException("dampingFor: " + argument, "wrong value", expected, got,
                                       remedy);
}

}  // namespace

OwnedVector dampingFor(const InverseDynamicsSolver& solver, const ConstVectorRef& q, double rate,
                       double period) {
  require(solver.inertiaIsPhysical(), "solver", "a symmetric, positive definite H(q)",
          "inertiaIsPhysical() is false",
          "take a solver made from the robot's URDF, or choose the damping of each joint");
  require(std::isfinite(rate) && rate > 0, "rate", "a finite number above zero [1/s]",
          numberText(rate), "5 1/s brakes an arm within a second");
  require(std::isfinite(period) && period > 0, "period", "a finite number above zero [s]",
          numberText(period), "take the period of the control loop");
  require(q.allFinite(), "q", "finite positions", "NaN or infinity", "take a common posture");

  const Eigen::MatrixXd H = solver.getInertiaMatrix(q);
  OwnedVector damping = rate * H.diagonal();
  // Decays are the s of D v = s H v: all are slower than 1 / period if H / period - D is positive definite.
  Eigen::MatrixXd difference = H / period;
  difference.diagonal() -= damping;
  require(difference.llt().info() == Eigen::Success, "rate",
          "no decay faster than 1 / period, " + numberText(1.0 / period) + " 1/s", "a faster one",
          "lower the rate " + numberText(rate) + " 1/s");
  return damping;
}

}  // namespace v2
}  // namespace inverse_dynamics_control

// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/damping.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <utility>

#include "arms.hpp"

namespace inverse_dynamics_control::damping_test {

constexpr double kPeriod = 1e-3;  // s
constexpr double kClose = 1e-11;  // relative

TEST(Damping, PendulumByHand) {
  EXPECT_NEAR(dampingFor(*Pendulum::make(), vec({1.0}), 4.0, kPeriod)[0], 4.0 * 0.5, kRounding);
}

/// Slowest and fastest decay of two joints: the s of det(D - s H) = 0.
std::pair<double, double> decays(const Eigen::Matrix2d& H, const Eigen::Matrix2d& D) {
  const Eigen::Matrix2d A = H.inverse() * D;
  const double mean = A.trace() / 2, half = std::sqrt(mean * mean - A.determinant());
  return {mean - half, mean + half};
}

TEST(Damping, SlowestMotionDecaysWithItsPartOfTheRate) {
  const auto solver = ChainSolver::make(twoBars());
  for (const double elbow : {-2.0, -1.0, 0.0, 1.0, 3.0}) {
    const Eigen::VectorXd q = vec({0.3, elbow});
    const OwnedVector damping = dampingFor(*solver, q, 5.0, kPeriod);
    const auto [slowest, fastest] = decays(solver->getInertiaMatrix(q), damping.asDiagonal());
    EXPECT_GT(slowest, 5.0 / 2) << "elbow at " << elbow;
    EXPECT_NO_THROW(dampingFor(*solver, q, 5.0, (1 - kClose) / fastest)) << "elbow at " << elbow;
    EXPECT_THROW(dampingFor(*solver, q, 5.0, (1 + kClose) / fastest),
                 inverse_dynamics_solver::InvalidParameterValueException)
        << "elbow at " << elbow;
  }
}

TEST(Damping, BadArgumentsAreRefused) {
  auto solver = Pendulum::make();
  const auto text = [&](double q, double rate, double period) {
    return thrownBy([&] { dampingFor(*solver, vec({q}), rate, period); });
  };
  EXPECT_EQ(text(1.0, 0.0, kPeriod),
            "dampingFor: rate: wrong value: expected a finite number above zero [1/s], got 0; "
            "5 1/s brakes an arm within a second");
  EXPECT_EQ(text(1.0, 5.0, -kPeriod),
            "dampingFor: period: wrong value: expected a finite number above zero [s], got -0.001; "
            "take the period of the control loop");
  EXPECT_EQ(text(kNan, 5.0, kPeriod),
            "dampingFor: q: wrong value: expected finite positions, got NaN or infinity; take a "
            "common posture");
  EXPECT_EQ(text(1.0, 2000.0, kPeriod),
            "dampingFor: rate: wrong value: expected no decay faster than 1 / period, 1000 1/s, "
            "got a faster one; lower the rate 2000 1/s");
  EXPECT_THROW(dampingFor(*solver, vec({1.0, 2.0}), 1.0, kPeriod),
               inverse_dynamics_solver::SizeMismatchException);
  solver->physical = false;
  EXPECT_EQ(text(1.0, 1.0, kPeriod),
            "dampingFor: solver: wrong value: expected a symmetric, positive definite H(q), got "
            "inertiaIsPhysical() is false; take a solver made from the robot's URDF, or choose "
            "the damping of each joint");
}

}  // namespace inverse_dynamics_control::damping_test

// SPDX-License-Identifier: Apache-2.0
//
// Computed torque makes linear systems of an arm: integrated by the engine's forward dynamics, the
// error is the solution of edd + Kd ed + Kp e = 0.
#include <gtest/gtest.h>

#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/model.hpp>
#include <cmath>

#include "arms.hpp"

namespace inverse_dynamics_control::linearisation_test {

constexpr double kStep = 1e-3;  // s, of the Runge-Kutta method
constexpr int kSteps = 800;

/// Runge-Kutta of order four with steps of 1e-3 s, frequencies of 12 rad/s: (w h)^5 per step.
constexpr double kIntegration = 1e-8;

/// A fast desired motion, at which the arm doesn't start.
Reference referenceAt(double t) {
  return referenceOf(vec({std::sin(3.0 * t), 0.5 * std::cos(5.0 * t)}),
                     vec({3.0 * std::cos(3.0 * t), -2.5 * std::sin(5.0 * t)}),
                     vec({-9.0 * std::sin(3.0 * t), -12.5 * std::cos(5.0 * t)}));
}

/// Arm under the law as a system of first order: x = (q, qd).
class ClosedLoop {
 public:
  explicit ClosedLoop(const Gains& gains)
      : arm_(chain_dynamics::Model(twoBars())),
        law_(ChainSolver::make(twoBars()), gains, unlimited(2)) {}

  Eigen::Vector4d rate(double t, const Eigen::Vector4d& x) {
    Eigen::VectorXd tau(2), qdd(2);
    const JointState state = stateOf(x.head<2>(), x.tail<2>());
    EXPECT_EQ(law_.update(state, referenceAt(t), kStep, tau), Status::kOk);
    arm_.forwardDynamics(state.q.data(), state.qd.data(), tau.data(), qdd.data());
    Eigen::Vector4d result;
    result << state.qd, qdd;
    return result;
  }

  void advance(double t, Eigen::Vector4d& x) {
    const Eigen::Vector4d k1 = rate(t, x), k2 = rate(t + kStep / 2, x + kStep / 2 * k1),
                          k3 = rate(t + kStep / 2, x + kStep / 2 * k2),
                          k4 = rate(t + kStep, x + kStep * k3);
    x += kStep / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }

 private:
  chain_dynamics::FastModel arm_;
  ComputedTorque law_;
};

/// Error of a critically damped joint (natural frequency w) from e0, ed0.
double criticallyDamped(double w, double e0, double ed0, double t) {
  return (e0 + (ed0 + w * e0) * t) * std::exp(-w * t);
}

/// Error of an underdamped joint (damping ratio z < 1) from e0, ed0.
double underdamped(double w, double z, double e0, double ed0, double t) {
  const double wd = w * std::sqrt(1 - z * z);
  return std::exp(-z * w * t) *
         (e0 * std::cos(wd * t) + (ed0 + z * w * e0) / wd * std::sin(wd * t));
}

TEST(Linearisation, ErrorsAreThoseOfIndependentLinearSystems) {
  const Eigen::VectorXd w = vec({12.0, 8.0}), z = vec({1.0, 0.3});
  ClosedLoop loop(Gains::of(w, z));
  Eigen::Vector4d x(0.4, -0.3, 1.0, -2.0);
  const Reference first = referenceAt(0.0);
  const Eigen::VectorXd e0 = first.q - x.head<2>(), ed0 = first.qd - x.tail<2>();
  for (int k = 0; k < kSteps; ++k) {
    loop.advance(k * kStep, x);
    const double t = (k + 1) * kStep;
    const Eigen::VectorXd e = referenceAt(t).q - x.head<2>();
    ASSERT_NEAR(e[0], criticallyDamped(w[0], e0[0], ed0[0], t), kIntegration) << "at " << t;
    ASSERT_NEAR(e[1], underdamped(w[1], z[1], e0[1], ed0[1], t), kIntegration) << "at " << t;
  }
}

}  // namespace inverse_dynamics_control::linearisation_test

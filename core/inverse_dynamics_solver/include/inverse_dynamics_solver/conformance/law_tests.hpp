// SPDX-License-Identifier: Apache-2.0
/// @file
/// Conformance, part five: laws of physics, which need no expected digits. Include
/// conformance_tests.hpp, not this.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"
#include "inverse_dynamics_solver/motor_currents.hpp"

namespace inverse_dynamics_solver::conformance {

/// Derivative of `f` at zero by the five-point difference
/// `(f(-2h) - 8 f(-h) + 8 f(h) - f(2h)) / 12h`, error `h^4/30` times the fifth derivative.
template <class F>
Eigen::MatrixXd derivative(const F& f, double h) {
  const Eigen::MatrixXd outer = f(-2 * h) - f(2 * h);
  const Eigen::MatrixXd inner = f(h) - f(-h);
  return (outer + 8 * inner) / (12 * h);
}

TEST_P(SolverConformance, TorquesAreTheSumOfTheirTerms) {
  const InverseDynamicsSolver& s = *solver_;
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const Eigen::VectorXd inertial = s.getInertiaMatrix(x.q) * x.qdd;
    const Eigen::VectorXd c = s.getCoriolisVector(x.q, x.qd), f = s.getFrictionVector(x.q, x.qd);
    const Eigen::VectorXd g = s.getGravityVector(x.q);
    const double size = sizeOf(inertial) + sizeOf(c) + sizeOf(f) + sizeOf(g);
    EXPECT_TRUE(near(s.getTorques(x.q, x.qd, x.qdd), inertial + c + f + g, kRounding, size));
  }
}

TEST_P(SolverConformance, ComponentsEqualTheSingleMethods) {
  const InverseDynamicsSolver& s = *solver_;
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const auto [H, c, g] = s.getDynamicComponents(x.q, x.qd);
    EXPECT_TRUE(near(H, s.getInertiaMatrix(x.q), kRounding, sizeOf(H)));
    EXPECT_TRUE(near(c, s.getCoriolisVector(x.q, x.qd), kRounding, sizeOf(c)));
    EXPECT_TRUE(near(g, s.getGravityVector(x.q), kRounding, sizeOf(g)));
  }
}

TEST_P(SolverConformance, TorquesAreLinearInAcceleration) {
  const InverseDynamicsSolver& s = *solver_;
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const Eigen::VectorXd other = randomVector(GetParam().acceleration);
    const Eigen::VectorXd rest = s.getTorques(x.q, x.qd, 0 * x.qdd);
    const Eigen::VectorXd one = s.getTorques(x.q, x.qd, x.qdd) - rest;
    const Eigen::VectorXd two = s.getTorques(x.q, x.qd, other) - rest;
    const Eigen::VectorXd sum = s.getTorques(x.q, x.qd, 3 * x.qdd - 2 * other) - rest;
    const double size = sizeOf(rest) + 3 * sizeOf(one) + 2 * sizeOf(two);
    EXPECT_TRUE(near(sum, 3 * one - 2 * two, kRounding, size));
  }
}

TEST_P(SolverConformance, CoriolisTorquesAreQuadraticInVelocity) {
  const InverseDynamicsSolver& s = *solver_;
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const Eigen::VectorXd c = s.getCoriolisVector(x.q, x.qd);
    EXPECT_TRUE(near(s.getCoriolisVector(x.q, -3 * x.qd), 9 * c, kRounding, 9 * sizeOf(c)));
    EXPECT_TRUE(near(s.getCoriolisVector(x.q, 0 * x.qd), 0 * c, 0.0, 1.0)) << "not zero at rest";
  }
}

TEST_P(SolverConformance, GravityTorquesAreProportionalToGravity) {
  const auto under = [this](double x, double y, double z) {
    ParameterMap parameters{{"gravity", std::vector<double>{x, y, z}}};
    for (const auto& [name, value] : GetParam().parameters()) {
      if (name.rfind("springs.", 0) == 0) parameters[name] = 0.0;
    }
    return makeInitialized(parameters);
  };
  const auto none = under(0, 0, 0), a = under(1, 2, -3), b = under(-2, 0, 7);
  const auto sum = under(2 * 1 - 2, 2 * 2 + 0, 2 * -3 + 7);
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const Eigen::VectorXd g_a = a->getGravityVector(x.q), g_b = b->getGravityVector(x.q);
    EXPECT_TRUE(near(none->getGravityVector(x.q), 0 * g_a, 0.0, 1.0)) << "not zero without gravity";
    EXPECT_TRUE(
        near(sum->getGravityVector(x.q), 2 * g_a + g_b, kRounding, 2 * sizeOf(g_a) + sizeOf(g_b)));

    // Gravity is in no other term, but for friction that depends on it.
    const Eigen::VectorXd f_a = a->getFrictionVector(x.q, x.qd);
    const Eigen::VectorXd f_b = b->getFrictionVector(x.q, x.qd);
    EXPECT_TRUE(identical(a->getCoriolisVector(x.q, x.qd), b->getCoriolisVector(x.q, x.qd)));
    EXPECT_EQ(identical(f_a, f_b), !frictionDependsOnPosition(*a));
    const Eigen::MatrixXd H_a = a->getInertiaMatrix(x.q);
    EXPECT_TRUE(identical(flat(H_a), flat(b->getInertiaMatrix(x.q))));
    const Eigen::VectorXd tau = a->getTorques(x.q, x.qd, x.qdd);
    EXPECT_TRUE(near(tau - g_a - f_a, b->getTorques(x.q, x.qd, x.qdd) - g_b - f_b, kRounding,
                     sizeOf(tau) + sizeOf(g_a) + sizeOf(g_b) + sizeOf(f_a) + sizeOf(f_b)));
  }
}

TEST_P(SolverConformance, GravityPointsDownByDefault) {
  ParameterMap parameters = GetParam().parameters();
  parameters.erase("gravity");
  const auto by_default = make();
  by_default->initialize(parameters, "", GetParam().robotDescription());
  const auto given = makeInitialized({{"gravity", std::vector<double>{0, 0, -9.81}}});
  const State x = randomState();
  EXPECT_TRUE(identical(by_default->getGravityVector(x.q), given->getGravityVector(x.q)));
}

/// Where g is the gradient of a potential, its Jacobian is symmetric.
TEST_P(SolverConformance, GravityTorquesHaveASymmetricJacobian) {
  if (GetParam().gravity_is_not_conservative != nullptr) {
    GTEST_SKIP() << GetParam().gravity_is_not_conservative;
  }
  const InverseDynamicsSolver& s = *solver_;
  const Eigen::Index n = s.jointCount();
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    Eigen::MatrixXd jacobian(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto moved = [&](double step) -> Eigen::MatrixXd {
        return s.getGravityVector(x.q + step * Eigen::VectorXd::Unit(n, j));
      };
      jacobian.col(j) = derivative(moved, kDifferenceStep);
    }
    const double size = sizeOf(s.getGravityVector(x.q)) + sizeOf(jacobian);
    EXPECT_TRUE(near(jacobian, jacobian.transpose(), kDifference, size));
  }
}

TEST_P(SolverConformance, PhysicalInertiaIsSymmetricPositiveDefinite) {
  const InverseDynamicsSolver& s = *solver_;
  if (!s.inertiaIsPhysical()) GTEST_SKIP() << "inertiaIsPhysical() is false for this solver";
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const Eigen::MatrixXd H = s.getInertiaMatrix(x.q);
    EXPECT_TRUE(near(H, H.transpose(), kRounding, sizeOf(H)));
    EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(H).info(), Eigen::Success);  // has positive pivots only
  }
}

/// Power of all but gravity and friction = rate of the kinetic energy `1/2 qd' H qd`. With the
/// inertial torques on both sides taken away: `qd' (C qd) = 1/2 qd' Hdot qd`.
TEST_P(SolverConformance, PowerIsTheRateOfKineticEnergy) {
  const InverseDynamicsSolver& s = *solver_;
  if (!s.inertiaIsPhysical()) GTEST_SKIP() << "inertiaIsPhysical() is false for this solver";
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const auto later = [&](double time) { return s.getInertiaMatrix(x.q + time * x.qd); };

    // Step in time such that all joints together move by kDifferenceStep.
    const double speed = x.qd.cwiseAbs().sum();
    const Eigen::MatrixXd Hdot = derivative(later, kDifferenceStep / speed);
    const double power = x.qd.dot(s.getCoriolisVector(x.q, x.qd));
    const double size = speed * sizeOf(s.getInertiaMatrix(x.q)) * x.qd.squaredNorm();
    EXPECT_NEAR(power, 0.5 * x.qd.dot(Hdot * x.qd), kDifference * std::max(1.0, size));
  }
}

TEST_P(SolverConformance, FrictionCanBeSwitchedOff) {
  const auto with = makeInitialized({{"friction", true}});
  const auto without = makeInitialized({{"friction", false}});
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const Eigen::VectorXd f = with->getFrictionVector(x.q, x.qd);
    const Eigen::VectorXd tau = with->getTorques(x.q, x.qd, x.qdd);
    EXPECT_TRUE(near(without->getFrictionVector(x.q, x.qd), 0 * f, 0.0, 1.0));
    EXPECT_TRUE(
        near(without->getTorques(x.q, x.qd, x.qdd), tau - f, kRounding, sizeOf(tau) + sizeOf(f)));
  }
}

TEST_P(SolverConformance, FrictionIsFiniteAtAnyVelocity) {
  for (const double velocity : {0.0, 1.0, 1e3, 1e12, 1e200}) {
    const Eigen::VectorXd q = randomState().q;
    const Eigen::VectorXd qd = Eigen::VectorXd::Constant(q.size(), velocity);
    EXPECT_TRUE(solver_->getFrictionVector(q, qd).allFinite()) << velocity;
    EXPECT_TRUE(solver_->getFrictionVector(q, -qd).allFinite()) << -velocity;
  }
}

/// Friction that is zero at rest takes energy from every motion.
TEST_P(SolverConformance, FrictionDoesNoPositiveWork) {
  const InverseDynamicsSolver& s = *solver_;
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const Eigen::VectorXd at_rest = s.getFrictionVector(x.q, 0 * x.qd);
    const Eigen::VectorXd f = s.getFrictionVector(x.q, x.qd);
    for (Eigen::Index j = 0; j < f.size(); ++j) {
      if (at_rest[j] != 0.0) continue;
      EXPECT_GE(x.qd[j] * f[j], 0.0) << "joint " << j;
    }
  }
}

TEST_P(SolverConformance, MotorCurrentsTimesDriveGainsAreTorques) {
  const InverseDynamicsSolver& s = *solver_;
  const auto* motors = dynamic_cast<const MotorCurrents*>(&s);
  if (motors == nullptr) GTEST_SKIP() << "this solver has no MotorCurrents";
  const Eigen::MatrixXd K = motors->getDriveGainsMatrix();
  ASSERT_EQ(K.rows(), s.jointCount());
  Eigen::VectorXd i(s.jointCount());
  for (const State& x : randomStates(kStates)) {
    SCOPED_TRACE(toString(x));
    const Eigen::VectorXd tau = s.getTorques(x.q, x.qd, x.qdd);
    EXPECT_TRUE(near(K * motors->getCurrents(x.q, x.qd, x.qdd), tau, kRounding, sizeOf(tau)));
    motors->getCurrents(x.q, x.qd, x.qdd, i);
    EXPECT_EQ(i, motors->getCurrents(x.q, x.qd, x.qdd));
  }

  // The same errors as the solver's own method.
  const Eigen::VectorXd no = Eigen::VectorXd::Zero(s.jointCount() + 1);
  EXPECT_THROW(motors->getCurrents(no, no, no), SizeMismatchException);
  const auto fresh = make();
  EXPECT_THROW(dynamic_cast<const MotorCurrents&>(*fresh).getDriveGainsMatrix(),
               UninitializedException);
}

}  // namespace inverse_dynamics_solver::conformance

// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/friction_step.hpp"

#include <gmock/gmock.h>

#include <chain_dynamics/friction.hpp>
#include <cmath>

namespace inverse_dynamics_identification::friction_step_test {

using chain_dynamics::friction;

constexpr double kRounding = 1e-14;
constexpr double kDifference = 1e-6;    // of central differences
constexpr double kOfDifference = 1e-8;  // what they leave

StepFriction law() { return {1.5, 2, 0.05, 0.02, -0.3, 0.1, 0.7, 0.4}; }

TEST(FrictionStep, ColumnsAddUpToTheTorque) {
  for (const FrictionTerms terms :
       {FrictionTerms::kStep, FrictionTerms::kLoad, FrictionTerms::kStribeck}) {
    StepFriction known = law();
    if (terms == FrictionTerms::kStep) known.fl = 0;
    if (terms != FrictionTerms::kStribeck) known.fs = 0;
    Eigen::VectorXd row(ownColumns(terms));
    for (const double qd : {-1.0, -0.02, 0.0, 0.03, 2.0}) {
      ownColumnsAt(known, qd, 7, 3, {}, row);
      double sum = known.fv * row[own_column::kVelocity] + known.fo * row[own_column::kOne] +
                   known.fc * row[own_column::kStep];
      if (row.size() > own_column::kLoad) sum += known.fl * row[own_column::kLoad];
      if (row.size() > own_column::kStribeck) sum += known.fs * row[own_column::kStribeck];
      EXPECT_NEAR(sum, friction(known, qd, 3), kRounding) << qd;
      EXPECT_EQ(row[own_column::kAcceleration], 7);
    }
  }
}

TEST(FrictionStep, ColumnsOfShiftWidthAndVelocityAreDerivatives) {
  Eigen::VectorXd row(ownColumns(FrictionTerms::kStribeck));
  for (const double qd : {-0.6, -0.02, 0.0, 0.03, 0.5}) {
    ownColumnsAt(law(), qd, 0, 3, {}, row);
    const auto derivative = [&](auto change) {
      StepFriction above = law(), below = law();
      change(above, kDifference);
      change(below, -kDifference);
      return (friction(above, qd, 3) - friction(below, qd, 3)) / (2 * kDifference);
    };
    EXPECT_NEAR(row[own_column::kShift],
                derivative([](StepFriction& f, double by) { f.shift += by; }), kOfDifference);
    EXPECT_NEAR(row[own_column::kWidth],
                derivative([](StepFriction& f, double by) { f.width *= std::exp(by); }),
                kOfDifference);
    EXPECT_NEAR(row[own_column::kStribeckVelocity],
                derivative([](StepFriction& f, double by) { f.vs *= std::exp(by); }),
                kOfDifference);
  }
}

/// Presliding of a law after some motion.
FittedPresliding after(const StepFriction& law) {
  FittedPresliding memory;
  for (const double by : {0.02, -0.01, 0.004}) move(memory, by, law);
  return memory;
}

TEST(FrictionStep, ColumnsOfPreslidingAreItsTorqueAndDerivatives) {
  StepFriction known = law();
  known.fm = 1.7;
  known.distance = 0.015;
  Eigen::VectorXd row(ownColumns(FrictionTerms::kMemory));
  for (const double qd : {-0.03, 0.0, 0.5}) {
    const auto torque = [&](const StepFriction& of) {
      const FittedPresliding memory = after(of);
      const double lagging = of.fm + of.fs * std::exp(-qd * qd / (of.vs * of.vs));
      return friction(of, qd, 3) +
             lagging * (memory.z.value +
                        (memory.unknown.value - 1) * std::tanh((qd + of.shift) / of.width));
    };
    const auto derivative = [&](auto change) {
      StepFriction above = known, below = known;
      change(above, kDifference);
      change(below, -kDifference);
      return (torque(above) - torque(below)) / (2 * kDifference);
    };
    ownColumnsAt(known, qd, 0, 3, after(known), row);
    EXPECT_NEAR(row[own_column::kMemory],
                derivative([](StepFriction& f, double by) { f.fm += by; }), kOfDifference);
    EXPECT_NEAR(row[own_column::kStribeck],
                derivative([](StepFriction& f, double by) { f.fs += by; }), kOfDifference);
    EXPECT_NEAR(row[own_column::kStribeckVelocity],
                derivative([](StepFriction& f, double by) { f.vs *= std::exp(by); }),
                kOfDifference);
    EXPECT_NEAR(row[own_column::kDistance],
                derivative([](StepFriction& f, double by) { f.distance *= std::exp(by); }),
                kOfDifference);
    EXPECT_NEAR(row[own_column::kWidth],
                derivative([](StepFriction& f, double by) { f.width *= std::exp(by); }),
                kOfDifference);
    EXPECT_NEAR(row[own_column::kShift],
                derivative([](StepFriction& f, double by) { f.shift += by; }), kOfDifference);
  }
}

}  // namespace inverse_dynamics_identification::friction_step_test

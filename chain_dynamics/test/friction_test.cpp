// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/friction.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cfenv>
#include <cmath>
#include <limits>
#include <vector>

namespace chain_dynamics {
namespace {

// A handful of additions and one exp: a few units in the last place of figures around one.
constexpr double kRounding = 1e-14;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Joints 1, 2 and 6 of an identified UR10: gentle, negative and very steep slopes [A].
const ViscousOffsetSigmoid kGentle{1.064043537306522, -1.006569687742683, 2.050627184327219,
                                   7.946667188885291, -0.018479435103176};
const ViscousOffsetSigmoid kNegativeSlope{0.994406350204483, 0.956270099079205, -2.401744448718348,
                                          -59.95355152110444, -0.001949874917063};
const ViscousOffsetSigmoid kSteep{0.235839271499783, -0.245334512427042, 0.597950406691004,
                                  459.1933488839184, -0.012953200294568};
const CenteredSigmoid kCentered{0.54615, 5.1181, 0.039533};

const std::vector<FrictionLaw> kAllLaws{ViscousCoulombOffset{0.5, 2.0, 0.25}, kGentle,
                                        kNegativeSlope, kSteep, kCentered};

TEST(Friction, ViscousCoulombOffsetWorkedByHand) {
  const ViscousCoulombOffset law{0.5, 2.0, 0.25};
  EXPECT_EQ(friction(law, 4.0), 0.5 * 4 + 2.0 + 0.25);
  EXPECT_EQ(friction(law, -4.0), -0.5 * 4 - 2.0 + 0.25);
  EXPECT_EQ(friction(law, 0.0), 0.25);
}

TEST(Friction, DefaultLawIsNoFriction) {
  EXPECT_EQ(friction(FrictionLaw{}, 3.0), 0.0);
  EXPECT_EQ(friction(FrictionLaw{}, -3.0), 0.0);
}

TEST(Friction, ViscousOffsetSigmoidIsItsFormulaWhereTheFormulaDoesNotOverflow) {
  for (const auto& law : {kGentle, kNegativeSlope, kSteep}) {
    for (double qd = -1.0; qd <= 1.0; qd += 0.01) {
      const double naive =
          law.fv * qd + law.fo + law.fc / (1.0 + std::exp(-law.alpha * (qd + law.nu)));
      EXPECT_NEAR(friction(law, qd), naive, kRounding) << "alpha " << law.alpha << " qd " << qd;
    }
  }
}

TEST(Friction, CenteredSigmoidIsItsFormulaAndZeroAtRest) {
  const auto& law = kCentered;
  for (double qd = -3.0; qd <= 3.0; qd += 0.1) {
    const double naive = law.A / (1.0 + std::exp(-law.alpha * (qd + law.delta))) -
                         law.A / (1.0 + std::exp(-law.alpha * law.delta));
    EXPECT_NEAR(friction(law, qd), naive, kRounding) << "qd " << qd;
  }
  EXPECT_EQ(friction(law, 0.0), 0.0);
}

TEST(Friction, StepEndsAtItsTwoLevels) {
  // Far from the step only the viscous part and the offset, or offset + height, are left.
  EXPECT_NEAR(friction(kSteep, -20.0), kSteep.fv * -20.0 + kSteep.fo, kRounding);
  EXPECT_NEAR(friction(kSteep, 20.0), kSteep.fv * 20.0 + kSteep.fo + kSteep.fc, kRounding);
  // A negative slope turns the step round.
  const auto& turned = kNegativeSlope;
  EXPECT_NEAR(friction(turned, -20.0), turned.fv * -20.0 + turned.fo + turned.fc, kRounding);
  EXPECT_NEAR(friction(turned, 20.0), turned.fv * 20.0 + turned.fo, kRounding);
}

TEST(Friction, NoOverflowAtAnyFiniteVelocity) {
  for (const FrictionLaw& law : kAllLaws) {
    for (const double qd : {1.5, 2.0, 1e3, 1e10, 1e100, 1e300}) {
      std::feclearexcept(FE_ALL_EXCEPT);
      EXPECT_TRUE(std::isfinite(friction(law, qd))) << "law " << law.index() << " qd " << qd;
      EXPECT_TRUE(std::isfinite(friction(law, -qd))) << "law " << law.index() << " qd " << -qd;
      EXPECT_FALSE(std::fetestexcept(FE_OVERFLOW | FE_INVALID)) << law.index() << " " << qd;
    }
  }
}

TEST(Friction, NaNVelocityGivesNaN) {
  for (const FrictionLaw& law : kAllLaws) {
    EXPECT_TRUE(std::isnan(friction(law, kNaN))) << "law " << law.index();
  }
  EXPECT_TRUE(std::isnan(friction(FrictionLaw{}, kNaN)));
}

TEST(Friction, ScaledLawScalesTheTorque) {
  for (const FrictionLaw& law : kAllLaws) {
    for (const double qd : {-2.0, -0.01, 0.0, 0.02, 1.0}) {
      EXPECT_NEAR(friction(scaled(law, 13.5841), qd), 13.5841 * friction(law, qd), 1e-13)
          << "law " << law.index() << " qd " << qd;
    }
  }
}

// A difference quotient over 2e-6 rad/s: its own error grows with the third derivative, alpha^3.
TEST(FrictionSlope, IsTheDerivative) {
  for (const FrictionLaw& law : kAllLaws) {
    for (const double qd : {-2.0, -0.01, 0.002, 0.0129, 1.0}) {
      const double quotient = (friction(law, qd + 1e-6) - friction(law, qd - 1e-6)) / 2e-6;
      const double slope = frictionSlope(law, qd);
      EXPECT_NEAR(slope, quotient, 1e-7 * (1 + std::abs(slope))) << law.index() << " qd " << qd;
    }
  }
}

TEST(FrictionSlope, LeavesOutTheJumpAtRest) {
  EXPECT_EQ(frictionSlope(ViscousCoulombOffset{0.5, 2.0, 0.25}, 0.0), 0.5);
}

TEST(FrictionSlope, IsFiniteForAnyFiniteVelocityAndNanForNan) {
  for (const FrictionLaw& law : kAllLaws) {
    for (const double qd : {1e3, 1e100, 1e300}) {
      EXPECT_TRUE(std::isfinite(frictionSlope(law, qd))) << law.index() << " qd " << qd;
      EXPECT_TRUE(std::isfinite(frictionSlope(law, -qd))) << law.index() << " qd " << -qd;
    }
    EXPECT_TRUE(std::isnan(frictionSlope(law, kNaN))) << law.index();
  }
}

TEST(FrictionSlopes, EachJointHasItsOwnLaw) {
  const Eigen::VectorXd qd = Eigen::VectorXd::LinSpaced(5, -1.0, 2.0);
  Eigen::VectorXd slope = Eigen::VectorXd::Constant(5, kNaN);
  frictionSlopes(kAllLaws, qd, slope);
  for (Eigen::Index j = 0; j < 5; ++j) {
    EXPECT_EQ(slope[j], frictionSlope(kAllLaws[static_cast<std::size_t>(j)], qd[j])) << j;
  }
}

TEST(FrictionVector, EachJointHasItsOwnLaw) {
  const Eigen::VectorXd qd = Eigen::VectorXd::LinSpaced(5, -1.0, 2.0);
  Eigen::VectorXd f = Eigen::VectorXd::Constant(5, kNaN);
  frictionVector(kAllLaws, qd, f);
  for (Eigen::Index j = 0; j < 5; ++j) {
    EXPECT_EQ(f[j], friction(kAllLaws[static_cast<std::size_t>(j)], qd[j])) << "joint " << j;
  }
}

}  // namespace
}  // namespace chain_dynamics

// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/friction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cfenv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "reference.hpp"

namespace chain_dynamics::friction_test {

using ::testing::HasSubstr;

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

/// Figures of the size that large arms have: with load, with the Stribeck effect, with both.
const SmoothCoulomb kLoaded{12.0, 3.5, 0.025, 0.004, -0.6, 0.11};
const SmoothCoulomb kStribeck{2.0, 1.25, 0.01, 0, 0, 0, 0.75, 0.2};
const SmoothCoulomb kBoth{4.0, 2.5, 0.05, -0.01, 0.3, 0.08, 1.5, 0.125};

const std::vector<FrictionLaw> kAllLaws{ViscousCoulombOffset{0.5, 2.0, 0.25},
                                        kGentle,
                                        kNegativeSlope,
                                        kSteep,
                                        kCentered,
                                        kLoaded,
                                        kStribeck,
                                        kBoth};

/// A gravity torque [N m].
constexpr double kLoad = -17.5;

TEST(Friction, ViscousCoulombOffsetWorkedByHand) {
  const ViscousCoulombOffset law{0.5, 2.0, 0.25};
  EXPECT_EQ(friction(law, 4.0, kLoad), 0.5 * 4 + 2.0 + 0.25);
  EXPECT_EQ(friction(law, -4.0, kLoad), -0.5 * 4 - 2.0 + 0.25);
  EXPECT_EQ(friction(law, 0.0, kLoad), 0.25);
}

TEST(Friction, DefaultLawIsNoFriction) {
  EXPECT_EQ(friction(FrictionLaw{}, 3.0, kLoad), 0.0);
  EXPECT_EQ(friction(FrictionLaw{}, -3.0, kLoad), 0.0);
}

TEST(Friction, ViscousOffsetSigmoidIsItsFormulaWhereTheFormulaDoesNotOverflow) {
  for (const auto& law : {kGentle, kNegativeSlope, kSteep}) {
    for (double qd = -1.0; qd <= 1.0; qd += 0.01) {
      const double naive =
          law.fv * qd + law.fo + law.fc / (1.0 + std::exp(-law.alpha * (qd + law.nu)));
      EXPECT_NEAR(friction(law, qd, kLoad), naive, kRounding)
          << "alpha " << law.alpha << " qd " << qd;
    }
  }
}

TEST(Friction, CenteredSigmoidIsItsFormulaAndZeroAtRest) {
  const auto& law = kCentered;
  for (double qd = -3.0; qd <= 3.0; qd += 0.1) {
    const double naive = law.A / (1.0 + std::exp(-law.alpha * (qd + law.delta))) -
                         law.A / (1.0 + std::exp(-law.alpha * law.delta));
    EXPECT_NEAR(friction(law, qd, kLoad), naive, kRounding) << "qd " << qd;
  }
  EXPECT_EQ(friction(law, 0.0, kLoad), 0.0);
}

TEST(Friction, SmoothCoulombIsItsFormula) {
  for (const SmoothCoulomb& law : {kLoaded, kStribeck, kBoth}) {
    for (double qd = -2.0; qd <= 2.0; qd += 0.01) {
      for (const double g : {0.0, 3.0, -3.0, 120.0}) {
        const double stribeck =
            law.fs == 0 ? 0.0 : law.fs * std::exp(-(qd / law.vs) * (qd / law.vs));
        const double formula =
            law.fv * qd + law.fo +
            (law.fc + law.fl * std::abs(g) + stribeck) * std::tanh((qd + law.shift) / law.width);
        EXPECT_NEAR(friction(law, qd, g), formula, 30 * kRounding) << "qd " << qd << " g " << g;
      }
    }
  }
}

TEST(Friction, DependsOnTheMagnitudeOfTheLoadWithALoadCoefficientOnly) {
  for (const FrictionLaw& law : kAllLaws) {
    const bool depends = friction(law, 0.7, 10.0) != friction(law, 0.7, 0.0);
    EXPECT_EQ(dependsOnLoad(law), depends) << "law " << law.index();
    EXPECT_EQ(friction(law, 0.7, 10.0), friction(law, 0.7, -10.0)) << "law " << law.index();
  }
  EXPECT_TRUE(dependsOnLoad(kLoaded));
  EXPECT_FALSE(dependsOnLoad(kStribeck));
  // a joint that doesn't depend on it doesn't see its NaN
  EXPECT_EQ(friction(kStribeck, 0.7, kNaN), friction(kStribeck, 0.7, 0.0));
  EXPECT_TRUE(std::isnan(friction(kLoaded, 0.7, kNaN)));
}

TEST(Friction, StepEndsAtItsTwoLevels) {
  // Far from the step only the viscous part and the offset, or offset + height, are left.
  EXPECT_NEAR(friction(kSteep, -20.0, kLoad), kSteep.fv * -20.0 + kSteep.fo, kRounding);
  EXPECT_NEAR(friction(kSteep, 20.0, kLoad), kSteep.fv * 20.0 + kSteep.fo + kSteep.fc, kRounding);
  // A negative slope turns the step round.
  const auto& turned = kNegativeSlope;
  EXPECT_NEAR(friction(turned, -20.0, kLoad), turned.fv * -20.0 + turned.fo + turned.fc, kRounding);
  EXPECT_NEAR(friction(turned, 20.0, kLoad), turned.fv * 20.0 + turned.fo, kRounding);
}

TEST(Friction, NoOverflowAtAnyFiniteVelocity) {
  for (const FrictionLaw& law : kAllLaws) {
    for (const double qd : {1.5, 2.0, 1e3, 1e10, 1e100, 1e300}) {
      std::feclearexcept(FE_ALL_EXCEPT);
      EXPECT_TRUE(std::isfinite(friction(law, qd, kLoad))) << "law " << law.index() << " qd " << qd;
      EXPECT_TRUE(std::isfinite(friction(law, -qd, kLoad)))
          << "law " << law.index() << " qd " << -qd;
      EXPECT_FALSE(std::fetestexcept(FE_OVERFLOW | FE_INVALID)) << law.index() << " " << qd;
    }
  }
}

TEST(Friction, NaNVelocityGivesNaN) {
  for (const FrictionLaw& law : kAllLaws) {
    EXPECT_TRUE(std::isnan(friction(law, kNaN, kLoad))) << "law " << law.index();
  }
  EXPECT_TRUE(std::isnan(friction(FrictionLaw{}, kNaN, kLoad)));
}

// From currents to torques: the gravity torque is one, too.
TEST(Friction, ScaledLawIsTheSameInAnotherUnitOfTorque) {
  constexpr double kGain = 13.5841;
  for (const FrictionLaw& law : kAllLaws) {
    for (const double qd : {-2.0, -0.01, 0.0, 0.02, 1.0}) {
      EXPECT_NEAR(friction(scaled(law, kGain), qd, kGain * kLoad), kGain * friction(law, qd, kLoad),
                  1e-13)
          << "law " << law.index() << " qd " << qd;
    }
  }
}

// A difference quotient over 2e-6 rad/s: its own error grows with the third derivative, alpha^3.
TEST(FrictionSlope, IsTheDerivative) {
  for (const FrictionLaw& law : kAllLaws) {
    for (const double qd : {-2.0, -0.01, 0.002, 0.0129, 1.0}) {
      const double quotient =
          (friction(law, qd + 1e-6, kLoad) - friction(law, qd - 1e-6, kLoad)) / 2e-6;
      const double slope = frictionSlope(law, qd, kLoad);
      EXPECT_NEAR(slope, quotient, 1e-7 * (1 + std::abs(slope))) << law.index() << " qd " << qd;
    }
  }
}

TEST(FrictionLoadSlope, IsTheDerivativeByTheGravityTorque) {
  for (const FrictionLaw& law : kAllLaws) {
    for (const double qd : {-2.0, -0.01, 0.002, 1.0}) {
      for (const double g : {-40.0, 0.5, 12.0}) {
        const double quotient = (friction(law, qd, g + 1e-4) - friction(law, qd, g - 1e-4)) / 2e-4;
        EXPECT_NEAR(frictionLoadSlope(law, qd, g), quotient, 1e-9) << law.index() << " " << qd;
      }
      EXPECT_EQ(frictionLoadSlope(law, qd, 0.0), 0.0) << "none at the kink of |g|";
    }
  }
}

TEST(CheckFriction, RefusesFiguresThatALawCantHave) {
  const auto error = [](const FrictionLaw& law) {
    return errorOf([&] { checkFriction(law, "model arm: friction of joint one"); });
  };
  EXPECT_EQ(error(SmoothCoulomb{-1, 1, 1}),
            "model arm: friction of joint one: smooth_coulomb: fv: expected a finite number >= 0, "
            "got -1");
  EXPECT_THAT(error(SmoothCoulomb{1, -1, 1}), HasSubstr("fc: expected a finite number >= 0"));
  EXPECT_THAT(error(SmoothCoulomb{1, 1, 0}), HasSubstr("width: expected a finite number > 0"));
  EXPECT_THAT(error(SmoothCoulomb{1, 1, 1, kNaN}), HasSubstr("shift: expected a finite number"));
  EXPECT_THAT(error(SmoothCoulomb{1, 1, 1, 0, 0, -0.1}), HasSubstr("fl: expected a finite number"));
  EXPECT_THAT(error(SmoothCoulomb{1, 1, 1, 0, 0, 0, -1, 1}), HasSubstr("fs: expected a finite"));
  EXPECT_THAT(error(SmoothCoulomb{1, 1, 1, 0, 0, 0, 1}),
              HasSubstr("vs: expected a finite number > 0, got 0"));
  EXPECT_THAT(error(CenteredSigmoid{1, kNaN, 0}), HasSubstr("centered_sigmoid: alpha: expected"));
  for (const FrictionLaw& law : kAllLaws) checkFriction(law, "every other law is accepted");
}

TEST(FrictionSlope, LeavesOutTheJumpAtRest) {
  EXPECT_EQ(frictionSlope(ViscousCoulombOffset{0.5, 2.0, 0.25}, 0.0, kLoad), 0.5);
}

TEST(FrictionSlope, IsFiniteForAnyFiniteVelocityAndNanForNan) {
  for (const FrictionLaw& law : kAllLaws) {
    for (const double qd : {1e3, 1e100, 1e300}) {
      EXPECT_TRUE(std::isfinite(frictionSlope(law, qd, kLoad))) << law.index() << " qd " << qd;
      EXPECT_TRUE(std::isfinite(frictionSlope(law, -qd, kLoad))) << law.index() << " qd " << -qd;
    }
    EXPECT_TRUE(std::isnan(frictionSlope(law, kNaN, kLoad))) << law.index();
  }
}

const auto kJoints = static_cast<Eigen::Index>(kAllLaws.size());

TEST(FrictionVector, EachJointHasItsOwnLaw) {
  const Eigen::VectorXd qd = Eigen::VectorXd::LinSpaced(kJoints, -1.0, 2.0);
  const Eigen::VectorXd g = Eigen::VectorXd::LinSpaced(kJoints, 30.0, -50.0);
  Eigen::VectorXd f = Eigen::VectorXd::Constant(kJoints, kNaN);
  frictionVector(kAllLaws, qd, g, f);
  for (Eigen::Index j = 0; j < kJoints; ++j) {
    EXPECT_EQ(f[j], friction(kAllLaws[static_cast<std::size_t>(j)], qd[j], g[j])) << "joint " << j;
  }
}

}  // namespace chain_dynamics::friction_test

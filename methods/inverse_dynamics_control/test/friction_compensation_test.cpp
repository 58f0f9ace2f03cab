// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/friction_compensation.hpp"

#include <gtest/gtest.h>

#include <chain_dynamics/friction_laws/viscous_coulomb_offset.hpp>
#include <chain_dynamics/model.hpp>
#include <cmath>
#include <limits>
#include <memory>

#include "arms.hpp"
#include "inverse_dynamics_control/model_terms.hpp"

namespace inverse_dynamics_control::friction_compensation_test {

const FrictionOptions kOptions{FrictionSource::kMeasuredVelocity, 0.1, 0.2, 0.8};

TEST(FrictionCompensation, WeightIsZeroAtRestAndItsScaleAtSpeed) {
  const FrictionCompensation friction(kOptions, "law");
  EXPECT_EQ(friction.weight(0.0), 0.0);
  EXPECT_EQ(friction.weight(0.1), 0.0);
  EXPECT_EQ(friction.weight(-0.05), 0.0);
  EXPECT_NEAR(friction.weight(0.2), 0.4, kRounding);  // half way: half
  EXPECT_NEAR(friction.weight(-0.2), 0.4, kRounding);
  EXPECT_EQ(friction.weight(0.3), 0.8);
  EXPECT_EQ(friction.weight(-50.0), 0.8);
}

TEST(FrictionCompensation, FrictionThatJumpsAtRestIsCompensatedContinuously) {
  for (const double dead_band : {0.0, 0.1}) {
    const FrictionOptions options{FrictionSource::kReferenceVelocity, dead_band, 0.2, 1.0};
    const FrictionCompensation friction(options, "law");
    const auto compensated = [&](double v) {
      Eigen::VectorXd f = vec({Pendulum::friction(v)});
      friction.weigh(vec({v}), f);
      return f[0];
    };
    // The model jumps by 6 N m at rest. Weighted: its greatest slope is that of the weight,
    // 1.5 / 0.2 s/rad, times its greatest value there, plus its own slope of 2.
    const double step = 1e-4, steepest = 1.5 / 0.2 * 4.5 + 2.0;
    for (double v = -0.5; v < 0.5; v += step) {
      ASSERT_LE(std::abs(compensated(v + step) - compensated(v)), steepest * step) << "at " << v;
    }
    EXPECT_EQ(compensated(0.0), 0.0);
    EXPECT_NEAR(compensated(0.4), Pendulum::friction(0.4), kRounding);
  }
}

TEST(FrictionCompensation, SharesLeaveNoNanOfAnInfiniteVelocity) {
  for (const double viscous : {0.0, 0.25, 0.5, 1.0}) {
    Compensated shares;
    shares.friction = 0.5;
    shares.viscous = viscous;
    const ModelTerms terms(Pendulum::make(), shares, "law");
    const auto left = [&](double v) {
      Eigen::VectorXd f(1);
      terms.friction(vec({0.0}), vec({v}), f);
      return f[0];
    };
    EXPECT_NEAR(left(1.5), 0.5 * (3.0 - 0.8) + (1.0 - viscous) * 3.0, kRounding);
    const double all = std::numeric_limits<double>::infinity();
    for (const double v : {all, -all}) EXPECT_EQ(left(v), viscous < 1 ? v : 0.0) << viscous;
    EXPECT_TRUE(std::isnan(left(std::nan(""))));
  }
}

/// Whose second motor turns with both joints.
class CoupledArm : public ChainSolver {
 public:
  CoupledArm() : ChainSolver(twoBars()), model_(twoBars()) {
    model_.friction = {chain_dynamics::ViscousCoulombOffset{3, 4, 0},
                       chain_dynamics::ViscousCoulombOffset{2, 1, 0}};
    model_.coupling = Eigen::Matrix2d{{1, 0}, {-0.5, 1}};
  }

 protected:
  void computeFriction(const ConstVectorRef& q, const ConstVectorRef& qd,
                       VectorRef f) const override {
    chain_dynamics::frictionVector(model_, q, qd, f);
  }

 private:
  chain_dynamics::Model model_;
};

// Motors turn at (1, 1.5) rad/s: viscous C' (3, 3) N m, the rest C' (4, 1) N m.
TEST(FrictionCompensation, SharesAreOfTheTorquesOfCoupledMotors) {
  const auto solver = std::make_shared<CoupledArm>();
  solver->initialize();
  Compensated shares;
  shares.friction = 0.5;
  shares.viscous = 0.75;
  const ModelTerms terms(solver, shares, "law");
  const Eigen::VectorXd qd = vec({1.0, 2.0}), zero = vec({0.0, 0.0});
  Eigen::VectorXd f(2);
  terms.friction(zero, qd, f);
  EXPECT_NEAR(f[0], 0.25 * 1.5 + 0.5 * 3.5, kRounding);
  EXPECT_NEAR(f[1], 0.25 * 3.0 + 0.5 * 1.0, kRounding);
  EXPECT_NEAR(terms.lostDamping(0, zero, qd), 0.25 * 1.5, kRounding);
  EXPECT_NEAR(terms.lostDamping(1, zero, qd), 0.25 * 3.0, kRounding);
}

TEST(FrictionCompensation, BadOptionsAreRefused) {
  const auto text = [](FrictionSource source, double dead_band, double blend, double scale) {
    return thrownBy([&] { FrictionCompensation({source, dead_band, blend, scale}, "law"); });
  };
  const auto measured = FrictionSource::kMeasuredVelocity;
  const auto desired = FrictionSource::kReferenceVelocity;
  EXPECT_EQ(text(desired, 0.0, 0.1, 1.0), "");
  EXPECT_EQ(text(desired, -0.1, 0.1, 1.0),
            "law: friction: dead_band: wrong value: expected a speed that isn't negative [rad/s], "
            "got -0.1; correct this number");
  EXPECT_EQ(text(measured, 0.0, 0.1, 1.0),
            "law: friction: dead_band: wrong value: expected a speed above zero [rad/s] with the "
            "measured velocity, got 0; take what the noise of a resting joint's velocity stays "
            "below");
  EXPECT_EQ(text(desired, 0.0, 0.0, 1.0),
            "law: friction: blend: wrong value: expected a speed above zero [rad/s], got 0; "
            "friction jumps at rest, so it must be blended in");
  EXPECT_EQ(text(desired, 0.0, 0.1, 1.5),
            "law: friction: scale: wrong value: expected a part from 0 to 1, got 1.5; more "
            "friction than there is would push the arm on");
  EXPECT_NE(text(desired, 0.0, kNan, 1.0), "");
  EXPECT_NE(text(desired, 0.0, 0.1, kNan), "");
}

}  // namespace inverse_dynamics_control::friction_compensation_test

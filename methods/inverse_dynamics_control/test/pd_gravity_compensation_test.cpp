// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/pd_gravity_compensation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "arms.hpp"
#include "inverse_dynamics_control/computed_torque.hpp"
#include "inverse_dynamics_control/feed_forward.hpp"
#include "inverse_dynamics_control/gravity_compensation.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/load_friction.hpp"

namespace inverse_dynamics_control::pd_gravity_compensation_test {

constexpr double kPeriod = 1e-3;  // s

const JointState kState = stateOf(vec({0.3, -1.0}), vec({0.7, 1.1}));
const Reference kReference = referenceOf(vec({0.4, -1.1}), vec({0.5, 1.3}), vec({2.0, -3.0}));
const PdGains kGains{vec({30.0, 20.0}), vec({3.0, 2.0})};

template <class Law>
Eigen::VectorXd torquesOf(Law& law) {
  Eigen::VectorXd tau(2);
  EXPECT_EQ(law.update(kState, kReference, kPeriod, tau), Status::kOk);
  return tau;
}

TEST(PdGravityCompensation, GravityAndGainsByHand) {
  const auto solver = ChainSolver::make(twoBars());
  PdGravityCompensation law(solver, kGains, unlimited(2));
  const Eigen::VectorXd g = solver->getGravityVector(kState.q);
  const Eigen::VectorXd feedback = vec({30.0 * 0.1 - 3.0 * 0.2, -20.0 * 0.1 + 2.0 * 0.2});
  EXPECT_LT((torquesOf(law) - g - feedback).norm(), 1e-12);
}

TEST(PdGravityCompensation, FrictionIsThatOfTheReferenceVelocity) {
  const auto solver = ChainSolver::make(twoBars());
  LawOptions options = unlimited(2);
  PdGravityCompensation without(solver, kGains, options);
  options.friction.source = FrictionSource::kReferenceVelocity;
  options.friction.blend = 0.1;
  PdGravityCompensation with(solver, kGains, options);
  const Eigen::VectorXd f = solver->getFrictionVector(kReference.qd);
  EXPECT_LT((torquesOf(with) - torquesOf(without) - f).norm(), 1e-12);
}

/// A pendulum whose friction grows with the gravity torque.
class LoadedPendulum : public Pendulum, public inverse_dynamics_solver::LoadFriction {
 public:
  static std::shared_ptr<LoadedPendulum> make() {
    auto solver = std::make_shared<LoadedPendulum>();
    solver->initialize();
    return solver;
  }

 protected:
  void computeFriction(const ConstVectorRef& q, const ConstVectorRef& qd,
                       VectorRef f) const override {
    f[0] = 0.5 * std::abs(9.81 * std::cos(q[0])) * std::tanh(qd[0]);
  }
  const InverseDynamicsSolver& torqueSolver() const override { return *this; }
  bool frictionDependsOnPositionImpl() const override { return true; }
};

TEST(FrictionCompensation, IsThatOfTheLoadAtThePositionOfTheLaw) {
  const auto solver = LoadedPendulum::make();
  LawOptions options = unlimited(1);
  options.friction.source = FrictionSource::kReferenceVelocity;
  const JointState state = stateOf(vec({0.3}), vec({0.7}));
  const Reference reference = referenceOf(vec({0.9}), vec({0.5}), vec({2.0}));
  LawOptions none = unlimited(1);
  none.friction.source = FrictionSource::kNone;
  const auto expect = [&](auto&& added, double q) {
    EXPECT_NEAR(added, 0.5 * 9.81 * std::cos(q) * std::tanh(0.5), 1e-12);
  };
  Eigen::VectorXd with(1), without(1);
  const Eigen::VectorXd effort = vec({0.0});

  GravityCompensation guided(solver, options), plain(solver, none);
  EXPECT_EQ(guided.update(state, reference.qd, kPeriod, with), Status::kOk);
  EXPECT_EQ(plain.update(state, reference.qd, kPeriod, without), Status::kOk);
  expect(with[0] - without[0], 0.3);

  for (const bool measured : {false, true}) {
    const ModelState at = measured ? ModelState::kMeasured : ModelState::kReference;
    FeedForward feed(solver, at, options), bare(solver, at, none);
    EXPECT_EQ(feed.update(state, reference, effort, kPeriod, with), Status::kOk);
    EXPECT_EQ(bare.update(state, reference, effort, kPeriod, without), Status::kOk);
    expect(with[0] - without[0], measured ? 0.3 : 0.9);
  }
}

TEST(PdGravityCompensation, GainsChangeWhileItRuns) {
  const auto solver = ChainSolver::make(twoBars());
  const PdGains other{vec({60.0, 10.0}), vec({1.0, 0.0})};
  PdGravityCompensation law(solver, kGains, unlimited(2));
  PdGravityCompensation expected(solver, other, unlimited(2));
  torquesOf(law);
  EXPECT_TRUE(law.setGains(other));
  EXPECT_EQ(torquesOf(law), torquesOf(expected));
}

TEST(ComputedTorqueGains, ChangeWhileItRuns) {
  const auto solver = ChainSolver::make(twoBars());
  ComputedTorque law(solver, Gains::uniform(2, 10.0, 1.0), unlimited(2));
  ComputedTorque expected(solver, Gains::uniform(2, 30.0, 0.5), unlimited(2));
  torquesOf(law);
  EXPECT_TRUE(law.setGains(Gains::uniform(2, 30.0, 0.5)));
  EXPECT_EQ(torquesOf(law), torquesOf(expected));
}

TEST(PdGravityCompensation, BadGainsChangeNothing) {
  const auto solver = ChainSolver::make(twoBars());
  PdGravityCompensation law(solver, kGains, unlimited(2));
  ComputedTorque computed_torque(solver, Gains::uniform(2, 10.0, 1.0), unlimited(2));
  const Eigen::VectorXd before = torquesOf(law);
  const Eigen::VectorXd computed_before = torquesOf(computed_torque);
  const Eigen::VectorXd good = vec({1.0, 1.0});
  for (const Eigen::VectorXd& bad : {vec({1.0}), vec({1.0, -1.0}), vec({kNan, 1.0}),
                                     vec({1.0, std::numeric_limits<double>::infinity()})}) {
    EXPECT_FALSE(law.setGains({bad, good}));
    EXPECT_FALSE(law.setGains({good, bad}));
    EXPECT_FALSE(computed_torque.setGains({bad, good}));
    EXPECT_FALSE(computed_torque.setGains({good, bad}));
  }
  EXPECT_EQ(torquesOf(law), before);
  EXPECT_EQ(torquesOf(computed_torque), computed_before);
}

TEST(PdGravityCompensation, BadGainsAreRefused) {
  const auto solver = ChainSolver::make(twoBars());
  const auto text = [&](const PdGains& gains) {
    return thrownBy([&] { PdGravityCompensation(solver, gains, unlimited(2)); });
  };
  EXPECT_EQ(text({vec({1.0}), vec({1.0, 1.0})}),
            "PD with gravity compensation: Kp: wrong size: expected 2 numbers [N m/rad], got 1; "
            "give one for each of the joints shoulder, elbow");
  EXPECT_EQ(text({vec({1.0, 1.0}), vec({1.0, -2.0})}),
            "PD with gravity compensation: Kd: joint elbow: wrong value: expected a finite number "
            "that isn't negative [N m s/rad], got -2; correct this number");
}

}  // namespace inverse_dynamics_control::pd_gravity_compensation_test

// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "allocation_guard.hpp"
#include "chain_dynamics/dynamic_components.hpp"
#include "chain_dynamics/model_file.hpp"
#include "chain_dynamics/torques.hpp"
#include "example_robots.hpp"
#include "reference.hpp"

namespace chain_dynamics::model_test {

using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Model robotModel(const std::string& name) {
  return modelFromFile(std::string(CHAIN_DYNAMICS_ROBOTS_DIR) + "/models/" + name + ".yaml");
}

/// All that a Model gives at one state.
struct Values {
  explicit Values(Eigen::Index n)
      : H(n, n), H_alone(n, n), C(n, n), c(n), c_alone(n), g(n), g_alone(n), f(n), tau(n) {}

  void compute(const Model& model, const Eigen::VectorXd& q, const Eigen::VectorXd& qd,
               const Eigen::VectorXd& qdd) {
    dynamicComponents(model, q, qd, H, c, g);
    inertiaMatrix(model, q, H_alone);
    coriolisVector(model, q, qd, c_alone);
    coriolisMatrix(model, q, qd, C);
    gravityVector(model, q, g_alone);
    frictionVector(model, q, qd, f);
    torques(model, q, qd, qdd, tau);
  }

  Eigen::MatrixXd H, H_alone, C;
  Eigen::VectorXd c, c_alone, g, g_alone, f, tau;
};

const char* const kModels[] = {"ur10_identified", "franka_inria_identified",
                               "franka_gaz2019_feasible"};

TEST(Model, TorquesAreTheSumOfTheComponents) {
  for (const char* name : kModels) {
    const Model model = robotModel(name);
    const Eigen::Index n = model.chain.jointCount();
    const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(n, -2, 1.5);
    const Eigen::VectorXd qd = Eigen::VectorXd::LinSpaced(n, 2, -1.7);
    const Eigen::VectorXd qdd = Eigen::VectorXd::LinSpaced(n, -5, 6);
    Values values(n);
    values.compute(model, q, qd, qdd);
    EXPECT_LT(difference(values.tau, values.H * qdd + values.c + values.g), kRounding) << name;
    EXPECT_LT(difference(values.H, values.H_alone), kRounding) << name;
    EXPECT_LT(difference(values.c, values.c_alone), kRounding) << name;
    EXPECT_LT(difference(values.g, values.g_alone), kRounding) << name;
    EXPECT_LT(difference(values.C * qd, values.c), kRounding) << name;
  }
}

// T = 1/2 qd' H qd; g is the gradient of U, here by central differences.
TEST(Model, EnergiesAreThoseOfInertiaAndGravity) {
  constexpr double kStep = 1e-5;
  constexpr double kDifferences = 1e-7;  // third derivatives of some 100 J, times step^2; rounding
  for (const bool own_gravity : {false, true}) {
    Model model = robotModel("franka_gaz2019_feasible");
    if (own_gravity) {
      model.gravity_parameters = robotModel("franka_inria_identified").gravity_parameters;
      ASSERT_FALSE(model.gravity_parameters.empty());
    }
    const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(7, -2, 1.5);
    const Eigen::VectorXd qd = Eigen::VectorXd::LinSpaced(7, 2, -1.7);
    Values values(7);
    values.compute(model, q, qd, qd);
    EXPECT_NEAR(kineticEnergy(model, q, qd), 0.5 * qd.dot(values.H * qd), kRounding);
    for (Eigen::Index i = 0; i < 7; ++i) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(7, i);
      const double rise = potentialEnergy(model, q + step) - potentialEnergy(model, q - step);
      EXPECT_NEAR(rise / (2 * kStep), values.g[i], kDifferences) << i << own_gravity;
    }
  }
}

// g = g_bodies + k (q - rest) + a sin(q) + b cos(q), and all that follows from it.
TEST(Model, SpringsAreAPartOfGravity) {
  constexpr double kStep = 1e-5;
  constexpr double kDifferences = 1e-7;
  const Model bare = robotModel("franka_gaz2019_feasible");
  Model model = bare;
  const Eigen::VectorXd k = Eigen::VectorXd::LinSpaced(7, 3, -9), rest = k / 20;
  model.stiffness = k;
  model.rest = rest;
  const Eigen::VectorXd a = 2 - rest.array(), b = 3 * rest;
  model.levers = Eigen::MatrixXd(2, 7);
  model.levers << a.transpose(), b.transpose();
  checkModel(model);
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(7, -2, 1.5), qd = -q, qdd = 2 * q;
  const Eigen::VectorXd torque =
      k.array() * (q - rest).array() + a.array() * q.array().sin() + b.array() * q.array().cos();
  const Eigen::VectorXd slope =
      k.array() + a.array() * q.array().cos() - b.array() * q.array().sin();
  Values without(7), with(7);
  without.compute(bare, q, qd, qdd);
  with.compute(model, q, qd, qdd);
  EXPECT_LT(difference(with.g, without.g + torque), kRounding);
  EXPECT_LT(difference(with.g_alone, without.g + torque), kRounding);
  EXPECT_LT(difference(with.tau, without.tau + torque), kRounding);
  EXPECT_EQ(with.H, without.H);
  EXPECT_EQ(with.c, without.c);
  for (Eigen::Index i = 0; i < 7; ++i) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(7, i);
    const double rise = potentialEnergy(model, q + step) - potentialEnergy(model, q - step);
    EXPECT_NEAR(rise / (2 * kStep), with.g[i], kDifferences) << i;
  }
  Eigen::MatrixXd by_q(7, 7), by_qd(7, 7), by_qdd(7, 7), by_q_bare(7, 7);
  torqueDerivatives(bare, q, qd, qdd, by_q_bare, by_qd, by_qdd);
  torqueDerivatives(model, q, qd, qdd, by_q, by_qd, by_qdd);
  EXPECT_LT(difference(by_q, by_q_bare + Eigen::MatrixXd(slope.asDiagonal())), kRounding);
  Eigen::VectorXd in_place = q;
  torques(model, in_place, qd, qdd, in_place);
  EXPECT_EQ(in_place, with.tau);
}

// Its mass hangs 1.5 m below the root frame's origin.
TEST(Model, PotentialEnergyIsZeroAtTheRootFramesOrigin) {
  const Model model(test::pendulum(2, 1.5, 9.81));
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, -std::acos(0.0));
  EXPECT_NEAR(potentialEnergy(model, q), -2 * 9.81 * 1.5, kRounding);
}

/// What the same geometry carries with nothing but the body.
Chain bodyAlone(const Chain& chain, const LinkParameters& body) {
  std::vector<Joint> joints = chain.joints();
  for (Joint& joint : joints) joint.rotor_inertia = 0;
  std::vector<LinkParameters> links(joints.size(), LinkParameters::zero());
  links.back() = chain.tip() * body;
  return Chain("body", joints, links, chain.gravity());
}

TEST(Model, BodyAtTheTipAddsItsOwnDynamicsToEachRow) {
  const Eigen::Matrix3d I_c = Eigen::Vector3d(0.011, 0.02, 0.025).asDiagonal();
  const auto body = LinkParameters::fromCenterOfMass(3.1, {0.02, -0.05, 0.11}, I_c);
  for (const char* name : kModels) {
    const Model bare = robotModel(name);
    const Model loaded = withBodyAtTip(bare, body);
    const Chain alone = bodyAlone(bare.chain, body);
    const Eigen::Index n = alone.jointCount();
    const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(n, -2, 1.5);
    const Eigen::VectorXd qd = Eigen::VectorXd::LinSpaced(n, 1, -0.5);
    const Eigen::VectorXd qdd = Eigen::VectorXd::LinSpaced(n, -3, 2);
    Values without(n), with(n), added(n);
    without.compute(bare, q, qd, qdd);
    with.compute(loaded, q, qd, qdd);
    added.compute(Model(alone), q, qd, qdd);
    ASSERT_GT(added.g.norm(), 1) << name;
    EXPECT_LT(difference(with.H - without.H, added.H), kRounding) << name;
    EXPECT_LT(difference(with.c - without.c, added.c), kRounding) << name;
    EXPECT_LT(difference(with.g - without.g, added.g), kRounding) << name;
    EXPECT_LT(difference(with.tau - without.tau, added.tau), 10 * kRounding) << name;
    EXPECT_EQ(with.f, without.f) << name;
    EXPECT_EQ(loaded.chain.warnings(), bare.chain.warnings()) << name;
  }
}

TEST(Model, BodyThatTheLastLinkCantTakeIsRefused) {
  const Model model = robotModel("franka_gaz2019_feasible");
  auto body = LinkParameters::zero();
  body.mass = -100;
  EXPECT_THROW(withBodyAtTip(model, body), ModelError);
  body.mass = kNaN;
  EXPECT_THROW(withBodyAtTip(model, body), ModelError);
}

TEST(Model, NothingAllocates) {
  if (!test::kAllocationGuardWorks) {
    GTEST_SKIP() << "allocations can't be counted under this sanitizer or C library";
  }
  for (const char* name : kModels) {
    const Model model = robotModel(name);
    const Eigen::Index n = model.chain.jointCount();
    const Eigen::VectorXd q = Eigen::VectorXd::Constant(n, 0.5);
    Values values(n);
    const test::AllocationGuard guard;
    values.compute(model, q, q, q);
    EXPECT_EQ(guard.count(), 0) << name;
  }
}

TEST(Model, ColumnsOfABatchAreWrittenInPlace) {
  const Model model = robotModel("ur10_identified");
  const Eigen::MatrixXd q = Eigen::MatrixXd::Constant(6, 3, 0.5);
  Eigen::MatrixXd tau(6, 3), H(6, 18);
  const test::AllocationGuard guard;
  torques(model, q.col(1), q.col(1), q.col(1), tau.col(1));
  inertiaMatrix(model, q.col(1), H.middleCols(6, 6));
  EXPECT_EQ(guard.count(), 0);
  Values values(6);
  values.compute(model, q.col(0), q.col(0), q.col(0));
  EXPECT_EQ(tau.col(1), values.tau);
  EXPECT_EQ(H.middleCols(6, 6), values.H_alone);
}

TEST(Model, NaNVelocityIsNaNFrictionEvenWithoutALaw) {
  const Model model(test::pendulum(1, 1, 9.81));
  Eigen::VectorXd f(1);
  frictionVector(model, Eigen::VectorXd(), Eigen::VectorXd::Constant(1, kNaN), f);
  EXPECT_TRUE(std::isnan(f[0]));
}

// --- physical or not ---

TEST(ModelInertia, ChainOfBodiesIsPhysical) {
  EXPECT_TRUE(Model(test::doublePendulum(1, 0.5, 2, 0.4, 9.81)).inertiaIsPhysical());
}

TEST(ModelInertia, BodyThatBreaksTheTriangleInequalityIsStillDefinite) {
  // no such body exists, but its kinetic energy is positive
  Vector10<double> p;
  p << 1, 0, 0, 0, 5, 0, 0, 0.1, 0, 0.1;
  const Model model(Chain("odd", {Joint{"j"}}, {LinkParameters::fromVector(p)}, {0, 0, -9.81}));
  EXPECT_FALSE(model.chain.warnings().empty());
  EXPECT_TRUE(model.inertiaIsPhysical());
}

TEST(ModelInertia, NegativeMomentAboutTheCenterOfMassIsNotPhysical) {
  // about the axis 0.1 - 1 * 0.5^2 < 0, though H = 0.1 is positive
  Vector10<double> p;
  p << 1, 0.5, 0, 0, 0.3, 0, 0, 0.5, 0, 0.1;
  const Model model(Chain("odd", {Joint{"j"}}, {LinkParameters::fromVector(p)}, {0, 0, -9.81}));
  EXPECT_FALSE(model.inertiaIsPhysical());
}

TEST(ModelInertia, JointThatMovesNothingIsNotPhysical) {
  const Chain chain("odd", {Joint{"one"}, Joint{"two"}},
                    {test::pointMass(1, {1, 0, 0}), LinkParameters::zero()}, {0, 0, -9.81});
  EXPECT_FALSE(Model(chain).inertiaIsPhysical());
}

TEST(ModelInertia, RowsOfTheirOwnAreNotPhysical) {
  Model model(test::pendulum(1, 1, 9.81));
  ASSERT_TRUE(model.inertiaIsPhysical());
  model.row_parameters = {model.chain.links()};
  EXPECT_FALSE(model.inertiaIsPhysical());
}

// --- parts that don't fit ---

TEST(ModelError, PartsMustFit) {
  const Model pendulum(test::pendulum(1, 1, 9.81));
  const auto error = [](const Model& model) { return errorOf([&] { checkModel(model); }); };
  EXPECT_EQ(error(pendulum), "no error");

  Model model = pendulum;
  model.friction.resize(2);
  EXPECT_EQ(error(model),
            "model pendulum: friction: expected no law, or one per joint (1), got 2; name further "
            "laws in friction_places");
  model.friction = {ViscousCoulombOffset{kNaN, 0, 0}};
  EXPECT_THAT(error(model),
              HasSubstr("friction of joint pivot: viscous_coulomb_offset: fv: expected a finite"));

  model = pendulum;
  model.drive_gains.resize(3);
  EXPECT_THAT(error(model), HasSubstr("drive gains: expected none, or one per joint (1), got 3"));
  model.drive_gains = Eigen::VectorXd::Constant(1, -2);
  EXPECT_THAT(error(model), HasSubstr("drive gain of joint pivot: expected a finite number > 0"));

  model = pendulum;
  model.torque_deviation.setZero(2);
  EXPECT_THAT(error(model), HasSubstr("torque deviations: expected none, or one per joint (1)"));
  model.torque_deviation = Eigen::VectorXd::Constant(1, kNaN);
  EXPECT_THAT(error(model), HasSubstr("torque deviation of joint pivot: expected a finite number"));

  model = pendulum;
  model.seen.resize(2);
  EXPECT_THAT(error(model), HasSubstr("seen ranges: expected none, or one per joint (1), got 2"));
  model.seen = {{{1, 0}, {0, 1}, {0, 1}}};
  EXPECT_THAT(error(model), HasSubstr("seen range of joint pivot: expected finite numbers"));

  model = pendulum;
  model.stiffness = Eigen::VectorXd::Constant(1, 5);
  EXPECT_THAT(error(model), HasSubstr("springs at rest: expected a position for each stiffness"));
  model.rest = Eigen::VectorXd::Constant(1, kNaN);
  EXPECT_THAT(error(model), HasSubstr("spring of joint pivot: expected finite numbers"));
  model.rest[0] = 0.1;
  EXPECT_EQ(error(model), "no error");
  model.gravity_parameters = model.chain.links();
  EXPECT_THAT(error(model), HasSubstr("parameters of a robot with springs: expected one set"));
  model.gravity_parameters.clear();
  std::vector<Joint> joints = model.chain.joints();
  joints[0].type = JointType::kContinuous;
  model.chain = Chain("pendulum", joints, model.chain.links(), model.chain.gravity());
  EXPECT_THAT(error(model), HasSubstr("spring of joint pivot: expected a joint with limits"));

  model = pendulum;
  model.gravity_parameters.resize(2, LinkParameters::zero());
  EXPECT_THAT(error(model), HasSubstr("parameter set of gravity"));
}

}  // namespace chain_dynamics::model_test

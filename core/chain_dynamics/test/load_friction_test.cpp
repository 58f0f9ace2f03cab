// SPDX-License-Identifier: Apache-2.0

// Friction that depends on the gravity torques: of a model as it is, with its payload and gravity.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "allocation_guard.hpp"
#include "chain_dynamics/error.hpp"
#include "chain_dynamics/fast_model.hpp"
#include "chain_dynamics/model_file.hpp"
#include "example_models.hpp"
#include "example_robots.hpp"

namespace chain_dynamics::load_friction_test {

using namespace test;  // NOLINT(google-build-using-namespace)
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd frictionOf(const Model& model, const VectorXd& q, const VectorXd& qd) {
  VectorXd f(q.size());
  frictionVector(model, q, qd, f);
  return f;
}

VectorXd gravityOf(const Model& model, const VectorXd& q) {
  VectorXd g(q.size());
  gravityVector(model, q, g);
  return g;
}

std::vector<NamedModel> loadedModels() {
  std::vector<NamedModel> loaded;
  for (const NamedModel& named : models()) {
    if (frictionDependsOnLoad(named.model)) loaded.push_back(named);
  }
  return loaded;
}

// 2 kg at 1.5 m: g = 2 9.81 1.5 cos(q) N m; 3 + 0.2 |g| far from the step.
TEST(LoadFriction, OfAPendulumWorkedByHand) {
  Model model(pendulum(2, 1.5, 9.81));
  model.friction = {SmoothCoulomb{0, 3, 1e-3, 0, 0, 0.2}};
  const VectorXd down = VectorXd::Zero(1), side = VectorXd::Constant(1, std::acos(0.0));
  const double most = std::max(gravityOf(model, down).norm(), gravityOf(model, side).norm());
  EXPECT_NEAR(most, 2 * 9.81 * 1.5, 1e-12);
  const VectorXd fast = VectorXd::Constant(1, 1.0);
  for (const VectorXd& q : {down, side}) {
    const double load = std::abs(gravityOf(model, q)[0]);
    EXPECT_NEAR(frictionOf(model, q, fast)[0], 3 + 0.2 * load, 1e-12);
    EXPECT_NEAR(frictionOf(model, q, -fast)[0], -3 - 0.2 * load, 1e-12);
  }
}

TEST(LoadFriction, CountsABodyAtTheTipAndGravity) {
  const LinkParameters body = LinkParameters::fromCenterOfMass(
      3.1, {0.02, -0.05, 0.11}, Eigen::Vector3d(0.1, 0.2, 0.25).asDiagonal());
  for (const auto& [name, model] : loadedModels()) {
    const State<double> x = randomState(model.chain, 1);
    Model loaded = withBodyAtTip(model, body);
    Model turned = model;
    turned.chain = turned.chain.withGravity({1, -2, 3});
    for (const Model& changed : {loaded, turned}) {
      const VectorXd g = gravityOf(changed, x.q), f = frictionOf(changed, x.q, x.qd);
      EXPECT_NE(f, frictionOf(model, x.q, x.qd)) << name;
      for (Index j = 0; j < g.size() && model.coupling.size() == 0; ++j) {
        // but for what a compiler contracts in one place and not in another
        EXPECT_DOUBLE_EQ(f[j],
                         friction(model.friction[static_cast<std::size_t>(j)], x.qd[j], g[j]));
      }
    }
  }
}

// v = (1, 2 - 0.5) rad/s of the motors, whose friction is 3 v + 4: (7, 8.5) N m.
TEST(CoupledMotors, ByHand) {
  Model model(revolute(randomChain(2)));
  model.friction = {ViscousCoulombOffset{3, 4, 0}, ViscousCoulombOffset{3, 4, 0}};
  model.coupling = Eigen::Matrix2d{{1, 0}, {-0.5, 1}};
  checkModel(model);
  const Eigen::Vector2d expected(7 - 0.5 * 8.5, 8.5), qd(1, 2);
  EXPECT_EQ(frictionOf(model, VectorXd::Zero(2), qd), expected);
  const Model again = modelFromYaml(modelFileText(model), "written");
  EXPECT_EQ(again.coupling, model.coupling);
  EXPECT_EQ(frictionOf(again, VectorXd::Zero(2), qd), expected);
}

// A third law between both joints, at 2 - 1 rad/s: f = 5 N m.
TEST(CoupledMotors, LawsBesideThoseOfJointsByHand) {
  Model model(revolute(randomChain(2)));
  model.friction = {ViscousCoulombOffset{3, 4, 0}, SmoothCoulomb{0, 3, 1e-3, 0, 0, 0.2},
                    ViscousCoulombOffset{1, 4, 0}};
  model.friction_places = {"elbow"};
  model.coupling = Eigen::MatrixXd{{1, 0}, {0, 1}, {-1, 1}};
  checkModel(model);
  const VectorXd q = VectorXd::Constant(2, 0.3);
  const Eigen::Vector2d qd(1, 2);
  const double load = 0.2 * std::abs(gravityOf(model, q)[1]);
  EXPECT_LT((frictionOf(model, q, qd) - Eigen::Vector2d(7 - 5, 3 + load + 5)).norm(), 1e-12);
  MatrixXd by_q = MatrixXd::Zero(2, 2), by_qd = by_q;
  addFrictionDerivatives(model, q, qd, by_q, by_qd);
  EXPECT_LT((by_qd - Eigen::Matrix2d{{4, -1}, {-1, 1}}).norm(), 1e-12);
  const Model again = modelFromYaml(modelFileText(model), "written");
  EXPECT_EQ(again.friction_places, model.friction_places);
  EXPECT_EQ(again.coupling, model.coupling);
  EXPECT_EQ(frictionOf(again, q, qd), frictionOf(model, q, qd));
}

TEST(CoupledMotors, AreRefusedWhereLawsDoNotFitTheirPlaces) {
  Model model(revolute(randomChain(2)));
  model.friction = {ViscousCoulombOffset{}, ViscousCoulombOffset{},
                    SmoothCoulomb{0, 3, 1, 0, 0, 1}};
  const auto refuses = [&](const char* text) {
    EXPECT_THAT([&] { checkModel(model); },
                testing::ThrowsMessage<ModelError>(testing::HasSubstr(text)));
  };
  model.coupling = Eigen::MatrixXd{{1, 0}, {0, 1}, {0, 1}};
  refuses("name further laws in friction_places");
  model.friction_places = {"elbow"};
  refuses("friction of elbow: expected no load term fl");
  model.friction[2] = ViscousCoulombOffset{1, 0, 0};
  checkModel(model);
  model.coupling(2, 1) = 0;
  refuses("coupling of elbow: expected a number other than zero");
  model.coupling = {};
  refuses("a law and a row of coupling for each of 2 joints and 1 places");
  model.friction.clear();  // of a solver without friction
  checkModel(model);
}

TEST(CoupledMotors, HaveNoLoadFrictionWhereTheyMoveOtherJoints) {
  Model model(revolute(randomChain(2)));
  model.friction = {SmoothCoulomb{0, 3, 0.1, 0, 0, 0.2}, SmoothCoulomb{0, 3, 0.1, 0, 0, 0.2}};
  model.coupling = Eigen::Matrix2d{{1, 0}, {-0.5, 1}};
  EXPECT_THAT([&] { checkModel(model); },
              testing::ThrowsMessage<ModelError>(testing::HasSubstr("no load term fl")));
  model.coupling = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_THAT(
      [&] { checkModel(model); },
      testing::ThrowsMessage<ModelError>(testing::HasSubstr("2 x 2 finite numbers, got 3 x 3")));
  model.coupling = Eigen::Matrix2d{{1, 0}, {std::nan(""), 1}};
  EXPECT_THAT([&] { checkModel(model); },
              testing::ThrowsMessage<ModelError>(testing::HasSubstr("2 x 2, not all finite")));
}

TEST(CoupledMotors, AreNotWrittenWithoutFriction) {
  Model model(revolute(randomChain(2)));
  model.coupling = Eigen::Matrix2d{{1, 0}, {-0.5, 1}};
  checkModel(model);
  EXPECT_EQ(modelFromYaml(modelFileText(model), "written").coupling.size(), 0);
}

TEST(LoadFriction, NeedsNoPositionsWhereNoLawDependsOnLoad) {
  for (const auto& [name, model] : models()) {
    const FastModel fast(model);
    EXPECT_EQ(fast.frictionDependsOnLoad(), frictionDependsOnLoad(model)) << name;
    if (frictionDependsOnLoad(model)) continue;
    const State<double> x = randomState(model.chain, 1);
    EXPECT_EQ(frictionOf(model, x.q, x.qd), frictionOf(model, x.q + x.qd, x.qd)) << name;
    VectorXd without(x.qd.size()), f(without);
    frictionVector(model, VectorXd(), x.qd, without);
    EXPECT_EQ(without, frictionOf(model, x.q, x.qd)) << name;
    fast.frictionVector(x.q.data(), x.qd.data(), f.data());
    fast.frictionVector(nullptr, x.qd.data(), without.data());
    EXPECT_EQ(f, without) << name;
    fast.frictionVectorBatch(ConstStates(nullptr, 0, 1, 1, 0), x.qd, without);
    EXPECT_LT((f - without).norm(), 1e-12 * (1 + f.norm())) << name;
  }
}

// The five-point rule: its error is h^4 / 30 times a fifth derivative, (2 / width)^4 of the step.
TEST(LoadFriction, DerivativesAreThoseOfTheTorques) {
  constexpr double kStep = 2e-5;
  for (const auto& [name, loaded] : loadedModels()) {
    const auto& model = loaded;  // as C++17's lambdas don't capture structured bindings
    const Index n = model.chain.jointCount();
    const State<double> x = randomState(model.chain, 3);
    MatrixXd by_q = MatrixXd::Zero(n, n), by_qd = MatrixXd::Zero(n, n);
    addFrictionDerivatives(model, x.q, x.qd, by_q, by_qd);
    EXPECT_EQ(by_qd.isDiagonal(0), model.coupling.size() == 0) << name;
    const auto quotient = [](const auto& f) {
      return VectorXd((f(-2 * kStep) - f(2 * kStep) + 8 * (f(kStep) - f(-kStep))) / (12 * kStep));
    };
    const double size = 1 + largest(by_q) + largest(frictionOf(model, x.q, x.qd));
    for (Index j = 0; j < n; ++j) {
      const VectorXd unit = VectorXd::Unit(n, j);
      const VectorXd q_column =
          quotient([&](double h) { return frictionOf(model, x.q + h * unit, x.qd); });
      const VectorXd qd_column =
          quotient([&](double h) { return frictionOf(model, x.q, x.qd + h * unit); });
      EXPECT_LT(largest(by_q.col(j) - q_column), 1e-8 * size) << name << ", joint " << j;
      EXPECT_LT(largest(by_qd.col(j) - qd_column), 1e-6 * (size + largest(by_qd))) << name;
    }
  }
}

TEST(LoadFriction, HasNoDerivativeByPositionWhereTheLoadIsZero) {
  Model model(pendulum(2, 1.5, 9.81));
  model.chain = model.chain.withGravity(Eigen::Vector3d::Zero());
  model.friction = {SmoothCoulomb{1, 3, 0.1, 0, 0, 0.2}};
  MatrixXd by_q = MatrixXd::Zero(1, 1), by_qd = MatrixXd::Zero(1, 1), H(1, 1);
  const VectorXd x = VectorXd::Constant(1, 0.3);
  addFrictionDerivatives(model, x, x, by_q, by_qd);
  EXPECT_EQ(by_q(0, 0), 0);
  for (const std::string& set : FastModel::instructionSets()) {
    FastModel(model, set)
        .torqueDerivatives(x.data(), x.data(), x.data(), by_q.data(), by_qd.data(), H.data(), 1);
    EXPECT_EQ(by_q(0, 0), 0) << set;
  }
}

TEST(LoadFriction, AllocatesNothing) {
  if (!kAllocationGuardWorks) {
    GTEST_SKIP() << "allocations are counted with the GNU C library, without sanitizers";
  }
  for (const auto& [name, model] : loadedModels()) {
    const State<double> x = randomState(model.chain, 1);
    const Index n = x.q.size();
    VectorXd f(n);
    MatrixXd by_q = MatrixXd::Zero(n, n), by_qd = by_q, F(n, 20);
    const MatrixXd q = x.q.replicate(1, 20), qd = x.qd.replicate(1, 20);
    const FastModel fast(model);
    const AllocationGuard guard;
    frictionVector(model, x.q, x.qd, f);
    addFrictionDerivatives(model, x.q, x.qd, by_q, by_qd);
    fast.frictionVector(x.q.data(), x.qd.data(), f.data());
    fast.frictionVectorBatch(q, qd, F);
    EXPECT_EQ(guard.count(), 0) << name;
  }
}

}  // namespace chain_dynamics::load_friction_test

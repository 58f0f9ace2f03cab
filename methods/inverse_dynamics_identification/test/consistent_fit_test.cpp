// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/consistent_fit.hpp"

#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <chain_dynamics/error.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/regressor_gram.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

#include "arms.hpp"
#include "penalties.hpp"

namespace inverse_dynamics_identification::consistent_fit_test {

using chain_dynamics::FastModel;
using chain_dynamics::Model;
using chain_dynamics::ModelError;
using chain_dynamics::RegressorGram;
using ::testing::HasSubstr;

constexpr double kNoise = 0.01;  // N m

/// Gram matrices with the columns qdd, qd.
RegressorGram gramOf(const Chain& chain, const Motion& motion) {
  RegressorGram gram(chain.jointCount(), 2);
  FastModel(Model(chain))
      .addToGram({motion.q, motion.qd, motion.qdd, motion.tau, {motion.qdd, motion.qd}}, gram);
  return gram;
}

Prior priorOf(const Chain& chain) {
  Prior prior;
  for (const LinkParameters& link : chain.links()) prior.links.push_back(linkPrior(link).link);
  prior.own.assign(2 * prior.links.size(), OwnColumn::positive());
  return prior;
}

Chain withParameters(const Chain& chain, const OwnedMatrix& parameters) {
  std::vector<LinkParameters> links;
  for (Eigen::Index j = 0; j < parameters.cols(); ++j) {
    const Eigen::Matrix<double, 10, 1> p = parameters.col(j);
    links.push_back(LinkParameters::fromVector(p));
  }
  return Chain(chain.name(), chain.joints(), links, chain.gravity());
}

/// Torques of a fit at the states of a motion.
Eigen::MatrixXd torquesOf(const Fit& fit, const Chain& chain, const Motion& motion) {
  Eigen::MatrixXd tau(motion.q.rows(), motion.q.cols());
  FastModel(Model(withParameters(chain, fit.parameters)))
      .torquesBatch(motion.q, motion.qd, motion.qdd, tau);
  for (Eigen::Index j = 0; j < tau.rows(); ++j) {
    tau.row(j) += fit.own(0, j) * motion.qdd.row(j) + fit.own(1, j) * motion.qd.row(j);
  }
  return tau;
}

/// The motion of an arm with rotor inertia, viscous friction and noise.
Motion measured(const Chain& arm, Eigen::Index count, unsigned seed) {
  Motion motion = randomMotion(arm, count, seed);
  motion.tau += 0.3 * motion.qdd + 0.8 * motion.qd + noise(3, count, kNoise, seed + 1);
  return motion;
}

/// Whether the pseudo-inertia of each link is positive definite.
bool linksCanExist(const Fit& fit) {
  for (Eigen::Index j = 0; j < fit.parameters.cols(); ++j) {
    const Eigen::Matrix<double, 10, 1> p = fit.parameters.col(j);
    const Eigen::Matrix4d P = pseudoInertia(LinkParameters::fromVector(p));
    if (P.llt().info() != Eigen::Success) return false;
  }
  return true;
}

TEST(ConsistentFit, FindsAKnownRobotFromAWrongDescription) {
  const Chain description = threeJointArm(0.6);
  const Motion motion = measured(threeJointArm(), 3000, 1);
  FitOptions options;
  options.prior_strength = 0.1;
  const Fit fit = consistentFit(gramOf(description, motion), priorOf(description), options);
  // noise estimated from 9000 numbers
  EXPECT_LT((fit.noise.array() / kNoise - 1).abs().maxCoeff(), 0.05) << fit.noise.transpose();
  const Motion other = measured(threeJointArm(), 1000, 7);
  const Eigen::MatrixXd error = torquesOf(fit, description, other) - other.tau;
  EXPECT_LT(std::sqrt(error.array().square().mean()), 1.1 * kNoise);
  EXPECT_NEAR(fit.own(1, 2), 0.8, 0.01);
  EXPECT_TRUE(linksCanExist(fit));
}

TEST(ConsistentFit, IsThePriorWhereTheDataSayNothing) {
  const Chain description = threeJointArm();
  const Motion motion = measured(threeJointArm(2), 100, 3);
  FitOptions options;
  options.prior_strength = 1e12;
  options.noise_iterations = 1;
  const Fit fit = consistentFit(gramOf(description, motion), priorOf(description), options);
  for (Eigen::Index j = 0; j < 3; ++j) {
    const Eigen::Matrix<double, 10, 1> expected =
        description.links()[static_cast<std::size_t>(j)].toVector();
    // the data still pull, with 1e12 against them
    EXPECT_LT((fit.parameters.col(j) - expected).cwiseAbs().maxCoeff(), 1e-3) << j;
  }
}

TEST(ConsistentFit, IsARobotWhateverTheTorquesAre) {
  const Chain description = threeJointArm();
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Motion motion = randomMotion(description, 30, seed);
    motion.tau = noise(3, 30, 100, seed);
    FitOptions options;
    options.prior_strength = 1e-3;
    const Fit fit = consistentFit(gramOf(description, motion), priorOf(description), options);
    EXPECT_TRUE(linksCanExist(fit)) << seed;
    EXPECT_GT(fit.own.minCoeff(), 0) << seed;
  }
}

TEST(ConsistentFit, IsAMinimum) {
  const Chain description = threeJointArm(0.6);
  const Motion motion = measured(threeJointArm(), 300, 5);
  const RegressorGram gram = gramOf(description, motion);
  const Prior prior = priorOf(description);
  FitOptions options;
  options.prior_strength = 3;
  const Fit fit = consistentFit(gram, prior, options);
  Eigen::MatrixXd A(gram.unknowns(), gram.unknowns());
  Eigen::VectorXd b(gram.unknowns()), x(gram.unknowns());
  gram.normalEquations(fit.weighed_by.array().square().inverse().matrix(), A, b);
  x << Eigen::Map<const Eigen::VectorXd>(fit.parameters.data(), 30),
      Eigen::Map<const Eigen::VectorXd>(fit.own.data(), 6);
  const double squares =
      (motion.tau.array().square().rowwise().sum() / fit.weighed_by.array().square()).sum();
  const Penalties penalties(prior);
  const auto cost = [&](const Eigen::VectorXd& at) {
    return at.dot(A * at) - 2 * b.dot(at) + squares + penalties.value(3, at);
  };
  EXPECT_NEAR(fit.cost, cost(x), 1e-9 * fit.cost);
  std::mt19937 random(1);
  for (int k = 0; k < 1000; ++k) {
    const Eigen::VectorXd other =
        x.array() * (1 + uniform(x.size(), 1, std::pow(10.0, -k % 8), random).array());
    EXPECT_GE(cost(other), fit.cost * (1 - 1e-9)) << k;
  }
}

TEST(ConsistentFit, DoesNotDependOnLinkFrames) {
  const Chain description = threeJointArm(0.6), moved = withFramesMoved(description);
  const Motion motion = measured(threeJointArm(), 40, 11);
  FitOptions options;
  options.prior_strength = 10;
  const Fit here = consistentFit(gramOf(description, motion), priorOf(description), options);
  const Fit there = consistentFit(gramOf(moved, motion), priorOf(moved), options);
  const Motion other = randomMotion(description, 100, 3);
  const Eigen::MatrixXd tau = torquesOf(here, description, other);
  const Eigen::MatrixXd difference = torquesOf(there, moved, other) - tau;
  // both are within 1e-9 of the least cost
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-4 * tau.cwiseAbs().maxCoeff());
  EXPECT_NEAR(here.cost, there.cost, 1e-6 * here.cost);
}

TEST(ConsistentFit, BeginsWithAnotherFit) {
  const Chain description = threeJointArm(0.6);
  const RegressorGram gram = gramOf(description, measured(threeJointArm(), 300, 5));
  const Prior prior = priorOf(description);
  FitOptions options;
  options.noise = Eigen::VectorXd::Constant(3, kNoise);
  options.noise_iterations = 1;
  const Fit first = consistentFit(gram, prior, options);
  const Fit again = consistentFit(gram, prior, options, &first);
  EXPECT_LT(again.newton_steps, 3);
  EXPECT_GT(first.newton_steps, again.newton_steps);
  EXPECT_NEAR(again.cost, first.cost, 1e-8 * first.cost);
}

TEST(ConsistentFit, BeginsWithAnotherFitWhoseCoefficientsAreBeyondTheirLimits) {
  const Chain description = threeJointArm(0.6);
  const RegressorGram gram = gramOf(description, measured(threeJointArm(), 300, 5));
  const Fit first = consistentFit(gram, priorOf(description));
  Fit beyond = first;
  beyond.own.row(1).setZero();  // viscous friction, which is positive
  FitOptions options;
  options.noise = first.noise;
  const Fit again = consistentFit(gram, priorOf(description), options, &beyond);
  EXPECT_LT(again.newton_steps, first.newton_steps / 2);
  EXPECT_NEAR(again.cost, first.cost, 1e-6 * first.cost);
}

TEST(ConsistentFit, StaysBelowTheMost) {
  const Chain description = threeJointArm();
  const Motion motion = measured(description, 300, 5);
  Prior prior = priorOf(description);
  for (std::size_t k = 1; k < prior.own.size(); k += 2) prior.own[k].most = 0.5;
  const Fit fit = consistentFit(gramOf(description, motion), prior);
  EXPECT_LT(fit.own.row(1).maxCoeff(), 0.5);
  EXPECT_GT(fit.own.row(1).minCoeff(), 0.4);  // 0.8 would fit best
}

TEST(ConsistentFit, InformationIsTheCurvatureOfTheCost) {
  const Chain description = threeJointArm(0.6);
  const RegressorGram gram = gramOf(description, measured(threeJointArm(), 300, 5));
  const Prior prior = priorOf(description);
  const FitOptions options;
  const Fit fit = consistentFit(gram, prior, options);
  const Information found = information(gram, prior, options, fit);
  Eigen::MatrixXd A(36, 36);
  Eigen::VectorXd b(36);
  gram.normalEquations(fit.weighed_by.array().square().inverse().matrix(), A, b);
  EXPECT_LT((found.data - A).cwiseAbs().maxCoeff(), 1e-9 * A.cwiseAbs().maxCoeff());
  const Penalties penalties(prior);
  Eigen::VectorXd x(36);
  x << Eigen::Map<const Eigen::VectorXd>(fit.parameters.data(), 30),
      Eigen::Map<const Eigen::VectorXd>(fit.own.data(), 6);
  for (const Eigen::Index k : {0, 3, 9, 14, 25, 30, 35}) {
    const double step = 1e-4 * std::abs(x[k]);
    Eigen::VectorXd above = x, below = x;
    above[k] += step;
    below[k] -= step;
    const double second =
        (penalties.value(100, above) - 2 * penalties.value(100, x) + penalties.value(100, below)) /
        (step * step);
    EXPECT_NEAR(found.prior(k, k), 0.5 * second, 1e-3 * std::abs(second)) << k;
  }
}

TEST(ConsistentFit, RefusesWhatDoesNotFit) {
  const Chain description = threeJointArm();
  const RegressorGram gram = gramOf(description, measured(description, 100, 5));
  Prior prior = priorOf(description);
  FitOptions options;
  options.prior_strength = 0;
  EXPECT_THROW(consistentFit(gram, prior, options), ModelError);
  options = {};
  options.noise = Eigen::VectorXd::Constant(2, 1.0);
  EXPECT_THROW(consistentFit(gram, prior, options), ModelError);
  EXPECT_THROW(consistentFit(RegressorGram(3, 2), prior), ModelError);
  prior.own.pop_back();
  EXPECT_THROW(consistentFit(gram, prior), ModelError);
  prior = priorOf(description);
  prior.links[1].mass = -1;
  EXPECT_THROW(consistentFit(gram, prior), ModelError);
  Motion broken = measured(description, 100, 5);
  broken.tau(1, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(consistentFit(gramOf(description, broken), priorOf(description)), ModelError);
}

TEST(ConsistentFit, RefusesAColumnThatNothingDetermines) {
  const Chain description = threeJointArm();
  Motion motion = measured(description, 100, 5);
  RegressorGram gram(3, 1);
  const Eigen::MatrixXd zeros = Eigen::MatrixXd::Zero(3, 100);
  FastModel(Model(description))
      .addToGram({motion.q, motion.qd, motion.qdd, motion.tau, {zeros}}, gram);
  Prior prior = priorOf(description);
  prior.own.assign(3, OwnColumn{});
  try {
    consistentFit(gram, prior);
    FAIL();
  } catch (const ModelError& error) {
    EXPECT_THAT(error.what(), HasSubstr("own columns"));
  }
}

}  // namespace inverse_dynamics_identification::consistent_fit_test

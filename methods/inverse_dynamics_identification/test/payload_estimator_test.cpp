// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/payload_estimator.hpp"

#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/friction_memory.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "inverse_dynamics_identification/tip_regressor.hpp"
#include "moving_arm.hpp"
#include "payload_solution.hpp"

namespace inverse_dynamics_identification {
namespace {

using testing::HasSubstr;
using Index = Eigen::Index;

constexpr double kPeriod = 0.01;  // s
constexpr double kRounding = 1e-9;
constexpr double kSettled = 1e-7;  // where rounds end that move the prior to the estimate

/// Takes a motion with a body and noise; returns what the estimator says.
PayloadEstimate estimateOf(PayloadEstimator& estimator, const InverseDynamicsSolver& loaded,
                           double seconds, Noise* noise = nullptr,
                           const Eigen::VectorXd& offset = Eigen::VectorXd::Zero(kJoints),
                           double begin = 0.0, double speed = 1.0) {
  Motion motion;
  motion.speed = speed;
  auto friction = frictionState(loaded);
  for (Index k = 0; k < std::lround(seconds / kPeriod); ++k) {
    const double time = begin + kPeriod * static_cast<double>(k);
    motion.at(time);
    Eigen::VectorXd measured = loaded.getTorques(motion.q, motion.qd, motion.qdd) + offset;
    friction.move(motion.q);
    friction.addTo(motion.qd, measured);
    if (noise != nullptr) measured += noise->next(kPeriod);
    EXPECT_EQ(estimator.update(time, motion.q, motion.qd, motion.qdd, measured),
              PayloadStatus::kOk);
  }
  PayloadEstimate found(kJoints);
  EXPECT_EQ(estimator.estimate(found), PayloadStatus::kOk);
  return found;
}

std::shared_ptr<Solver> pandaWith(const RigidBody& body) {
  auto solver = panda();
  solver->setPayload("load", body);
  return solver;
}

/// Of an arm whose model is exact.
PayloadOptions optionsWith(const ResidualNoise& noise) {
  PayloadOptions options;
  options.noise = noise;
  options.model_error = 0.0;
  return options;
}

TEST(TipRegressor, TimesABodyIsWhatCarryingItAdds) {
  for (const double tilt : {0.0, 0.4}) {
    const auto solver = panda();
    solver->setGravity({9.81 * std::sin(tilt), 0.0, -9.81 * std::cos(tilt)});
    solver->setBaseAcceleration({0.3, 0.2, tilt});
    TipRegressor regressor(solver);
    Motion motion;
    Eigen::MatrixXd Y(kJoints, 10);
    RigidBody body = box(2.5);
    body.frame = {Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(),
                  Eigen::Vector3d(0.1, 0.2, -0.1)};
    for (const double time : {0.0, 0.4, 1.7, 9.0}) {
      motion.at(time);
      solver->clearPayloads();
      const Eigen::VectorXd without = solver->getTorques(motion.q, motion.qd, motion.qdd);
      solver->setPayload("load", body);
      const Eigen::VectorXd with = solver->getTorques(motion.q, motion.qd, motion.qdd);
      regressor.compute(motion.q, motion.qd, motion.qdd, Y);
      const Eigen::VectorXd added = Y * inTipFrame(body).toVector();
      EXPECT_LT((with - without - added).norm(), kRounding) << "at " << time;
    }
  }
}

TEST(PayloadEstimator, FindsTheBodyWhereTorquesAreExact) {
  const RigidBody body = box(1.2);
  PayloadEstimator estimator(panda(), optionsWith(noiseOf(1e-5, 1e-5)));
  const auto found = estimateOf(estimator, *pandaWith(body), 10.0);
  EXPECT_NEAR(found.mass, 1.2, 1e-6);
  EXPECT_LT((found.center_of_mass - body.center_of_mass).norm(), 1e-6);
  EXPECT_TRUE(found.inertia_is_known);
  EXPECT_LT((found.inertia - body.inertia).norm(), 1e-5);
  EXPECT_EQ(found.body().inertia, found.inertia);
  EXPECT_LT(found.offset.cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_EQ(defectOf(found.body()), std::nullopt);
}

TEST(PayloadEstimator, IsTheMinimumOfGeneralisedLeastSquaresAndPrior) {
  // An independent way: the covariance of all samples of a joint as a matrix, jitter and a gap.
  const ResidualNoise noise = noiseOf(0.1, 0.3);
  PayloadOptions options = optionsWith(noise);
  options.offset = Eigen::VectorXd::LinSpaced(kJoints, -0.5, 0.5);
  options.offset_deviation = Eigen::VectorXd::Constant(kJoints, 0.2);
  const auto arm = panda(), loaded = pandaWith(box(1.5));
  PayloadEstimator estimator(arm, options);
  TipRegressor regressor(arm);
  std::mt19937 random(3);
  Noise samples{noise, random};

  constexpr Index kCount = 150;
  Eigen::VectorXd time(kCount);
  std::vector<Eigen::MatrixXd> Y(kJoints, Eigen::MatrixXd(kCount, 10));
  Eigen::MatrixXd residual(kCount, kJoints);
  Motion motion;
  double t = 0.0;
  for (Index k = 0; k < kCount; ++k) {
    t += k == 90 ? 0.7 : 0.03 + 0.01 * std::sin(static_cast<double>(k));
    time[k] = t;
    motion.at(t);
    Eigen::MatrixXd row(kJoints, 10);
    regressor.compute(motion.q, motion.qd, motion.qdd, row);
    for (Index j = 0; j < kJoints; ++j) Y[static_cast<std::size_t>(j)].row(k) = row.row(j);
    const Eigen::VectorXd measured =
        loaded->getTorques(motion.q, motion.qd, motion.qdd) + samples.next(0.02);
    residual.row(k) = measured - arm->getTorques(motion.q, motion.qd, motion.qdd);
    ASSERT_EQ(estimator.update(t, motion.q, motion.qd, motion.qdd, measured), PayloadStatus::kOk);
  }
  PayloadEstimate found(kJoints);
  ASSERT_EQ(estimator.estimate(found), PayloadStatus::kOk);

  Normal normal;
  for (Index j = 0; j < kJoints; ++j) {
    Eigen::MatrixXd C(kCount, kCount);
    for (Index a = 0; a < kCount; ++a) {
      for (Index b = 0; b < kCount; ++b) {
        C(a, b) = 0.09 * std::exp(-std::abs(time[a] - time[b]) / noise.correlation_time) + 0.04 +
                  (a == b ? 0.01 : 0.0);
      }
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(C);
    const auto& rows = Y[static_cast<std::size_t>(j)];
    const Eigen::VectorXd known = residual.col(j).array() - options.offset[j];
    normal.A += rows.transpose() * factor.solve(rows);
    normal.b += rows.transpose() * factor.solve(known);
  }
  const RigidBody body{found.mass, found.center_of_mass, found.inertia};
  const Vector10 phi = inTipFrame(body).toVector();
  const BodyPrior prior(found.mass, found.center_of_mass, options.extent);
  const Vector10 gradient = normal.A * phi - normal.b + prior.gradient(phi);
  const Matrix10 H = normal.A + prior.hessian(phi);
  const Vector10 step = H.ldlt().solve(gradient);  // to the minimum
  EXPECT_LT(std::sqrt(step.dot(H * step)), 1e-3) << "in standard deviations";
}

TEST(PayloadEstimator, LongRecordingsTakeNoMoreBlocksAndGiveTheSame) {
  // 60 s in blocks of 0.8 s, joined twice; and in blocks of 10 s, never joined.
  const auto loaded = pandaWith(box(2.0));
  std::mt19937 random(5), again(5);
  Noise noise{noiseOf(0.1, 0.3), random}, same{noiseOf(0.1, 0.3), again};
  PayloadOptions options = optionsWith(noise.of);
  PayloadEstimator joined(panda(), options);
  options.block = 10.0;
  PayloadEstimator whole(panda(), options);
  const auto a = estimateOf(joined, *loaded, 60.0, &noise);
  const auto b = estimateOf(whole, *loaded, 60.0, &same);
  EXPECT_GE(a.blocks, 16);
  EXPECT_LE(a.blocks, 32);
  EXPECT_EQ(b.blocks, 6);
  EXPECT_NEAR(a.mass, b.mass, kSettled);
  EXPECT_LT((a.center_of_mass - b.center_of_mass).norm(), kSettled);
  EXPECT_LT((a.inertia - b.inertia).norm(), kSettled);
}

TEST(PayloadEstimator, WhatTheSolverCarriesAlreadyIsPartOfTheEstimate) {
  const RigidBody body = box(2.0);
  const auto loaded = pandaWith(body);
  PayloadOptions options = optionsWith(noiseOf(0.01, 0.01));
  PayloadEstimator from_nothing(panda(), options);
  options.carried = box(1.7);
  PayloadEstimator from_near(pandaWith(options.carried), options);
  const auto a = estimateOf(from_nothing, *loaded, 5.0), b = estimateOf(from_near, *loaded, 5.0);
  EXPECT_NEAR(a.mass, b.mass, kSettled);
  EXPECT_LT((a.center_of_mass - b.center_of_mass).norm(), kSettled);
}

/// An arm whose joints have friction with this term too.
std::shared_ptr<Solver> armWithFriction(const std::string& term) {
  const std::string path = testing::TempDir() + "/arm_with_friction.yaml";
  std::ofstream file(path);
  file << "schema: 2\nname: arm\nsource: a test\nvalidity: a test\nunits: SI\n"
          "geometry: placements\ngravity: [0, 0, -9.81]\nparameters: about_origin\njoints:\n";
  for (Index j = 0; j < kJoints; ++j) {
    file << "  - name: joint" << j << "\n    type: revolute\n"
         << "    placement: {xyz: [0, 0, 0.2], rpy: [0, 0, 0], axis: "
         << (j % 2 == 0 ? "[0, 0, 1]" : "[0, 1, 0]") << "}\n"
         << "    friction: {law: smooth_coulomb, fv: 0.5, fc: 1, width: 0.05, " << term << "}\n"
         << "    link: [2, 0, 0, 0.2, 0.1, 0, 0, 0.1, 0, 0.02]\n";
  }
  file.close();
  auto solver = std::make_shared<Solver>();
  solver->initialize({{"model", path}}, "");
  return solver;
}

TEST(PayloadEstimator, WhatFrictionRemembersIsNoLoad) {
  const RigidBody body = box(3.0);
  const auto arm = armWithFriction("fm: 50, distance: 0.3"),
             loaded = armWithFriction("fm: 50, distance: 0.3");
  loaded->setPayload("load", body);
  PayloadEstimator estimator(arm, optionsWith(noiseOf(0.01, 0.01)));
  for (const double begin : {0.0, 7.0}) {  // restarted where the arm has moved unseen
    const auto found =
        estimateOf(estimator, *loaded, 5.0, nullptr, Eigen::VectorXd::Zero(kJoints), begin);
    EXPECT_NEAR(found.mass, body.mass, 1e-3);
    estimator.restart();
  }
}

TEST(PayloadEstimator, FrictionThatGrowsWithLoadIsCountedInTwoMoreRounds) {
  const RigidBody body = box(3.0);
  const auto arm = armWithFriction("fl: 0.1"), loaded = armWithFriction("fl: 0.1");
  loaded->setPayload("load", body);
  PayloadOptions options = optionsWith(noiseOf(0.01, 0.01));
  std::vector<double> errors;
  for (int round = 0; round < 4; ++round) {
    PayloadEstimator estimator(arm, options);
    const auto found = estimateOf(estimator, *loaded, 5.0);
    errors.push_back(std::abs(found.mass - body.mass));
    options.carried = found.body();
    arm->setPayload("estimate", options.carried);
  }
  EXPECT_GT(errors[0], 0.02) << "friction of the load doesn't matter here";
  EXPECT_LT(errors[2], 0.1 * errors[0]);
  EXPECT_LT(errors[3], 0.003);
}

TEST(PayloadEstimator, FindsOffsetsThatAreLargerThanTheNoise) {
  const Eigen::VectorXd offset = Eigen::VectorXd::LinSpaced(kJoints, -1.5, 1.5);
  std::mt19937 random(6);
  Noise noise{noiseOf(0.05, 0.1), random};
  PayloadEstimator estimator(panda(), optionsWith(noise.of));
  const auto found = estimateOf(estimator, *pandaWith(box(1.0)), 20.0, &noise, offset);
  EXPECT_NEAR(found.mass, 1.0, 0.05);
  // that of the first joint is about the vertical: nothing else explains it
  EXPECT_NEAR(found.offset[0], -1.5, 0.1);
}

TEST(PayloadEstimator, IntervalsHoldTheTruth) {
  const RigidBody body = box(1.0);
  const auto arm = panda(), loaded = pandaWith(body);
  std::mt19937 random(7);
  constexpr int kTrials = 200;
  int held = 0;
  std::vector<double> errors, widths;
  for (int trial = 0; trial < kTrials; ++trial) {
    Noise noise{noiseOf(0.1, 0.3), random};
    PayloadEstimator estimator(arm, optionsWith(noise.of));
    std::normal_distribution<double> normal(0.0, 0.2);
    Eigen::VectorXd offset(kJoints);
    for (double& number : offset) number = normal(random);
    const auto found = estimateOf(estimator, *loaded, 4.0, &noise, offset, 0.9 * trial);
    held += std::abs(found.mass - body.mass) <= found.mass_half_width;
    for (Index i = 0; i < 3; ++i) {
      held += std::abs(found.center_of_mass[i] - body.center_of_mass[i]) <=
              found.center_of_mass_half_width[i];
    }
    errors.push_back(std::abs(found.mass - body.mass));
    widths.push_back(found.mass_half_width);
    EXPECT_EQ(found.blocks, 5);
  }
  const double coverage = held / (4.0 * kTrials);
  EXPECT_GE(coverage, 0.90);
  EXPECT_LE(coverage, 0.995);
  std::sort(errors.begin(), errors.end());
  std::sort(widths.begin(), widths.end());
  EXPECT_LE(widths[kTrials / 2], 4.5 * errors[kTrials / 2]);
}

/// How many of the intervals hold the truth where the arm's model carries what the noise of another
/// recording of the same motion looks like.
double coverageWithWrongModel(double model_error) {
  const RigidBody body = box(1.0);
  const auto arm = panda(), loaded = pandaWith(body);
  const Eigen::VectorXd no_offset = Eigen::VectorXd::Zero(kJoints);
  std::mt19937 random(11);
  constexpr int kTrials = 40;
  int held = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    PayloadOptions options = optionsWith(noiseOf(0.1, 0.3));
    options.model_error = model_error;
    std::vector<PayloadEstimate> found;
    for (int recording = 0; recording < 2; ++recording) {
      Noise noise{options.noise, random};
      PayloadEstimator estimator(arm, options);
      found.push_back(estimateOf(estimator, *loaded, 20.0, &noise, no_offset, 0.9 * trial));
    }
    const Eigen::Vector3d off = found[0].center_of_mass - found[1].center_of_mass;
    held += std::abs(found[0].mass - found[1].mass) <= found[0].mass_half_width;
    held +=
        static_cast<int>((off.array().abs() <= found[0].center_of_mass_half_width.array()).count());
  }
  return held / (4.0 * kTrials);
}

TEST(PayloadEstimator, IntervalsHoldTheTruthWhereTheArmsModelIsWrong) {
  EXPECT_LT(coverageWithWrongModel(0.0), 0.90);
  const double coverage = coverageWithWrongModel(1.0);
  EXPECT_GE(coverage, 0.90);
  EXPECT_LE(coverage, 0.995);
}

TEST(PayloadEstimator, TellsTheInertiaOnlyWhereTheDataDo) {
  std::mt19937 random(8);
  Noise noise{noiseOf(0.1, 0.3), random};
  PayloadEstimator slow(panda(), optionsWith(noise.of));
  const auto light = estimateOf(slow, *pandaWith(box(0.3)), 4.0, &noise);
  EXPECT_FALSE(light.inertia_is_known);
  EXPECT_EQ(light.body().inertia, Eigen::Matrix3d::Zero());
  EXPECT_EQ(light.body().mass, light.mass);
}

TEST(PayloadEstimator, WithoutALoadTheIntervalReachesZero) {
  std::mt19937 random(9);
  Noise noise{noiseOf(0.1, 0.3), random};
  PayloadEstimator estimator(panda(), optionsWith(noise.of));
  const auto found = estimateOf(estimator, *panda(), 4.0, &noise);
  EXPECT_GT(found.mass, 0.0);
  EXPECT_LT(found.mass, found.mass_half_width);
}

TEST(PayloadEstimator, MotionAboutTheVerticalDoesntTellHowHighTheCenterIs) {
  // Gravity is the same in each pose: no block of data differs, so the jackknife alone sees nothing.
  const auto arm = panda(), loaded = pandaWith(box(3.0));
  PayloadEstimator estimator(arm, optionsWith(noiseOf(0.02, 0.02)));
  Motion motion;
  motion.speed = 0.1;  // faster, centrifugal forces would tell
  for (Index k = 0; k < 600; ++k) {
    const double time = kPeriod * static_cast<double>(k);
    motion.at(time);
    const double q = motion.q[0], qd = motion.qd[0], qdd = motion.qdd[0];
    motion.at(0.0);
    motion.qd.setZero();
    motion.qdd.setZero();
    motion.q[0] = q;
    motion.qd[0] = qd;
    motion.qdd[0] = qdd;
    estimator.update(time, motion.q, motion.qd, motion.qdd,
                     loaded->getTorques(motion.q, motion.qd, motion.qdd));
  }
  PayloadEstimate found(kJoints);
  ASSERT_EQ(estimator.estimate(found), PayloadStatus::kOk);
  EXPECT_GT(found.center_of_mass_half_width.maxCoeff(), 1.0);  // m
  EXPECT_FALSE(found.inertia_is_known);
}

TEST(PayloadEstimator, SaysWhatItLeavesOut) {
  PayloadEstimator estimator(panda(), optionsWith(noiseOf(0.1, 0.3)));
  Motion motion;
  motion.at(0.0);
  const Eigen::VectorXd measured = Eigen::VectorXd::Zero(kJoints);
  const auto update = [&](double time, const Eigen::VectorXd& q) {
    return estimator.update(time, q, motion.qd, motion.qdd, measured);
  };
  Eigen::VectorXd q = motion.q;
  q[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(update(0.0, q), PayloadStatus::kNotFinite);
  EXPECT_EQ(update(std::numeric_limits<double>::infinity(), motion.q), PayloadStatus::kNotFinite);
  EXPECT_EQ(update(0.0, motion.q), PayloadStatus::kOk);
  EXPECT_EQ(update(0.0, motion.q), PayloadStatus::kNotLater);
  EXPECT_EQ(update(0.1, Eigen::VectorXd::Zero(3)), PayloadStatus::kWrongSize);
  PayloadEstimate found(kJoints), other(3);
  EXPECT_EQ(estimator.estimate(found), PayloadStatus::kTooShort);
  EXPECT_EQ(estimator.estimate(other), PayloadStatus::kWrongSize);
  EXPECT_STRNE(text(PayloadStatus::kTooShort), text(PayloadStatus::kOk));
  estimator.restart();
  EXPECT_EQ(update(-1.0, motion.q), PayloadStatus::kOk);
}

TEST(PayloadEstimator, RefusesOptionsThatCantBe) {
  const auto error = [](const PayloadOptions& options) {
    return refusalOf([&] { PayloadEstimator(panda(), options); });
  };
  EXPECT_THAT(error(PayloadOptions()), HasSubstr("payload: noise.white: expected 7 numbers"));
  EXPECT_THAT(error(optionsWith(noiseOf(0.0, 0.0))), HasSubstr("above zero for each joint"));
  PayloadOptions options = optionsWith(noiseOf(0.1, 0.1));
  options.block = 0.0;
  EXPECT_THAT(error(options), HasSubstr("payload: block"));
  options = optionsWith(noiseOf(0.1, 0.1));
  options.model_error = -1.0;
  EXPECT_THAT(error(options), HasSubstr("payload: model_error: expected a finite number >= 0"));
  options = optionsWith(noiseOf(0.1, 0.1));
  options.offset_deviation = Eigen::VectorXd::Zero(kJoints);
  EXPECT_THAT(error(options), HasSubstr("offset_deviation"));
  options = optionsWith(noiseOf(0.1, 0.1));
  options.carried.mass = -1.0;
  EXPECT_THAT(error(options), HasSubstr("carried: mass"));
  EXPECT_THROW(PayloadEstimator(nullptr, optionsWith(noiseOf(0.1, 0.1))),
               inverse_dynamics_solver::InvalidParameterValueException);
}

TEST(CovarianceOf, IsTheInverseWhereThereIsInformationAndVeryLargeElsewhere) {
  constexpr double kFloor = 1e-7;  // what is added for directions without information
  Matrix10 seen = Matrix10::Zero();
  Vector10 row;
  for (int k = 0; k < 40; ++k) {
    for (Index i = 0; i < 10; ++i) row[i] = std::sin(1.0 + k * static_cast<double>(i + 1));
    seen += row * row.transpose();
  }
  const Matrix10 V = covarianceOf(seen);
  EXPECT_LT((seen * V - Matrix10::Identity()).cwiseAbs().maxCoeff(), kFloor);
  EXPECT_EQ((V - V.transpose()).cwiseAbs().maxCoeff(), 0.0);

  Matrix10 of_four = Matrix10::Zero();
  of_four.topLeftCorner<4, 4>() = seen.topLeftCorner<4, 4>();
  const Matrix10 U = covarianceOf(of_four);
  const Eigen::Matrix4d known = of_four.topLeftCorner<4, 4>() * U.topLeftCorner<4, 4>();
  EXPECT_LT((known - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff(), kFloor);
  EXPECT_TRUE(U.allFinite());
  EXPECT_GT(U.diagonal().tail<6>().minCoeff(), 1e6);

  const Matrix10 of_nothing = covarianceOf(Matrix10::Zero());
  EXPECT_TRUE(of_nothing.allFinite());
  EXPECT_GT(of_nothing.diagonal().minCoeff(), 1e6);
}

TEST(PayloadEstimator, NeitherUpdatesNorEstimatesAllocate) {
  expectNoAllocations(optionsWith(noiseOf(0.1, 0.3)));
}

}  // namespace
}  // namespace inverse_dynamics_identification

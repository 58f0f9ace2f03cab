// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/arm_uncertainty.hpp"

#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <chain_dynamics/error.hpp>
#include <chain_dynamics/urdf.hpp>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <random>
#include <vector>

#include "inverse_dynamics_identification/arm_fit.hpp"
#include "inverse_dynamics_identification/tip_regressor.hpp"
#include "moving_arm.hpp"
#include "nuisance.hpp"
#include "payload_solution.hpp"

namespace inverse_dynamics_identification {
namespace {

using testing::HasSubstr;
using Index = Eigen::Index;

constexpr Index kUnknowns = 19 * kJoints;
constexpr double kStep = 0.02;  // s

ArmFitter pandaFitter() {
  chain_dynamics::UrdfOptions options;
  options.root = "fer_link0";
  options.tip = "fer_link8";
  return ArmFitter(chain_dynamics::chainFromUrdf(pandaText(), options));
}

/// The panda's links with some friction; hardly any grows with load, as deviations leave out what links do
/// to load.
ArmFit pandaFit(const ArmFitter& fitter) {
  ArmFit fit;
  fit.parameters.resize(10, kJoints);
  fit.rotor_inertia.setConstant(kJoints, 0.1);
  fit.noise.setConstant(kJoints, 0.1);
  for (Index j = 0; j < kJoints; ++j) {
    const auto i = static_cast<std::size_t>(j);
    fit.parameters.col(j) = fitter.description().links()[i].toVector();
    fit.friction.push_back(
        {0.5, 0.8, 0.1 + 0.02 * static_cast<double>(j), 0.01, 0.1, 1e-6, 0.3, 0.4});
  }
  return fit;
}

/// The fit with other unknowns [ArmInformation].
ArmFit moved(ArmFit fit, const Eigen::VectorXd& by) {
  for (Index j = 0; j < kJoints; ++j) {
    fit.parameters.col(j) += by.segment<10>(10 * j);
    const Eigen::Matrix<double, 9, 1> own = by.segment<9>(10 * kJoints + 9 * j);
    StepFriction& law = fit.friction[static_cast<std::size_t>(j)];
    fit.rotor_inertia[j] += own[own_column::kAcceleration];
    law.fv += own[own_column::kVelocity];
    law.fo += own[own_column::kOne];
    law.fc += own[own_column::kStep];
    law.shift += own[own_column::kShift];
    law.width *= std::exp(own[own_column::kWidth]);
    law.fl += own[own_column::kLoad];
    law.fs += own[own_column::kStribeck];
    law.vs *= std::exp(own[own_column::kStribeckVelocity]);
  }
  return fit;
}

/// Deviations of all unknowns by a few percent of what they usually are.
ArmUncertainty someUncertainty(Index deviations, unsigned seed, double size = 0.03) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  ArmUncertainty uncertainty;
  uncertainty.friction = pandaFit(pandaFitter()).friction;
  uncertainty.factor.resize(kUnknowns, deviations);
  for (Index k = 0; k < deviations; ++k) {
    for (Index i = 0; i < kUnknowns; ++i) uncertainty.factor(i, k) = size * normal(random);
  }
  return uncertainty;
}

TEST(ArmDeviations, AreTheDerivativesOfTorques) {
  const ArmFitter fitter = pandaFitter();
  const ArmFit fit = pandaFit(fitter);
  const ArmUncertainty uncertainty = someUncertainty(4, 1);
  ArmDeviations deviations(panda(), uncertainty);
  ASSERT_EQ(deviations.count(), 4);
  Motion motion;
  Eigen::MatrixXd D(4, kJoints);
  for (const double time : {0.0, 0.7, 3.1}) {
    motion.at(time);
    deviations.compute(motion.q, motion.qd, motion.qdd, D);
    for (Index k = 0; k < 4; ++k) {
      constexpr double kSmall = 1e-5;
      Eigen::MatrixXd tau(kJoints, 2);
      for (const Index side : {0, 1}) {
        const Eigen::VectorXd by = (side == 0 ? kSmall : -kSmall) * uncertainty.factor.col(k);
        fitter.torques(moved(fit, by), motion.q, motion.qd, motion.qdd, tau.col(side));
      }
      const Eigen::VectorXd expected = (tau.col(0) - tau.col(1)) / (2 * kSmall);
      EXPECT_LT((D.row(k).transpose() - expected).norm(), 1e-6 * (1 + expected.norm()))
          << "deviation " << k << " at " << time;
    }
  }
}

TEST(ArmDeviations, RefuseOthersOfTheirArm) {
  const auto error = [](const ArmUncertainty& uncertainty) {
    return refusalOf([&] { ArmDeviations(panda(), uncertainty); });
  };
  ArmUncertainty uncertainty = someUncertainty(2, 1);
  EXPECT_EQ(error(uncertainty), "none");
  uncertainty.friction.pop_back();
  EXPECT_THAT(error(uncertainty), HasSubstr("laws of friction of 7 joints"));
  uncertainty = someUncertainty(2, 1);
  uncertainty.factor(3, 1) = std::nan("");
  EXPECT_THAT(error(uncertainty), HasSubstr("not all of them finite"));
  uncertainty.factor = Eigen::MatrixXd::Zero(18 * kJoints, 2);
  EXPECT_THAT(error(uncertainty), HasSubstr("126 rows"));
  EXPECT_THROW(ArmDeviations(nullptr, someUncertainty(2, 1)),
               inverse_dynamics_solver::InvalidParameterValueException);
}

TEST(ArmFitter, WhitenedInformationIsThatOfGeneralisedLeastSquares) {
  const ArmFitter fitter = pandaFitter();
  const ArmFit fit = pandaFit(fitter);
  ArmUncertainty all = someUncertainty(kUnknowns, 1);
  all.factor.setZero();
  all.factor.diagonal().setOnes();
  ArmDeviations deviations(panda(), all);
  constexpr Index kCount = 40;
  Eigen::MatrixXd states[4] = {};
  for (Eigen::MatrixXd& state : states) state.setZero(kJoints, kCount);
  Eigen::VectorXd time(kCount);
  Motion motion;
  Eigen::MatrixXd D(kUnknowns, kJoints);
  std::vector<Eigen::MatrixXd> W(kJoints, Eigen::MatrixXd(kCount, kUnknowns));
  for (Index k = 0; k < kCount; ++k) {
    time[k] = kStep * static_cast<double>(k) + (k > 25 ? 0.3 : 0.0);
    motion.at(time[k]);
    states[0].col(k) = motion.q;
    states[1].col(k) = motion.qd;
    states[2].col(k) = motion.qdd;
    deviations.compute(motion.q, motion.qd, motion.qdd, D);
    for (Index j = 0; j < kJoints; ++j) W[static_cast<std::size_t>(j)].row(k) = D.col(j);
  }
  const ResidualNoise noise = noiseOf(0.1, 0.3);
  ArmSamples samples{states[0], states[1], states[2], states[3]};
  EXPECT_THROW(
      fitter.whitenedInformation(fit, FrictionTerms::kStribeck, fitter.data({samples}), noise),
      chain_dynamics::ModelError);  // without times
  samples.time = time;
  const Eigen::MatrixXd found =
      fitter.whitenedInformation(fit, FrictionTerms::kStribeck, fitter.data({samples}), noise);
  Eigen::MatrixXd C(kCount, kCount);
  for (Index a = 0; a < kCount; ++a) {
    for (Index b = 0; b < kCount; ++b) {
      C(a, b) = 0.09 * std::exp(-std::abs(time[a] - time[b]) / noise.correlation_time) +
                (a == b ? 0.01 : 0.0);
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(C);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(kUnknowns, kUnknowns);
  for (const Eigen::MatrixXd& rows : W) expected += rows.transpose() * factor.solve(rows);
  EXPECT_LT((found - expected).norm(), 1e-9 * expected.norm());
}

/// An arm that isn't its model, with a body and noise.
struct Recording {
  Recording(const RigidBody& body, const ArmUncertainty& uncertainty, const ResidualNoise& noise,
            double seconds, std::mt19937& random, double begin = 0.0) {
    const auto loaded = panda();
    loaded->setPayload("load", body);
    ArmDeviations deviations(loaded, uncertainty);
    Eigen::MatrixXd D(deviations.count(), kJoints);
    std::normal_distribution<double> normal;
    Eigen::VectorXd z(deviations.count());
    for (double& number : z) number = normal(random);
    Noise samples{noise, random};
    for (Index k = 0; k < std::lround(seconds / kStep); ++k) {
      time.push_back(kStep * static_cast<double>(k));
      Motion motion;
      motion.at(begin + time.back());
      deviations.compute(motion.q, motion.qd, motion.qdd, D);
      motions.push_back(motion);
      measured.push_back(loaded->getTorques(motion.q, motion.qd, motion.qdd) + D.transpose() * z +
                         samples.next(kStep));
    }
  }

  PayloadEstimate estimate(const PayloadOptions& options) const {
    PayloadEstimator estimator(panda(), options);
    return estimate(estimator, options.arm.factor.cols());
  }

  PayloadEstimate estimate(PayloadEstimator& estimator, Index deviations) const {
    for (std::size_t k = 0; k < time.size(); ++k) {
      const Motion& m = motions[k];
      EXPECT_EQ(estimator.update(time[k], m.q, m.qd, m.qdd, measured[k]), PayloadStatus::kOk);
    }
    PayloadEstimate found(kJoints, deviations);
    EXPECT_EQ(estimator.estimate(found), PayloadStatus::kOk);
    return found;
  }

  std::vector<double> time;
  std::vector<Motion> motions;
  std::vector<Eigen::VectorXd> measured;
};

PayloadOptions uncertainOptions(const ResidualNoise& noise, const ArmUncertainty& arm) {
  PayloadOptions options;
  options.noise = noise;
  options.arm = arm;
  return options;
}

TEST(PayloadEstimator, DeviationsOfTheArmArePartOfTheCovarianceOfTorques) {
  // An independent way: the covariance of all samples of all joints as one matrix.
  const ArmUncertainty arm = someUncertainty(6, 2, 0.01);
  PayloadOptions options = uncertainOptions(noiseOf(0.1, 0.3), arm);
  options.offset_deviation = Eigen::VectorXd::Constant(kJoints, 0.2);
  std::mt19937 random(3);
  const Recording recording(box(1.5), arm, options.noise, 3.0, random);
  const PayloadEstimate found = recording.estimate(options);

  const auto solver = panda();
  TipRegressor regressor(solver);
  ArmDeviations deviations(solver, arm);
  const auto count = static_cast<Index>(recording.time.size());
  Eigen::MatrixXd Y(kJoints * count, 10), W(kJoints * count, 6), D(6, kJoints), row(kJoints, 10);
  Eigen::VectorXd residual(kJoints * count);
  for (Index k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Motion& m = recording.motions[i];
    regressor.compute(m.q, m.qd, m.qdd, row);
    deviations.compute(m.q, m.qd, m.qdd, D);
    Y.middleRows(kJoints * k, kJoints) = row;
    W.middleRows(kJoints * k, kJoints) = D.transpose();
    residual.segment(kJoints * k, kJoints) =
        recording.measured[i] - solver->getTorques(m.q, m.qd, m.qdd);
  }
  Eigen::MatrixXd C = W * W.transpose();
  for (Index a = 0; a < count; ++a) {
    for (Index b = 0; b < count; ++b) {
      const double lag = kStep * std::abs(static_cast<double>(a - b));
      const double noise =
          0.09 * std::exp(-lag / options.noise.correlation_time) + 0.04 + (a == b ? 0.01 : 0.0);
      C.block(kJoints * a, kJoints * b, kJoints, kJoints).diagonal().array() += noise;
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(C);
  Normal normal;
  normal.A = Y.transpose() * factor.solve(Y);
  normal.b = Y.transpose() * factor.solve(residual);
  const RigidBody body{found.mass, found.center_of_mass, found.inertia};
  const Vector10 phi = inTipFrame(body).toVector();
  const BodyPrior prior(found.mass, found.center_of_mass, options.extent);
  const Vector10 gradient = normal.A * phi - normal.b + prior.gradient(phi);
  const Matrix10 H = normal.A + prior.hessian(phi);
  const Vector10 step = H.ldlt().solve(gradient);  // to the minimum
  EXPECT_LT(std::sqrt(step.dot(H * step)), 1e-3) << "in standard deviations";
  const Eigen::VectorXd z = W.transpose() * factor.solve(residual - Y * phi);
  EXPECT_LT((found.arm - z).norm(), 1e-3);
}

TEST(Nuisance, OffsetAndDeviationsAreThoseOfTheNormalEquationsOfAll) {
  constexpr Index kDeviations = 3, kNuisance = 4, kAll = 10 + kNuisance;
  std::srand(6);
  const OffsetPrior prior{0.3, 0.5};
  JointSums joint(kDeviations);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(kAll, kAll);  // of body, deviations, offset
  Eigen::VectorXd b = Eigen::VectorXd::Zero(kAll);
  for (int sample = 0; sample < 20; ++sample) {
    const Row row = Row::Random();
    const Eigen::VectorXd deviations = Eigen::VectorXd::Random(kDeviations);
    joint.add(row, deviations);
    Eigen::VectorXd all(kAll);
    all << row.head<10>(), deviations, row[10];
    A += all * all.transpose();
    b += row[11] * all;
  }
  A.diagonal().segment<kDeviations>(10).array() += 1;
  A(kAll - 1, kAll - 1) += 1 / prior.variance;
  b[kAll - 1] += prior.mean / prior.variance;
  const Eigen::MatrixXd V = A.bottomRightCorner<kNuisance, kNuisance>().inverse();  // known body
  const Eigen::VectorXd right = V * b.tail<kNuisance>();
  const Eigen::MatrixXd slope = V * A.bottomLeftCorner<kNuisance, 10>();

  Nuisance nuisance(1, kDeviations);
  nuisance.begin({prior});
  nuisance.add(0, joint);
  const Normal body = nuisance.solve();
  const Eigen::MatrixXd coupling = A.topRightCorner<10, kNuisance>();
  EXPECT_LT((body.A - (A.topLeftCorner<10, 10>() - coupling * slope)).norm(), 1e-12);
  EXPECT_LT((body.b - (b.head<10>() - coupling * right)).norm(), 1e-12);
  const Vector10 phi = Vector10::Random();
  const Eigen::VectorXd w = right - slope * phi;
  const OffsetPrior offset = nuisance.offset(0, phi, Matrix10::Identity());
  EXPECT_NEAR(offset.mean, w[kDeviations], 1e-12);
  EXPECT_NEAR(offset.variance, V(kDeviations, kDeviations) + slope.row(kDeviations).squaredNorm(),
              1e-12);
  Eigen::VectorXd z(kDeviations);
  nuisance.deviations(phi, z);
  EXPECT_LT((z - w.head<kDeviations>()).norm(), 1e-12);
}

TEST(PayloadEstimator, ArmThatDiffersFromItsModelSpoilsLessWhereThatIsEstimated) {
  const RigidBody body = box(1.0);
  const ArmUncertainty arm = someUncertainty(20, 4, 0.005);
  const ResidualNoise noise = noiseOf(0.02, 0.05);
  std::mt19937 random(7);
  constexpr int kTrials = 60;
  int held = 0;
  double with = 0.0, without = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Recording recording(body, arm, noise, 6.0, random, 0.9 * trial);
    const PayloadEstimate found = recording.estimate(uncertainOptions(noise, arm));
    const PayloadEstimate plain = recording.estimate(uncertainOptions(noise, {}));
    with += std::pow(found.mass - body.mass, 2);
    without += std::pow(plain.mass - body.mass, 2);
    held += std::abs(found.mass - body.mass) <= found.mass_half_width;
    const Eigen::Vector3d off = found.center_of_mass - body.center_of_mass;
    held +=
        static_cast<int>((off.array().abs() <= found.center_of_mass_half_width.array()).count());
  }
  EXPECT_LT(std::sqrt(with), 0.7 * std::sqrt(without));
  const double coverage = held / (4.0 * kTrials);
  EXPECT_GE(coverage, 0.90);
  EXPECT_LE(coverage, 0.998);
}

TEST(PayloadEstimator, RestartsWithNothingOfTheArm) {
  const PayloadOptions options = uncertainOptions(noiseOf(0.1, 0.3), someUncertainty(6, 2, 0.01));
  std::mt19937 random(3);
  const Recording recording(box(1.5), options.arm, options.noise, 3.0, random);
  PayloadEstimator estimator(panda(), options);
  const PayloadEstimate first = recording.estimate(estimator, 6);
  estimator.restart();
  const PayloadEstimate second = recording.estimate(estimator, 6);
  EXPECT_EQ(first.mass, second.mass);
  EXPECT_EQ(first.arm, second.arm);
}

TEST(PayloadEstimator, NeitherUpdatesNorEstimatesAllocateWithAnUncertainArm) {
  expectNoAllocations(uncertainOptions(noiseOf(0.1, 0.3), someUncertainty(100, 5)));
}

TEST(PayloadEstimator, EstimatesHaveRoomForTheDeviationsOfTheirEstimator) {
  PayloadEstimator estimator(panda(), uncertainOptions(noiseOf(0.1, 0.3), someUncertainty(2, 5)));
  PayloadEstimate fewer(kJoints);
  EXPECT_EQ(estimator.estimate(fewer), PayloadStatus::kWrongSize);
}

}  // namespace
}  // namespace inverse_dynamics_identification

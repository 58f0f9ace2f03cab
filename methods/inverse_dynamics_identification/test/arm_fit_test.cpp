// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/arm_fit.hpp"

#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <chain_dynamics/error.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/friction.hpp>
#include <chain_dynamics/friction_state.hpp>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/robot_description.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "measured_arm.hpp"

namespace inverse_dynamics_identification::arm_fit_test {

using chain_dynamics::FastModel;
using chain_dynamics::Model;

TEST(ArmFitter, FindsAKnownRobotWithItsFriction) {
  const ArmFitter fitter(threeJointArm(0.6));
  for (const FrictionTerms terms :
       {FrictionTerms::kStep, FrictionTerms::kLoad, FrictionTerms::kStribeck}) {
    SCOPED_TRACE(static_cast<int>(terms));
    const Motion motion = measured(terms, 4000, 1);
    ArmFitOptions options;
    options.terms = terms;
    options.prior_strength = 1;
    options.shift = true;
    const ArmFit fit = fitter.fit({samplesOf(motion)}, options);
    EXPECT_LT(errorOf(fitter, fit, measured(terms, 2000, 9)), 1.1 * kNoise) << fit.passes;
    const std::vector<StepFriction> laws = knownFriction(terms);
    for (std::size_t j = 0; j < 3; ++j) {
      SCOPED_TRACE(j);
      // 4000 samples: the noise leaves about a per cent of each figure
      EXPECT_NEAR(fit.friction[j].fv, laws[j].fv, 0.1);
      EXPECT_NEAR(fit.friction[j].fo, laws[j].fo, 0.02);
      EXPECT_NEAR(fit.friction[j].shift, laws[j].shift, 0.01);
      EXPECT_NEAR(fit.friction[j].width, laws[j].width, 0.25 * laws[j].width + 0.01);
    }
  }
}

TEST(ArmFitter, FindsTheDistanceOverWhichFrictionTurnsRound) {
  const double distances[] = {0.0006, 0.003, 0.02};  // of a gear, however far its joint moves
  Model model(threeJointArm());
  for (const double distance : distances) {
    StepFriction law{0.5, 1, 0.01};
    law.fm = 2;
    law.distance = distance;
    model.friction.emplace_back(law);
  }
  const Eigen::Index count = 6000;
  Motion motion = randomMotion(model.chain, count, 1);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double t = 0.005 * static_cast<double>(k);
    for (Eigen::Index j = 0; j < 3; ++j) {
      const double v = 0.7 + 0.2 * static_cast<double>(j), w = 8 * v;
      motion.q(j, k) = std::sin(v * t) + 0.02 * std::sin(w * t);
      motion.qd(j, k) = v * std::cos(v * t) + 0.02 * w * std::cos(w * t);
      motion.qdd(j, k) = -v * v * std::sin(v * t) - 0.02 * w * w * std::sin(w * t);
    }
  }
  FastModel(model).torquesBatch(motion.q, motion.qd, motion.qdd, motion.tau);
  chain_dynamics::FrictionState(model).addAlong(motion.q, motion.qd, motion.tau);
  motion.tau += noise(3, count, kNoise, 2);
  ArmFitOptions options;
  options.terms = FrictionTerms::kMemory;
  const ArmFit fit = ArmFitter(threeJointArm(0.6)).fit({samplesOf(motion)}, options);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_NEAR(fit.friction[j].distance, distances[j], 0.1 * distances[j]) << j;
    EXPECT_NEAR(fit.friction[j].fm + fit.friction[j].fs, 2, 0.1) << j;
  }
}

/// A waist with a left arm of one joint and a right one of two, and a joint on the left that follows: random
/// places and rods, of `scale` times their masses.
chain_dynamics::Mechanism tree(unsigned seed, double scale) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto numbers = [&] {
    std::ostringstream text;
    for (int i = 0; i < 3; ++i) text << any(random) << " ";
    return text.str();
  };
  std::ostringstream urdf;
  urdf << "<robot name='tree'><link name='base'/>";
  const auto add = [&](const std::string& name, const std::string& parent,
                       const std::string& more) {
    const double mass = scale * (2 + any(random));
    urdf << "<link name='" << name << "'><inertial><origin xyz='0.2 0.1 -0.1'/><mass value='"
         << mass << "'/><inertia ixx='" << 0.03 * mass << "' iyy='" << 0.04 * mass << "' izz='"
         << 0.02 * mass << "' ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='" << name
         << "_joint' type='continuous'><parent link='" << parent << "'/><child link='" << name
         << "'/><origin xyz='" << numbers() << "' rpy='" << numbers() << "'/><axis xyz='"
         << numbers() << "'/>" << more << "</joint>";
  };
  add("chest", "base", "");
  add("left", "chest", "");
  add("finger", "left", "<mimic joint='left_joint' multiplier='-1.5' offset='0.2'/>");
  add("right", "chest", "");
  add("hand", "right", "");
  urdf << "</robot>";
  return chain_dynamics::mechanismFromRobot(chain_dynamics::robotFromUrdf(urdf.str()), {}, {"*"});
}

/// The same with friction and rotors.
Model treeInMotion(unsigned seed) {
  const chain_dynamics::Mechanism rigid = tree(seed, 1);
  Model model(withLinks(rigid, linksOf(rigid), Eigen::Vector4d(0.3, 0.2, 0.1, 0.05)));
  for (StepFriction law : knownFriction(FrictionTerms::kLoad)) {
    law.shift = 0;
    model.friction.emplace_back(law);
  }
  model.friction.push_back(model.friction.back());
  return model;
}

Motion motionOf(const Model& model, Eigen::Index count, unsigned seed) {
  Motion motion = randomMotion(model.chain, count, seed);
  FastModel(model).torquesBatch(motion.q, motion.qd, motion.qdd, motion.tau);
  motion.tau += noise(motion.tau.rows(), count, kNoise, seed + 1);
  return motion;
}

TEST(ArmFitter, FindsAKnownTreeWithItsFriction) {
  for (const unsigned seed : {3U, 4U}) {
    SCOPED_TRACE(seed);
    const Model truth = treeInMotion(seed);
    const ArmFitter fitter(tree(seed, 0.6));
    ASSERT_EQ(fitter.prior().size(), 5);
    ASSERT_EQ(fitter.description().jointCount(), 4);
    ArmFitOptions options;
    options.terms = FrictionTerms::kLoad;
    options.prior_strength = 1;
    const Motion motion = motionOf(truth, 4000, 1), other = motionOf(truth, 2000, 9);
    const ArmFit fit = fitter.fit({samplesOf(motion)}, options);
    EXPECT_LT(errorOf(fitter, fit, other), 1.1 * kNoise) << fit.passes;
    for (std::size_t j = 0; j < 4; ++j) {
      const auto& law = std::get<StepFriction>(truth.friction[j]);
      EXPECT_NEAR(fit.friction[j].fv, law.fv, 0.1);
      EXPECT_NEAR(fit.friction[j].fl, law.fl, 0.05);
    }
    // rotors and links stand in the branches, each link in the first one that has it
    const Model found = fitter.model(fit);
    const chain_dynamics::Mechanism parts{found.chain, found.branches};
    EXPECT_EQ(found.branches[1].chain.links()[0].mass, 0);
    EXPECT_LT((linksOf(parts)[2].toVector() - fit.parameters.col(2)).norm(), 1e-15);
    EXPECT_NEAR(found.chain.joints()[0].rotor_inertia, fit.rotor_inertia[0], 0);
  }
}

TEST(ArmFitter, TellsOfATreeWhatSamplesSay) {
  const Model truth = treeInMotion(5);
  const ArmFitter fitter(tree(5, 0.6));
  Motion motion = motionOf(truth, 600, 1);
  ArmSamples samples = samplesOf(motion);
  samples.carried = rod(0.5, 0.2);
  samples.time = Eigen::VectorXd::LinSpaced(600, 0, 60);
  Eigen::MatrixXd bare(4, 600), loaded(4, 600);
  FastModel(truth).torquesBatch(motion.q, motion.qd, motion.qdd, bare);
  FastModel(withBodyAtTip(truth, samples.carried))
      .torquesBatch(motion.q, motion.qd, motion.qdd, loaded);
  motion.tau += loaded - bare;
  ArmFitOptions options;
  options.prior_strength = 1;
  options.terms = FrictionTerms::kLoad;
  const ArmFit fit = fitter.fit({samples}, options);
  EXPECT_LT(errorOf(fitter, fit, motionOf(truth, 600, 9)), 1.2 * kNoise);
  samples.carried = LinkParameters::zero();
  const ArmData data = fitter.data({samples});
  const Eigen::Index unknowns = 5 * 10 + 4 * 7;
  const ArmInformation found = fitter.information(fit, data, options);
  ASSERT_EQ(found.data.rows(), unknowns);
  // errors that aren't correlated: the whitened rows are the rows, by their noise
  ResidualNoise white;
  white.white = fit.noise;
  white.correlated = Eigen::VectorXd::Zero(4);
  white.correlation_time = 1e-3;
  const OwnedMatrix whitened = fitter.whitenedInformation(fit, options.terms, data, white);
  EXPECT_LT((whitened - found.data).norm(), 1e-9 * found.data.norm());
}

TEST(ArmFitter, FindsTheRotorOfAMotorThatNoJointFollowsAlone) {
  chain_dynamics::Mechanism mixed = tree(3, 1);
  for (chain_dynamics::Branch& branch : mixed.branches) {
    branch.S.push_back({0, 1, 0.5});  // the waist follows the left arm's motor, too
  }
  const Model truth(withLinks(mixed, linksOf(mixed), Eigen::Vector4d(0.6, 0.2, 0.1, 0.05)));
  ASSERT_EQ(truth.motor_inertia[0], 0.6);
  const ArmFitter fitter(mixed);
  const ArmFit fit = fitter.fit({samplesOf(motionOf(truth, 4000, 1))}, {});
  EXPECT_NEAR(fit.rotor_inertia[0], 0.6, 0.1);
  EXPECT_EQ(fitter.model(fit).motor_inertia[0], fit.rotor_inertia[0]);
  EXPECT_LT(errorOf(fitter, fit, motionOf(truth, 2000, 9)), 1.1 * kNoise);
}

/// Of an arm whose last motor turns with the joint before; its own joint has this part of the speed.
Motion coupledMotion(const Model& arm, unsigned seed, double speed) {
  Motion motion = randomMotion(arm.chain, 4000, seed);
  motion.qd.row(2) *= speed;
  FastModel(Model(arm.chain)).torquesBatch(motion.q, motion.qd, motion.qdd, motion.tau);
  Eigen::MatrixXd f(motion.tau);
  FastModel(arm).frictionVectorBatch(motion.q, motion.qd, f);
  motion.tau += f + noise(3, 4000, kNoise, seed + 1);
  return motion;
}

TEST(ArmFitter, FindsFrictionOfCoupledMotors) {
  Model arm(threeJointArm());
  arm.coupling = Eigen::Matrix3d{{1, 0, 0}, {0, 1, 0}, {0, -0.8, 1}};
  for (StepFriction law : knownFriction(FrictionTerms::kStep)) {
    law.shift = 0;
    arm.friction.emplace_back(law);
  }
  const ArmFitter fitter(threeJointArm(0.6), {}, arm.coupling), uncoupled(threeJointArm(0.6));
  for (const auto& [terms, speed] :
       {std::pair(FrictionTerms::kStep, 1.0), {FrictionTerms::kLoad, 0.002}}) {
    const Motion motion = coupledMotion(arm, 1, speed), other = coupledMotion(arm, 9, speed);
    ArmFitOptions options;
    options.terms = terms;
    options.prior_strength = 1;
    const ArmFit fit = fitter.fit({samplesOf(motion)}, options);
    EXPECT_LT(errorOf(fitter, fit, other), 1.1 * kNoise);
    EXPECT_GT(errorOf(uncoupled, uncoupled.fit({samplesOf(motion)}, options), other), 3 * kNoise);
    for (std::size_t j = 1; j < 3; ++j) {
      const auto& law = std::get<StepFriction>(arm.friction[j]);
      EXPECT_NEAR(fit.friction[j].fv, law.fv, 0.05 * law.fv) << j;
      EXPECT_NEAR(fit.friction[j].fc, law.fc, 0.05 * law.fc) << j;
      EXPECT_NEAR(fit.friction[j].width, law.width, 0.1 * law.width) << j;
    }
    EXPECT_EQ(fitter.model(fit).coupling, arm.coupling);
    checkModel(fitter.model(fit));
  }
  EXPECT_THROW(ArmFitter(threeJointArm(), {}, Eigen::Matrix2d::Identity()),
               chain_dynamics::ModelError);
  EXPECT_THROW(
      ArmFitter(threeJointArm(), {}, Eigen::Matrix3d(Eigen::Vector3d(1, 1, 0).asDiagonal())),
      chain_dynamics::ModelError);
}

/// Friction of a motor that turns joints 2 and 3 as well, a spring and a lever.
Model armWithMoreLaws() {
  Model arm(threeJointArm());
  arm.coupling = Eigen::MatrixXd{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -0.8, 1.2}};
  arm.friction_places = {"belt"};
  for (StepFriction law : knownFriction(FrictionTerms::kStep)) {
    law.shift = 0;
    arm.friction.emplace_back(law);
  }
  arm.friction.emplace_back(StepFriction{0.9, 1.4, 0.05});
  arm.stiffness = Eigen::Vector3d(0, 4, 0);
  arm.rest = Eigen::Vector3d::Zero();
  arm.levers = Eigen::MatrixXd{{0, 0, 1.5}, {0, 0, -2.5}};
  return arm;
}

TEST(ArmFitter, FindsFrictionOfFurtherPlacesAndSprings) {
  const Model arm = armWithMoreLaws();
  const std::vector<SpringTerms> springs = {SpringTerms::kNone, SpringTerms::kLinear,
                                            SpringTerms::kLever};
  const Chain description = threeJointArm(0.6);
  const ArmFitter fitter(description, {}, arm.coupling, springs, arm.friction_places);
  const ArmFitter without(description);
  const Motion motion = motionOf(arm, 4000, 1), other = motionOf(arm, 2000, 9);
  ArmFitOptions options;
  options.prior_strength = 1;
  const ArmFit fit = fitter.fit({samplesOf(motion)}, options);
  EXPECT_LT(errorOf(fitter, fit, other), 1.1 * kNoise);
  EXPECT_GT(errorOf(without, without.fit({samplesOf(motion)}, options), other), 3 * kNoise);
  ASSERT_EQ(fit.friction.size(), 4);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& law = std::get<StepFriction>(arm.friction[k]);
    EXPECT_NEAR(fit.friction[k].fv, law.fv, 0.05) << k;
    EXPECT_NEAR(fit.friction[k].fc, law.fc, 0.05 * law.fc + 0.01) << k;
    EXPECT_NEAR(fit.friction[k].width, law.width, 0.2 * law.width) << k;
  }
  EXPECT_EQ(fit.friction[3].fo, 0);
  const Model found = fitter.model(fit);
  checkModel(found);
  EXPECT_EQ(found.friction_places, arm.friction_places);
  EXPECT_NEAR(found.stiffness[1], 4, 0.05);
  EXPECT_LT((found.levers - arm.levers).cwiseAbs().maxCoeff(), 0.1);

  ArmSamples samples = samplesOf(motion);
  samples.time = Eigen::VectorXd::LinSpaced(4000, 0, 400);
  const ArmData data = fitter.data({samples});
  const ArmInformation information = fitter.information(fit, data, options);
  ASSERT_EQ(information.data.rows(), 3 * 10 + 3 * 6 + 4 + 3);
  ResidualNoise white;
  white.white = fit.noise;
  white.correlated = Eigen::VectorXd::Zero(3);
  white.correlation_time = 1e-3;
  const OwnedMatrix whitened = fitter.whitenedInformation(fit, options.terms, data, white);
  EXPECT_LT((whitened - information.data).norm(), 1e-9 * information.data.norm());
}

TEST(ArmFitter, FindsDriveGainsWithFurtherPlacesAndSprings) {
  const Model arm = armWithMoreLaws();
  const Eigen::Vector3d gains(8, 12, 5);
  const LinkParameters body = rod(2, 0.2);
  const Model loaded = withBodyAtTip(arm, body);
  Motion bare = motionOf(arm, 3000, 1), carrying = motionOf(loaded, 3000, 2);
  for (Motion* const motion : {&bare, &carrying}) {
    motion->tau = gains.cwiseInverse().asDiagonal() * motion->tau;
  }
  ArmSamples carried = samplesOf(carrying);
  carried.carried = body;
  const ArmFitter fitter(threeJointArm(0.8), {}, arm.coupling,
                         {SpringTerms::kNone, SpringTerms::kLinear, SpringTerms::kLever});
  ArmFitOptions options;
  options.prior_strength = 1;
  options.drive_gains = 1.5 * gains;
  const ArmFit fit = fitter.fit({samplesOf(bare), carried}, options);
  EXPECT_LT(((fit.drive_gains - gains).array() / gains.array()).abs().maxCoeff(), 0.05);
}

TEST(ArmFitter, TorquesAreThoseOfItsModel) {
  const ArmFitter fitter(threeJointArm(0.6));
  for (const FrictionTerms terms :
       {FrictionTerms::kStep, FrictionTerms::kLoad, FrictionTerms::kStribeck}) {
    SCOPED_TRACE(static_cast<int>(terms));
    const Motion motion = measured(terms, 100, 1);
    ArmFitOptions options;
    options.terms = terms;
    const ArmFit fit = fitter.fit({samplesOf(motion)}, options);
    const Model model = fitter.model(fit);
    Eigen::VectorXd expected(3), f(3);
    Eigen::MatrixXd tau(3, 100);
    fitter.torques(fit, motion.q, motion.qd, motion.qdd, tau);
    for (Eigen::Index k = 0; k < 100; ++k) {
      torques(model, motion.q.col(k), motion.qd.col(k), motion.qdd.col(k), expected);
      frictionVector(model, motion.q.col(k), motion.qd.col(k), f);
      EXPECT_LT((tau.col(k) - expected - f).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

TEST(ArmFitter, HasNoLoadTermWithoutLoad) {
  // The axis of the first joint is vertical: gravity doesn't load it.
  const ArmFitter fitter(threeJointArm());
  ArmFitOptions options;
  options.terms = FrictionTerms::kLoad;
  const ArmFit fit = fitter.fit({samplesOf(measured(FrictionTerms::kStep, 1000, 1))}, options);
  for (const StepFriction& law : fit.friction) {
    EXPECT_GT(law.fl, 0);
    EXPECT_LT(law.fl, options.friction.most_load);
  }
}

TEST(ArmFitter, IsARobotWithFrictionThatBrakesWhateverTheTorquesAre) {
  const ArmFitter fitter(threeJointArm());
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Motion motion = randomMotion(threeJointArm(), 40, seed);
    motion.tau = noise(3, 40, 50, seed);
    ArmFitOptions options;
    options.terms = FrictionTerms::kStribeck;
    options.prior_strength = 0.01;
    const ArmFit fit = fitter.fit({samplesOf(motion)}, options);
    EXPECT_GT(fit.rotor_inertia.minCoeff(), 0);
    for (const StepFriction& law : fit.friction) {
      EXPECT_GE(law.fv, 0);
      EXPECT_GE(law.fc, 0);
      EXPECT_GE(law.fl, 0);
      EXPECT_GE(law.fs, 0);
      EXPECT_GT(law.width, 0);
    }
    const Model model = fitter.model(fit);
    EXPECT_TRUE(model.inertiaIsPhysical());
    const FastModel fast(model);
    std::mt19937 random(seed);
    const Eigen::MatrixXd q = uniform(3, 10000, 3, random);
    Eigen::MatrixXd H(3, 30000);
    fast.inertiaMatrixBatch(q, H);
    for (Eigen::Index k = 0; k < 10000; ++k) {
      const Eigen::LLT<Eigen::Matrix3d> factor(Eigen::Matrix3d(H.middleCols<3>(3 * k)));
      ASSERT_EQ(factor.info(), Eigen::Success) << q.col(k).transpose();
    }
  }
}

TEST(ArmFitter, DoesNotDependOnLinkFrames) {
  const ArmFitter here(threeJointArm(0.6)), there(withFramesMoved(threeJointArm(0.6)));
  const Motion motion = measured(FrictionTerms::kLoad, 200, 1);
  ArmFitOptions options;
  options.terms = FrictionTerms::kLoad;
  const ArmFit one = here.fit({samplesOf(motion)}, options);
  const ArmFit other = there.fit({samplesOf(motion)}, options);
  Eigen::MatrixXd tau(3, 200), moved(3, 200);
  here.torques(one, motion.q, motion.qd, motion.qdd, tau);
  there.torques(other, motion.q, motion.qd, motion.qdd, moved);
  EXPECT_LT((tau - moved).cwiseAbs().maxCoeff(), 1e-3 * tau.cwiseAbs().maxCoeff());
}

TEST(ArmFitter, OfBlocksIsThatOfAllSamples) {
  const ArmFitter fitter(threeJointArm(0.6));
  const Motion motion = measured(FrictionTerms::kStep, 1500, 1);
  const ArmSamples all = samplesOf(motion);
  const auto part = [&](Eigen::Index first, Eigen::Index size) {
    return ArmSamples{all.q.middle(first, size), all.qd.middle(first, size),
                      all.qdd.middle(first, size), all.tau.middle(first, size)};
  };
  const ArmFit whole = fitter.fit({all}, {});
  const ArmFit parts = fitter.fit({part(0, 700), part(700, 1), part(701, 799)}, {});
  EXPECT_NEAR(parts.cost, whole.cost, 1e-6 * std::abs(whole.cost));
}

TEST(ArmFitter, BeginsWithAnotherFit) {
  const ArmFitter fitter(threeJointArm(0.6));
  const Motion motion = measured(FrictionTerms::kLoad, 1000, 1);
  ArmFitOptions options;
  options.terms = FrictionTerms::kLoad;
  const ArmFit first = fitter.fit({samplesOf(motion)}, options);
  const ArmFit again = fitter.fit({samplesOf(motion)}, options, &first);
  EXPECT_LT(again.passes, first.passes);
  EXPECT_NEAR(again.cost, first.cost, 1.0);  // of twice a log likelihood
}

/// Of motor currents, half of the samples with a known body at the tip.
struct CurrentMotion {
  Motion alone, loaded;
  LinkParameters body;
  Eigen::Vector3d gains;

  std::vector<ArmSamples> samples() const {
    std::vector<ArmSamples> both = {samplesOf(alone), samplesOf(loaded)};
    both[1].carried = body;
    return both;
  }
};

CurrentMotion currents(Eigen::Index count, double deviation = kNoise) {
  CurrentMotion motion{measured(FrictionTerms::kLoad, count, 1, deviation), {}, {}, {12, 7, 3}};
  motion.body =
      LinkParameters::fromCenterOfMass(1.5, {0.1, 0.05, 0.2}, Eigen::Matrix3d::Identity() * 0.004);
  motion.loaded = measured(FrictionTerms::kLoad, count, 2, deviation, motion.body);
  motion.alone.tau = motion.gains.cwiseInverse().asDiagonal() * motion.alone.tau;
  motion.loaded.tau = motion.gains.cwiseInverse().asDiagonal() * motion.loaded.tau;
  return motion;
}

ArmFitOptions gainOptions() {
  ArmFitOptions options;
  options.terms = FrictionTerms::kLoad;
  options.prior_strength = 1;
  options.most_passes = 30;
  options.drive_gains = Eigen::Vector3d(9, 9, 5);
  options.shift = true;
  return options;
}

TEST(ArmFitter, FindsDriveGainsFromAKnownBody) {
  const ArmFitter fitter(threeJointArm(0.6));
  for (const double deviation : {kNoise, 1.0}) {  // N m: torques vary by 10, the body's by 3
    SCOPED_TRACE(deviation);
    const CurrentMotion motion = currents(4000, deviation);
    const ArmFit fit = fitter.fit(motion.samples(), gainOptions());
    ASSERT_EQ(fit.drive_gains.size(), 3);
    for (Eigen::Index j = 0; j < 3; ++j) {
      // what the noise leaves; a fit of errors in N m would find small gains where it is large
      const double share = deviation > kNoise ? 0.03 : 0.003;
      EXPECT_NEAR(fit.drive_gains[j], motion.gains[j], share * motion.gains[j]) << fit.passes;
    }
    const Motion unseen = measured(FrictionTerms::kLoad, 1000, 9, 0);
    EXPECT_LT(errorOf(fitter, fit, unseen), deviation > kNoise ? 0.3 : 0.03);
  }
}

TEST(ArmFitter, AKnownBodyIsNoPartOfTheLinks) {
  const ArmFitter fitter(threeJointArm(0.6));
  const CurrentMotion motion = currents(2000);
  ArmFitOptions options = gainOptions();
  options.drive_gains = {};
  CurrentMotion torques = motion;
  torques.alone.tau = motion.gains.asDiagonal() * motion.alone.tau;
  torques.loaded.tau = motion.gains.asDiagonal() * motion.loaded.tau;
  const ArmFit fit = fitter.fit(torques.samples(), options);
  EXPECT_EQ(fit.drive_gains.size(), 0);
  EXPECT_LT(errorOf(fitter, fit, measured(FrictionTerms::kLoad, 1000, 9, 0)), 0.02);
}

TEST(ArmFitter, InformationKnowsHowWellGainsAreKnown) {
  const ArmFitter fitter(threeJointArm(0.6));
  const CurrentMotion motion = currents(2000, 0.3);
  const ArmFitOptions options = gainOptions();
  const ArmFit fit = fitter.fit(motion.samples(), options);
  const ArmInformation found = fitter.information(fit, fitter.data(motion.samples()), options);
  ASSERT_EQ(found.data.rows(), 3 * (10 + 7 + 1));
  const auto deviations = [](const Eigen::MatrixXd& H) {
    const Eigen::MatrixXd V = H.inverse();
    return Eigen::Vector3d(V(37, 37), V(45, 45), V(53, 53)).cwiseSqrt().eval();
  };
  const Eigen::Vector3d known = deviations(found.data + found.prior);
  EXPECT_LT(known.maxCoeff(), 0.01);  // of log k
  for (Eigen::Index j = 0; j < 3; ++j) {
    EXPECT_LT(std::abs(std::log(fit.drive_gains[j] / motion.gains[j])), 4 * known[j] + 1e-3);
  }
  // without the body, links, friction and gains have a scale in common: the prior's
  const std::vector<ArmSamples> alone = {samplesOf(motion.alone)};
  const ArmFit scaled = fitter.fit(alone, options);
  const ArmInformation open = fitter.information(scaled, fitter.data(alone), options);
  EXPECT_GT(deviations(open.data + 1e-3 * open.prior).minCoeff(), 0.3);
}

TEST(ArmFitter, RefusesGainsThatAreNone) {
  const ArmFitter fitter(threeJointArm());
  const CurrentMotion motion = currents(100);
  ArmFitOptions options = gainOptions();
  for (const Eigen::VectorXd& gains :
       {Eigen::VectorXd(Eigen::Vector2d(1, 1)), Eigen::VectorXd(Eigen::Vector3d(1, 0, 1)),
        Eigen::VectorXd(Eigen::Vector3d(1, NAN, 1))}) {
    options.drive_gains = gains;
    EXPECT_THROW(fitter.fit(motion.samples(), options), chain_dynamics::ModelError);
  }
}

TEST(ArmFitter, InformationHasNoSlopeAtTheMinimum) {
  const ArmFitter fitter(threeJointArm(0.6));
  const Motion motion = measured(FrictionTerms::kStep, 1000, 1);
  ArmFitOptions options;
  const ArmFit fit = fitter.fit({samplesOf(motion)}, options);
  const ArmInformation found = fitter.information(fit, fitter.data({samplesOf(motion)}), options);
  ASSERT_EQ(found.data.rows(), 48);
  ASSERT_EQ(found.scores.cols(), 1);
  const Eigen::MatrixXd H = found.data + found.prior;
  const Eigen::LLT<Eigen::MatrixXd> factor(H);
  ASSERT_EQ(factor.info(), Eigen::Success);
}

TEST(ArmFitter, SaysWhatItHasChangedInTheDescription) {
  std::vector<LinkParameters> links = threeJointArm().links();
  links[1] = LinkParameters::zero();
  const ArmFitter fitter(Chain("arm", threeJointArm().joints(), links, {0, 0, -9.81}));
  EXPECT_EQ(fitter.prior()[0].changes, "");
  EXPECT_NE(fitter.prior()[1].changes, "");
}

TEST(ArmFitter, RefusesSamplesThatDoNotFit) {
  const ArmFitter fitter(threeJointArm());
  const Motion motion = measured(FrictionTerms::kStep, 100, 1);
  EXPECT_THROW(fitter.fit({}, {}), chain_dynamics::ModelError);
  const Eigen::MatrixXd fewer = motion.tau.leftCols(99);
  EXPECT_THROW(fitter.fit({{motion.q, motion.qd, motion.qdd, fewer}}, {}),
               chain_dynamics::ModelError);
  Motion broken = motion;
  broken.qd(0, 3) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(fitter.fit({samplesOf(broken)}, {}), chain_dynamics::ModelError);
}

TEST(ArmFitter, RefusesAFitOfAnotherArm) {
  const ArmFitter fitter(threeJointArm());
  const Motion motion = measured(FrictionTerms::kStep, 100, 1);
  const ArmFit fit = fitter.fit({samplesOf(motion)}, {});
  ArmFit other = fit;
  other.friction.pop_back();
  Eigen::MatrixXd tau(3, 100);
  EXPECT_THROW(fitter.fit({samplesOf(motion)}, {}, &other), chain_dynamics::ModelError);
  EXPECT_THROW(fitter.torques(other, motion.q, motion.qd, motion.qdd, tau),
               chain_dynamics::ModelError);
  other = fit;
  other.noise.resize(0);
  EXPECT_THROW(fitter.information(other, fitter.data({samplesOf(motion)}), {}),
               chain_dynamics::ModelError);
  ArmFitOptions none;
  none.most_passes = 0;
  EXPECT_THROW(fitter.fit({samplesOf(motion)}, none), chain_dynamics::ModelError);
}

}  // namespace inverse_dynamics_identification::arm_fit_test

// SPDX-License-Identifier: Apache-2.0
/// @file
/// An arm of three joints with friction, measured in motion.
#pragma once

#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/friction.hpp>
#include <chain_dynamics/model.hpp>
#include <cmath>
#include <cstddef>
#include <vector>

#include "arms.hpp"
#include "inverse_dynamics_identification/arm_fit.hpp"

namespace inverse_dynamics_identification::arm_fit_test {

using chain_dynamics::FastModel;
using chain_dynamics::Model;

constexpr double kNoise = 0.05;  // N m

inline std::vector<StepFriction> knownFriction(FrictionTerms terms) {
  std::vector<StepFriction> laws = {{1.5, 2, 0.05, 0.02, -0.3, 0, 0, 0.4},
                                    {0.8, 1, 0.1, -0.03, 0.2, 0, 0, 0.4},
                                    {0.3, 0.5, 0.02, 0, 0, 0, 0, 0.4}};
  for (StepFriction& law : laws) {
    if (terms != FrictionTerms::kStep) law.fl = 0.08;
    if (terms == FrictionTerms::kStribeck) law.fs = law.fc;
  }
  return laws;
}

/// The motion of an arm with friction, rotor inertia and noise.
inline Motion measured(FrictionTerms terms, Eigen::Index count, unsigned seed,
                       double deviation = kNoise,
                       const LinkParameters& carried = LinkParameters::zero()) {
  const Chain alone = threeJointArm();
  std::vector<LinkParameters> links = alone.links();
  links.back() += carried;
  const Chain arm("arm", alone.joints(), links, alone.gravity());
  Motion motion = randomMotion(arm, count, seed);
  Eigen::MatrixXd gravity(3, count);
  FastModel(Model(arm)).gravityVectorBatch(motion.q, gravity);
  const std::vector<StepFriction> laws = knownFriction(terms);
  for (Eigen::Index k = 0; k < count; ++k) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      motion.tau(j, k) += 0.3 * motion.qdd(j, k) +
                          chain_dynamics::friction(laws[static_cast<std::size_t>(j)],
                                                   motion.qd(j, k), std::abs(gravity(j, k)));
    }
  }
  motion.tau += noise(3, count, deviation, seed + 1);
  return motion;
}

inline ArmSamples samplesOf(const Motion& motion) {
  return {motion.q, motion.qd, motion.qdd, motion.tau};
}

inline double errorOf(const ArmFitter& fitter, const ArmFit& fit, const Motion& motion) {
  Eigen::MatrixXd tau(motion.q.rows(), motion.q.cols());
  fitter.torques(fit, motion.q, motion.qd, motion.qdd, tau);
  return std::sqrt((tau - motion.tau).array().square().mean());
}

}  // namespace inverse_dynamics_identification::arm_fit_test

// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the examples of inverse_dynamics_identification take for granted. Compiled, never linked.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <inverse_dynamics_identification/arm_fit.hpp>
#include <inverse_dynamics_identification/arm_uncertainty.hpp>
#include <inverse_dynamics_identification/payload_estimator.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <memory>

using namespace chain_dynamics;
using namespace inverse_dynamics_identification;
using namespace inverse_dynamics_solver;

namespace given {

// A robot.
extern const Chain chain;
extern const FastModel fast;
extern const std::shared_ptr<InverseDynamicsSolver> solver;
extern Payload* const carrier;
extern const RigidBody body;
extern const LinkParameters link;
extern const std::size_t n;

// Samples of its motion.
extern const Eigen::VectorXd time;
extern Eigen::MatrixXd q, qd, qdd, tau, measured, computed;

// What means something else in each header.
namespace consistent_fit_examples {
extern const GramSamples samples;
extern const FitOptions options;
}  // namespace consistent_fit_examples
namespace arm_uncertainty_examples {
extern const ArmUncertainty uncertainty;
extern const Eigen::VectorXd q, qd, qdd, z;
extern Eigen::VectorXd tau;
extern Eigen::MatrixXd D;
}  // namespace arm_uncertainty_examples
namespace payload_estimator_examples {
extern const PayloadOptions options;
extern const bool moving;
extern const double time;
extern const Eigen::VectorXd q, qd, qdd, effort;
}  // namespace payload_estimator_examples
namespace tip_regressor_examples {
extern const Eigen::VectorXd q, qd, qdd;
extern Eigen::VectorXd tau;
extern Eigen::MatrixXd Y;
}  // namespace tip_regressor_examples

}  // namespace given

// SPDX-License-Identifier: Apache-2.0

#include "live_payload.hpp"

#include <chain_dynamics/chain.hpp>
#include <cstddef>
#include <cstdint>
#include <inverse_dynamics_evaluation/online_derivative.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>

namespace inverse_dynamics_ros {
namespace {

using inverse_dynamics_evaluation::OnlineDerivative;
using inverse_dynamics_identification::PayloadOptions;

// White part of the noise. Errors of the friction model, which are correlated, dominate it.
constexpr double kWhite = 0.3;

PayloadOptions optionsOf(const LivePayloadOptions& options) {
  PayloadOptions result;
  result.noise.white = kWhite * options.noise;
  result.noise.correlated = options.noise;
  result.carried = options.carried;
  return result;
}

}  // namespace

LivePayload::LivePayload(
    const std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver>& solver,
    const LivePayloadOptions& options)
    : solver_(solver),
      n_(solver->jointCount()),
      types_(solver->jointTypes()),
      without_gravity_(options.without_gravity),
      estimator_(solver, optionsOf(options)),
      filter_(3 * n_, options.cutoff, options.longest_gap),
      samples_(Eigen::VectorXd::Zero(3 * n_)),
      gravity_(Eigen::VectorXd::Zero(n_)) {}

void LivePayload::update(std::int64_t stamp, const Eigen::VectorXd& q, const Eigen::VectorXd& qd,
                         const Eigen::VectorXd& effort) {
  if (!q.allFinite() || !qd.allFinite() || !effort.allFinite()) return;
  // A continuous joint goes on where it is reported within one turn.
  for (Eigen::Index j = 0; j < n_; ++j) {
    samples_[j] = chain_dynamics::unwrapped(types_[static_cast<std::size_t>(j)], q[j], samples_[j]);
  }
  samples_.segment(n_, n_) = qd;
  samples_.tail(n_) = effort;
  if (without_gravity_) {
    solver_->getGravityVector(q, gravity_);
    samples_.tail(n_) += gravity_;
  }
  const OnlineDerivative::Step step = filter_.update(stamp, samples_);
  if (step == OnlineDerivative::Step::kWentBack) estimator_.restart();
  if (step == OnlineDerivative::Step::kRepeated || !filter_.settled()) return;
  const auto& late = filter_.value();
  estimator_.update(1e-9 * static_cast<double>(stamp), late.head(n_), late.segment(n_, n_),
                    filter_.derivative().segment(n_, n_), late.tail(n_));
}

}  // namespace inverse_dynamics_ros

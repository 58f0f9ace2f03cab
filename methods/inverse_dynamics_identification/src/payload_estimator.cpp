// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/payload_estimator.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/friction_state.hpp>
#include <chain_dynamics/owned.hpp>
#include <cmath>
#include <cstddef>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/friction_memory.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_identification/tip_regressor.hpp"
#include "nuisance.hpp"
#include "payload_solution.hpp"
#include "payload_sums.hpp"
#include "whitening.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

using inverse_dynamics_solver::ConstVectorRef;
using inverse_dynamics_solver::InvalidParameterValueException;
using inverse_dynamics_solver::InverseDynamicsSolver;
using Index = Eigen::Index;

constexpr std::size_t kLeastBlocks = 3;
constexpr int kMostRounds = 30;
constexpr double kSettled = 1e-7;    // relative change of the mass, and by the extent of the center
constexpr double kLeastMass = 1e-9;  // kg
constexpr double kLeastOffset = 0.05, kMostOffset = 3.0;  // shares of the noise
constexpr double kKnownInertia = 0.5;                     // half width by mean moment
constexpr double kFirstMass = 1.0;                        // kg, to start with

void require(bool fine, const std::string& option, const std::string& expected,
             const std::string& got) {
  if (fine) return;
  throw InvalidParameterValueException("payload: " + option, "", expected, got);
}

void requireNumbers(const chain_dynamics::OwnedVector& values, Index n, double least,
                    const std::string& option) {
  require(values.size() == n, option, std::to_string(n) + " numbers, one per joint",
          std::to_string(values.size()));
  for (Index j = 0; j < n; ++j) {
    require(values[j] >= least && std::isfinite(values[j]), option,
            "finite numbers" + std::string(least == 0.0 ? " >= 0" : ""), std::to_string(values[j]));
  }
}

void check(const PayloadOptions& options, Index n) {
  const double any = -std::numeric_limits<double>::max();
  requireNumbers(options.noise.white, n, 0.0, "noise.white");
  requireNumbers(options.noise.correlated, n, 0.0, "noise.correlated");
  for (Index j = 0; j < n; ++j) {
    require(options.noise.total(j) > 0, "noise", "a number above zero for each joint [N m]", "0");
  }
  const auto positive = [](double value, const std::string& option, const std::string& unit) {
    require(value > 0 && std::isfinite(value), option, "a finite number above zero [" + unit + "]",
            std::to_string(value));
  };
  positive(options.noise.correlation_time, "noise.correlation_time", "s");
  positive(options.extent, "extent", "m");
  positive(options.block, "block", "s");
  require(options.model_error >= 0 && std::isfinite(options.model_error), "model_error",
          "a finite number >= 0", std::to_string(options.model_error));
  if (options.offset.size() > 0) requireNumbers(options.offset, n, any, "offset");
  if (options.offset_deviation.size() > 0) {
    requireNumbers(options.offset_deviation, n, 0.0, "offset_deviation");
    require((options.offset_deviation.array() > 0).all(), "offset_deviation",
            "numbers above zero [N m]", "0");
  }
  if (const auto defect = inverse_dynamics_solver::defectOf(options.carried)) {
    require(false, "carried: " + defect->field, defect->expected, defect->got);
  }
}

}  // namespace

const char* text(PayloadStatus status) noexcept {
  switch (status) {
    case PayloadStatus::kOk:
      return "an estimate";
    case PayloadStatus::kNotLater:
      return "the sample isn't later than the last one: left out";
    case PayloadStatus::kNotFinite:
      return "a number isn't finite: left out";
    case PayloadStatus::kTooShort:
      return "too few blocks of time for an interval: no estimate yet";
    case PayloadStatus::kSolverFailed:
      return "the solver failed: sample left out";
    case PayloadStatus::kWrongSize:
      return "an argument hasn't one number per joint, or the estimate one per deviation of the "
             "arm";
  }
  return "unknown status";
}

PayloadEstimate::PayloadEstimate(Index joints, Index arm_deviations) {
  offset.setZero(joints);
  arm.setZero(arm_deviations);
  covariance = Eigen::MatrixXd::Zero(10, 10);
}

inverse_dynamics_solver::RigidBody PayloadEstimate::body() const {
  inverse_dynamics_solver::RigidBody body{mass};
  body.center_of_mass = center_of_mass;
  if (inertia_is_known) body.inertia = inertia;
  return body;
}

struct PayloadEstimator::Impl {
  Impl(std::shared_ptr<const InverseDynamicsSolver> arm, const PayloadOptions& given)
      : regressor(arm),
        solver(std::move(arm)),
        friction(frictionState(*solver)),
        deviations(deviationsOf(solver, given.arm)),
        sums(solver->jointCount(), deviationCount(), given.block),
        part(deviationCount()),
        nuisance(solver->jointCount(), deviationCount()),
        without(nuisance),
        span(given.noise.correlation_time) {
    const Index n = solver->jointCount(), K = deviationCount();
    check(given, n);
    const auto joints = static_cast<std::size_t>(n);
    extent = given.extent;
    model_error = given.model_error;
    carried = inverse_dynamics_solver::inTipFrame(given.carried).toVector();
    estimates_offsets = given.offset_deviation.size() == 0;
    for (Index j = 0; j < n; ++j) {
      const double white = given.noise.white[j], correlated = given.noise.correlated[j];
      filters.emplace_back(white * white, correlated * correlated, given.noise.correlation_time);
      noise.push_back(given.noise.total(j));
      OffsetPrior prior{given.offset.size() > 0 ? given.offset[j] : 0.0, noise.back()};
      if (!estimates_offsets) prior.variance = given.offset_deviation[j];
      prior.variance *= prior.variance;
      offsets.push_back(prior);
    }
    rows.assign(joints, Row::Zero());
    states = rows;
    arm_states.assign(joints, Eigen::VectorXd::Zero(K));
    total.assign(joints, JointSums(K));
    priors.resize(joints);
    Y = Eigen::MatrixXd::Zero(n, 10);
    torques.setZero(n);
    D = Eigen::MatrixXd::Zero(K, n);
    arm_rows = arm_states;
    restart();
  }

  static std::optional<ArmDeviations> deviationsOf(
      const std::shared_ptr<const InverseDynamicsSolver>& solver,
      const ArmUncertainty& uncertainty) {
    if (uncertainty.factor.size() == 0) return std::nullopt;
    return ArmDeviations(solver, uncertainty);
  }
  Index deviationCount() const { return deviations ? deviations->count() : 0; }

  void restart() {
    friction.reset();
    sums.restart();
    for (auto& filter : filters) filter.restart();
    span.restart();
    for (std::size_t j = 0; j < rows.size(); ++j) clearRows(j);
    samples = 0;
  }

  PayloadStatus update(double time, const ConstVectorRef& q, const ConstVectorRef& qd,
                       const ConstVectorRef& qdd, const ConstVectorRef& measured);
  PayloadStatus estimate(PayloadEstimate& found);
  void addMean();
  void clearRows(std::size_t joint) {
    rows[joint].setZero();
    arm_rows[joint].setZero();
  }
  void addUp(std::size_t blocks);
  Normal sumOfJoints();
  Vector10 solve(Normal& normal, Matrix10& H);
  Matrix10 jackknife(std::size_t blocks, const Vector10& phi, const Normal& normal,
                     const Matrix10& H);
  void fill(const Vector10& phi, const Matrix10& jackknife, const Matrix10& A, const Matrix10& H,
            std::size_t blocks, PayloadEstimate& found);

  TipRegressor regressor;
  std::shared_ptr<const InverseDynamicsSolver> solver;
  chain_dynamics::FrictionState friction;
  std::optional<ArmDeviations> deviations;  // none: the model of the arm is exact
  PayloadSums sums;
  double extent = 0.0, model_error = 0.0;
  Vector10 carried = Vector10::Zero();
  bool estimates_offsets = true;
  std::vector<NoiseFilter> filters;
  std::vector<double> noise;                          // N m
  std::vector<OffsetPrior> offsets;                   // as given
  std::vector<OffsetPrior> priors;                    // as estimated
  std::vector<Row> rows, states;                      // sums of those of a mean; of the filters
  std::vector<Eigen::VectorXd> arm_rows, arm_states;  // likewise
  std::vector<JointSums> total;                       // of all blocks
  JointSums part;                                     // of a block
  Nuisance nuisance, without;                         // of all joints, and without a block of one
  MeanSpan span;
  chain_dynamics::OwnedMatrix Y;  // n x 10
  chain_dynamics::OwnedVector torques;
  chain_dynamics::OwnedMatrix D;   // K x n
  double first = 0.0, last = 0.0;  // s
  double last_mean = 0.0;          // s
  std::size_t samples = 0;
};

PayloadStatus PayloadEstimator::Impl::update(double time, const ConstVectorRef& q,
                                             const ConstVectorRef& qd, const ConstVectorRef& qdd,
                                             const ConstVectorRef& measured) {
  const Index n = solver->jointCount();
  if (q.size() != n || qd.size() != n || qdd.size() != n || measured.size() != n) {
    return PayloadStatus::kWrongSize;
  }
  if (!std::isfinite(time)) return PayloadStatus::kNotFinite;
  if (samples > 0 && !(time > last)) return PayloadStatus::kNotLater;
  friction.move(q);
  solver->getTorques(q, qd, qdd, torques);
  friction.addTo(qd, torques);
  regressor.compute(q, qd, qdd, Y);
  torques = measured - torques;
  torques.noalias() += Y.lazyProduct(carried);
  if (deviations) deviations->compute(q, qd, qdd, D);
  if (!torques.allFinite() || !Y.allFinite() || !D.allFinite()) return PayloadStatus::kNotFinite;
  if (span.endsBefore(time)) addMean();
  span.add(time);
  for (Index j = 0; j < n; ++j) {
    const auto joint = static_cast<std::size_t>(j);
    Row row;
    row << Y.row(j).transpose(), 1.0, torques[j];
    rows[joint] += row;
    arm_rows[joint] += D.col(j);
  }
  if (samples == 0) first = time;
  last = time;
  ++samples;
  return PayloadStatus::kOk;
}

/// Filters the mean of the samples since the last one.
void PayloadEstimator::Impl::addMean() {
  if (span.isEmpty()) return;
  const double time = span.time(), weight = span.weight();
  sums.begin(time);
  for (std::size_t j = 0; j < rows.size(); ++j) {
    rows[j] *= weight;
    arm_rows[j] *= weight;
    filters[j].advance(time - last_mean);
    filters[j].whiten(arm_rows[j], arm_states[j]);
    sums.add(j, filters[j].innovations(rows[j], states[j]), arm_rows[j]);
    clearRows(j);
  }
  last_mean = time;
  span.restart();
}

void PayloadEstimator::Impl::addUp(std::size_t blocks) {
  for (std::size_t j = 0; j < total.size(); ++j) {
    total[j].setZero();
    for (std::size_t block = 0; block < blocks; ++block) {
      sums.get(block, j, blocks, part);
      total[j] += part;
    }
  }
}

Normal PayloadEstimator::Impl::sumOfJoints() {
  nuisance.begin(priors);
  Index joint = 0;
  for (const JointSums& sum : total) nuisance.add(joint++, sum);
  return nuisance.solve();
}

/// The body, with mass and center of the prior, and the size of offsets, at those of the body. H:
/// what data and the prior of the inertia say.
Vector10 PayloadEstimator::Impl::solve(Normal& normal, Matrix10& H) {
  double mass = kFirstMass;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Vector10 phi = Vector10::Zero();
  priors = offsets;
  for (int round = 0; round < kMostRounds; ++round) {
    normal = sumOfJoints();
    const BodyPrior prior(mass, center, extent);
    phi = mostLikelyBody(normal, prior);
    H = normal.A + prior.inertiaInformation(phi);
    H += leastInformation(H);
    if (estimates_offsets) {
      const Matrix10 V = H.ldlt().solve(Matrix10::Identity());
      double squares = 0.0;
      for (std::size_t j = 0; j < total.size(); ++j) {
        const OffsetPrior offset = nuisance.offset(static_cast<Index>(j), phi, V);
        const double change = offset.mean - offsets[j].mean;
        squares += (change * change + offset.variance) / (noise[j] * noise[j]);
      }
      const double share = std::clamp(std::sqrt(squares / static_cast<double>(total.size())),
                                      kLeastOffset, kMostOffset);
      for (std::size_t j = 0; j < total.size(); ++j) {
        priors[j].variance = share * share * noise[j] * noise[j];
      }
    }
    const Eigen::Vector3d next = phi.segment<3>(1) / phi[0];
    const bool settled =
        std::abs(phi[0] - mass) <= kSettled * mass && (next - center).norm() <= kSettled * extent;
    mass = std::max(phi[0], kLeastMass);
    center = next;
    if (settled) break;
  }
  return phi;
}

/// CR3: what leaving out each block of each joint changes.
Matrix10 PayloadEstimator::Impl::jackknife(std::size_t blocks, const Vector10& phi,
                                           const Normal& normal, const Matrix10& H) {
  Matrix10 V = Matrix10::Zero();
  for (std::size_t j = 0; j < total.size(); ++j) {
    for (std::size_t block = 0; block < blocks; ++block) {
      sums.get(block, j, blocks, part);
      without = nuisance;
      without.add(static_cast<Index>(j), part, -1.0);
      Normal change = without.solve();
      change.A -= normal.A;
      change.b -= normal.b;
      const Matrix10 H_rest = H + change.A;
      const Vector10 by = H_rest.ldlt().solve(change.A * phi - change.b);
      V.noalias() += by * by.transpose();
    }
  }
  const auto count = static_cast<double>(blocks);
  return V * ((count - 1.0) / count);
}

/// Half widths of linear functions of the body: what leaving data out changes and what the arm's
/// model is wrong by, but no less than the noise gives, which is infinite where no sample tells
/// anything.
struct HalfWidths {
  Matrix10 jackknife, textbook;
  double model_error;
  double freedom;  // degrees of, of the jackknife

  double of(const Vector10& slope) const {
    const double varies = slope.dot(jackknife * slope), noise = slope.dot(textbook * slope);
    const double sum = varies + model_error * noise;
    // Welch and Satterthwaite: only the jackknife's variance is an estimate
    const double ratio = varies > 0 ? sum / varies : std::numeric_limits<double>::infinity();
    return studentT(freedom * ratio * ratio) * std::sqrt(std::max(sum, noise));
  }
};

void fillInertia(const Vector10& phi, const Matrix10& V, const Matrix10& A, double t,
                 PayloadEstimate& found) {
  // Without the prior, and by as much less sure than independent noise has it as the mass and the
  // first moments are.
  const Matrix10 textbook = covarianceOf(A);
  const double inflation = std::max(
      1.0, (V.diagonal().head<4>().array() / textbook.diagonal().head<4>().array()).maxCoeff());
  Matrix10 slopes = Matrix10::Zero();  // columns: of the six entries of the inertia
  for (Index k = 0; k < 10; ++k) {
    const Eigen::Matrix3d dI = centralInertiaChange(phi, Vector10::Unit(k));
    slopes.row(k).head<6>() << dI(0, 0), dI(0, 1), dI(0, 2), dI(1, 1), dI(1, 2), dI(2, 2);
  }
  constexpr Index kRow[] = {0, 0, 0, 1, 1, 2}, kColumn[] = {0, 1, 2, 1, 2, 2};
  for (Index i = 0; i < 6; ++i) {
    const Vector10 slope = slopes.col(i);
    const double half = t * std::sqrt(inflation * slope.dot(textbook * slope));
    found.inertia_half_width(kRow[i], kColumn[i]) = half;
    found.inertia_half_width(kColumn[i], kRow[i]) = half;
  }
  found.inertia =
      chain_dynamics::inertiaAboutCenter(chain_dynamics::LinkParameters::fromVector(phi));
  found.inertia_is_known =
      found.inertia_half_width.diagonal().maxCoeff() < kKnownInertia * found.inertia.trace() / 3.0;
}

void PayloadEstimator::Impl::fill(const Vector10& phi, const Matrix10& jackknife, const Matrix10& A,
                                  const Matrix10& H, std::size_t blocks, PayloadEstimate& found) {
  const double m = phi[0], freedom = static_cast<double>(blocks) - 1.0;
  const HalfWidths half_widths{jackknife, covarianceOf(H), model_error, freedom};
  const Matrix10 V = jackknife + model_error * half_widths.textbook;
  found.mass = m;
  found.mass_half_width = half_widths.of(Vector10::Unit(0));
  found.center_of_mass = phi.segment<3>(1) / m;
  for (Index i = 0; i < 3; ++i) {
    Vector10 slope = Vector10::Zero();  // of c_i = h_i / m
    slope[0] = -found.center_of_mass[i] / m;
    slope[1 + i] = 1.0 / m;
    found.center_of_mass_half_width[i] = half_widths.of(slope);
  }
  fillInertia(phi, V, A, studentT(freedom), found);
  found.covariance = V;
  for (std::size_t j = 0; j < total.size(); ++j) {
    const auto joint = static_cast<Index>(j);
    found.offset[joint] = nuisance.offset(joint, phi, V).mean;
  }
  nuisance.deviations(phi, found.arm);
  found.blocks = static_cast<Index>(blocks);
  found.duration = last - first;
}

PayloadStatus PayloadEstimator::Impl::estimate(PayloadEstimate& found) {
  if (found.offset.size() != solver->jointCount() || found.covariance.rows() != 10 ||
      found.arm.size() != deviationCount()) {
    return PayloadStatus::kWrongSize;
  }
  addMean();
  const std::size_t blocks = samples > 0 ? sums.blocks(last) : 0;
  if (blocks < kLeastBlocks) return PayloadStatus::kTooShort;
  addUp(blocks);
  Normal normal;
  Matrix10 H;
  const Vector10 phi = solve(normal, H);
  const Matrix10 V = jackknife(blocks, phi, normal, H);
  if (!phi.allFinite() || !V.allFinite()) return PayloadStatus::kNotFinite;
  fill(phi, V, normal.A, H, blocks, found);
  return PayloadStatus::kOk;
}

PayloadEstimator::PayloadEstimator(std::shared_ptr<const InverseDynamicsSolver> solver,
                                   const PayloadOptions& options)
    : impl_(std::make_unique<Impl>(std::move(solver), options)) {}
PayloadEstimator::~PayloadEstimator() = default;
PayloadEstimator::PayloadEstimator(PayloadEstimator&&) noexcept = default;
PayloadEstimator& PayloadEstimator::operator=(PayloadEstimator&&) noexcept = default;

Index PayloadEstimator::jointCount() const noexcept { return impl_->solver->jointCount(); }

PayloadStatus PayloadEstimator::update(double time, const ConstVectorRef& q,
                                       const ConstVectorRef& qd, const ConstVectorRef& qdd,
                                       const ConstVectorRef& measured) noexcept {
  try {
    return impl_->update(time, q, qd, qdd, measured);
  } catch (...) {
    return PayloadStatus::kSolverFailed;
  }
}

PayloadStatus PayloadEstimator::estimate(PayloadEstimate& found) noexcept {
  return impl_->estimate(found);
}

void PayloadEstimator::restart() noexcept { impl_->restart(); }

}  // namespace v2
}  // namespace inverse_dynamics_identification

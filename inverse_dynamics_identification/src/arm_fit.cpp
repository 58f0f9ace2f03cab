// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/arm_fit.hpp"

#include <algorithm>
#include <chain_dynamics/error.hpp>
#include <cmath>
#include <string>
#include <utility>

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

using chain_dynamics::Chain;
using chain_dynamics::ConstStates;
using chain_dynamics::Model;
using chain_dynamics::ModelError;
using chain_dynamics::RegressorGram;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSettledStep = 0.02;  // Gauss-Newton step, relative to the width, that ends it
const double kGainDeviation = std::log(kDriveGainFactor);
constexpr double kSettledGain = 1e-3;  // the same, of the logarithm of a drive gain
constexpr double kFixed = 1e-9;        // deviation of a column that is switched off
constexpr int kNoiseIterations = 4;

double logRatio(double to, double from) { return std::log(to / from); }

/// What width, shift and vs are drawn to, and their bounds, of one joint.
class StepPrior {
 public:
  StepPrior(const FrictionPrior& prior, double greatest_velocity)
      : prior_(prior), greatest_(std::max(greatest_velocity, 1e-6)) {}

  StepFriction start() const {
    StepFriction law;
    law.width = prior_.width * greatest_;
    law.vs = prior_.stribeck_velocity * greatest_;
    return law;
  }

  /// Of the columns, with the step of width, shift and vs free or held.
  std::vector<OwnColumn> columns(const StepFriction& law, FrictionTerms terms, bool free) const {
    const double infinity = std::numeric_limits<double>::infinity();
    std::vector<OwnColumn> columns(static_cast<std::size_t>(ownColumns(terms)));
    for (const Index c : {own_column::kAcceleration, own_column::kVelocity, own_column::kStep}) {
      columns[at(c)] = OwnColumn::positive();
    }
    columns[at(own_column::kOne)] = {false, infinity, 0, 1e4};  // for a joint that stands still
    const double factor = std::log(prior_.width_factor);
    columns[at(own_column::kShift)] = step(-law.shift, prior_.shift * greatest_, free);
    columns[at(own_column::kWidth)] =
        step(logRatio(prior_.width * greatest_, law.width), factor, free);
    if (terms == FrictionTerms::kStep) return columns;
    columns[at(own_column::kLoad)] = {true, prior_.most_load, 0, prior_.load};
    if (terms == FrictionTerms::kLoad) return columns;
    columns[at(own_column::kStribeck)] = OwnColumn::positive();
    columns[at(own_column::kStribeckVelocity)] =
        step(logRatio(prior_.stribeck_velocity * greatest_, law.vs), factor, free);
    return columns;
  }

  /// Penalty of width, shift and vs themselves.
  double penalty(const StepFriction& law, FrictionTerms terms) const {
    const double factor = std::log(prior_.width_factor);
    const double shift = law.shift / (prior_.shift * greatest_);
    const double width = logRatio(prior_.width * greatest_, law.width) / factor;
    const double vs = terms == FrictionTerms::kStribeck
                          ? logRatio(prior_.stribeck_velocity * greatest_, law.vs) / factor
                          : 0.0;
    return shift * shift + width * width + vs * vs;
  }

  /// The law after a step of (shift, log width, log vs, and what isn't its own), within bounds.
  StepFriction moved(StepFriction law, const Eigen::Vector4d& by) const {
    const double most = prior_.most_shift * greatest_;
    law.shift = std::clamp(law.shift + std::clamp(by[0], -law.width, law.width), -most, most);
    law.width = std::clamp(law.width * std::exp(std::clamp(by[1], -1.0, 1.0)),
                           prior_.least_width * greatest_, prior_.most_width * greatest_);
    law.vs = std::clamp(law.vs * std::exp(std::clamp(by[2], -1.0, 1.0)), 2 * law.width, greatest_);
    return law;
  }

  /// Of a step whose coefficient is drawn to the center, or held.
  static OwnColumn step(double center, double deviation, bool free) {
    const double infinity = std::numeric_limits<double>::infinity();
    return free ? OwnColumn{false, infinity, center, deviation}
                : OwnColumn{false, infinity, 0, kFixed * deviation};
  }

 private:
  static std::size_t at(Index column) { return static_cast<std::size_t>(column); }

  FrictionPrior prior_;
  double greatest_;
};

VectorXd greatestVelocities(Index joints, const std::vector<ArmSamples>& blocks) {
  VectorXd greatest = VectorXd::Zero(joints);
  for (const ArmSamples& block : blocks) {
    for (Index k = 0; k < block.qd.count; ++k) {
      for (Index j = 0; j < joints; ++j) {
        greatest[j] = std::max(greatest[j], std::abs(block.qd(j, k)));
      }
    }
  }
  return greatest;
}

void checkSamples(Index joints, const std::vector<ArmSamples>& blocks) {
  Index samples = 0;
  for (const ArmSamples& block : blocks) {
    for (const ConstStates& states : {block.q, block.qd, block.qdd, block.tau}) {
      if (states.joints != joints || states.count != block.q.count) {
        throw ModelError(
            "ArmFitter: samples", "q, qd, qdd, tau",
            std::to_string(joints) + " joints and as many samples each",
            std::to_string(states.joints) + " joints, " + std::to_string(states.count) + " samples",
            "pair each torque with its state");
      }
    }
    samples += block.q.count;
  }
  if (samples == 0) throw ModelError("ArmFitter: expected samples, got none");
}

bool areGains(Index joints, const OwnedVector& gains) {
  return gains.size() == 0 || (gains.size() == joints && gains.allFinite() && gains.minCoeff() > 0);
}

void checkOptions(Index joints, const ArmFitOptions& options) {
  if (options.most_passes < 1) {
    throw ModelError("ArmFitter: options", "most_passes", "1 or more",
                     std::to_string(options.most_passes), "");
  }
  if (!areGains(joints, options.drive_gains)) {
    throw ModelError("ArmFitter: options", "drive_gains",
                     std::to_string(joints) + " finite numbers > 0 [N m/A]", "others",
                     "leave them out where torques were measured");
  }
}

/// The unknowns of a fit, the steps of shift, width and vs zero.
Fit linearPart(const ArmFit& arm, FrictionTerms terms) {
  Fit fit;
  fit.parameters = arm.parameters;
  fit.noise = fit.weighed_by = arm.noise;
  const Index columns = ownColumns(terms);
  fit.own = MatrixXd::Zero(columns + (arm.drive_gains.size() > 0 ? 1 : 0), arm.parameters.cols());
  fit.own.row(own_column::kAcceleration) = arm.rotor_inertia.transpose();
  for (Index j = 0; j < fit.own.cols(); ++j) {
    const StepFriction& law = arm.friction[static_cast<std::size_t>(j)];
    fit.own(own_column::kVelocity, j) = law.fv;
    fit.own(own_column::kOne, j) = law.fo;
    fit.own(own_column::kStep, j) = law.fc;
    if (columns > own_column::kLoad) fit.own(own_column::kLoad, j) = law.fl;
    if (columns > own_column::kStribeck) fit.own(own_column::kStribeck, j) = law.fs;
  }
  return fit;
}

/// The fits that take turns with passes over the samples.
class Rounds {
 public:
  Rounds(const ArmFitter& fitter, const std::vector<ArmSamples>& blocks,
         const ArmFitOptions& options)
      : fitter_(fitter), blocks_(blocks), options_(options) {
    const Index n = fitter.description().jointCount();
    const VectorXd greatest = greatestVelocities(n, blocks);
    for (Index j = 0; j < n; ++j) steps_.emplace_back(options.friction, greatest[j]);
    gains_ = options.drive_gains.size() > 0;
  }

  /// Of all unknowns at a fit; free: with steps of shift, width and vs.
  Prior prior(const ArmFit& fit, bool free) const {
    Prior prior;
    for (const LinkPrior& link : fitter_.prior()) prior.links.push_back(link.link);
    for (std::size_t j = 0; j < steps_.size(); ++j) {
      const auto columns = steps_[j].columns(fit.friction[j], options_.terms, free);
      prior.own.insert(prior.own.end(), columns.begin(), columns.end());
      if (gains_) prior.own.push_back(StepPrior::step(-gainRatio(fit, j), kGainDeviation, free));
    }
    return prior;
  }

  /// The best fit of all passes.
  ArmFit run(const ArmFit* start) {
    ArmFit tried = start != nullptr ? *start : beginning();
    if (!gains_ || tried.drive_gains.size() != joints()) tried.drive_gains = options_.drive_gains;
    if (options_.terms != FrictionTerms::kStribeck) withoutStribeck(tried);
    if (start != nullptr) last_ = linearPart(tried, options_.terms);
    ArmFit best, current;
    best.cost = current.cost = std::numeric_limits<double>::infinity();
    std::vector<Eigen::Vector4d> by;
    int pass = 1;
    for (; pass <= options_.most_passes; ++pass) {
      RegressorGram gram(joints(), ownColumns(options_.terms) + (gains_ ? 1 : 0));
      for (const ArmSamples& block : blocks_) fitter_.addToGram(tried, block, gram);
      const Fit held = consistentFit(gram, prior(tried, false), fitOptions(), last());
      ArmFit next = with(tried, held);
      next.cost = cost(held, next, gram.samples());
      const bool known = pass > 1 || start != nullptr;  // the columns' heights and loads
      const double gain = current.cost - next.cost;
      // the way to a better fit may begin with a worse one
      if (!(gain > 0) && pass > 2) {
        if (!shrink(by)) break;
        tried = moved(current, by);
        continue;
      }
      current = next;
      last_ = held;
      if (next.cost < best.cost) best = next;
      by = known ? stepOf(gram, next, held) : std::vector<Eigen::Vector4d>(steps_.size(), zero());
      if (known && (settled(by, next) || (pass > 2 && gain < kGain))) break;
      if (!known && options_.most_passes > 1) best.cost = std::numeric_limits<double>::infinity();
      tried = moved(next, by);
    }
    best.passes = std::min(pass, options_.most_passes);
    return best;
  }

 private:
  static constexpr double kGain = 1e-1;  // of the cost, that is worth another pass
  static Eigen::Vector4d zero() { return Eigen::Vector4d::Zero(); }
  Index joints() const { return static_cast<Index>(steps_.size()); }

  ArmFit beginning() const {
    ArmFit fit;
    fit.parameters.resize(10, joints());
    for (Index j = 0; j < joints(); ++j) {
      fit.parameters.col(j) = fitter_.prior()[static_cast<std::size_t>(j)].link.toVector();
    }
    fit.rotor_inertia.setZero(joints());
    for (const StepPrior& step : steps_) fit.friction.push_back(step.start());
    return fit;
  }

  static void withoutStribeck(ArmFit& fit) {
    for (StepFriction& law : fit.friction) law.fs = 0;
  }

  FitOptions fitOptions() const {
    FitOptions options;
    options.prior_strength = options_.prior_strength;
    options.noise_iterations = kNoiseIterations;
    if (last_.noise.size() > 0) options.noise = last_.noise;
    return options;
  }

  /// The fit of the last pass, or what to start from.
  const Fit* last() const { return last_.own.size() > 0 ? &last_ : nullptr; }

  ArmFit with(const ArmFit& tried, const Fit& fit) const {
    ArmFit next = tried;
    next.parameters = fit.parameters;
    next.rotor_inertia = fit.own.row(own_column::kAcceleration).transpose();
    next.noise = fit.noise;
    for (Index j = 0; j < joints(); ++j) {
      StepFriction& law = next.friction[static_cast<std::size_t>(j)];
      law.fv = fit.own(own_column::kVelocity, j);
      law.fo = fit.own(own_column::kOne, j);
      law.fc = fit.own(own_column::kStep, j);
      const Index columns = ownColumns(options_.terms);
      law.fl = columns > own_column::kLoad ? fit.own(own_column::kLoad, j) : 0.0;
      law.fs = columns > own_column::kStribeck ? fit.own(own_column::kStribeck, j) : 0.0;
    }
    return next;
  }

  /// Logarithm of a drive gain by the one to start from.
  double gainRatio(const ArmFit& fit, std::size_t j) const {
    const auto i = static_cast<Index>(j);
    return logRatio(fit.drive_gains[i], options_.drive_gains[i]);
  }

  /// Twice the negative logarithm of the likelihood of what was measured, with the penalties.
  double cost(const Fit& fit, const ArmFit& arm, Index samples) const {
    const auto N = static_cast<double>(samples);
    double sum = fit.cost - N * (fit.noise.array() / fit.weighed_by.array()).square().sum() +
                 2 * N * fit.noise.array().log().sum();
    for (std::size_t j = 0; j < steps_.size(); ++j) {
      sum += steps_[j].penalty(arm.friction[j], options_.terms);
      if (!gains_) continue;
      const double ratio = gainRatio(arm, j) / kGainDeviation;
      sum += ratio * ratio - 2 * N * std::log(arm.drive_gains[static_cast<Index>(j)]);
    }
    return sum;
  }

  std::vector<Eigen::Vector4d> stepOf(const RegressorGram& gram, const ArmFit& arm,
                                      const Fit& held) const {
    FitOptions options = fitOptions();
    options.noise = held.noise;
    options.noise_iterations = 1;
    const Fit fit = consistentFit(gram, prior(arm, true), options, &held);
    std::vector<Eigen::Vector4d> by;
    for (Index j = 0; j < joints(); ++j) {
      const bool stribeck = options_.terms == FrictionTerms::kStribeck;
      by.emplace_back(fit.own(own_column::kShift, j), fit.own(own_column::kWidth, j),
                      stribeck ? fit.own(own_column::kStribeckVelocity, j) : 0.0,
                      gains_ ? fit.own(fit.own.rows() - 1, j) : 0.0);
    }
    return by;
  }

  ArmFit moved(const ArmFit& fit, const std::vector<Eigen::Vector4d>& by) const {
    ArmFit result = fit;
    for (std::size_t j = 0; j < steps_.size(); ++j) {
      result.friction[j] = steps_[j].moved(fit.friction[j], by[j]);
      if (gains_) {
        result.drive_gains[static_cast<Index>(j)] *= std::exp(std::clamp(by[j][3], -1.0, 1.0));
      }
    }
    return result;
  }

  /// Whether a smaller step is worth another try.
  bool shrink(std::vector<Eigen::Vector4d>& by) {
    for (Eigen::Vector4d& step : by) step *= 0.3;
    return ++shrunk_ <= 2;
  }

  static bool settled(const std::vector<Eigen::Vector4d>& by, const ArmFit& fit) {
    for (std::size_t j = 0; j < by.size(); ++j) {
      const Eigen::Vector4d step(by[j][0] / fit.friction[j].width, by[j][1], by[j][2],
                                 by[j][3] * kSettledStep / kSettledGain);
      if (step.cwiseAbs().maxCoeff() > kSettledStep) return false;
    }
    return true;
  }

  const ArmFitter& fitter_;
  const std::vector<ArmSamples>& blocks_;
  const ArmFitOptions& options_;
  std::vector<StepPrior> steps_;
  bool gains_ = false;  // whether they are fitted
  Fit last_;
  int shrunk_ = 0;
};

/// Links without motor or friction: the regressor's, and its gravity.
Chain withoutMotors(const Chain& chain, std::vector<LinkParameters> links) {
  std::vector<chain_dynamics::Joint> joints = chain.joints();
  for (chain_dynamics::Joint& joint : joints) joint.rotor_inertia = 0;
  return Chain(chain.name(), std::move(joints), std::move(links), chain.gravity(), chain.tip());
}

std::vector<LinkPrior> priorsOf(const Chain& description, const LinkFloor& floor) {
  std::vector<LinkPrior> priors;
  for (const LinkParameters& link : description.links()) priors.push_back(linkPrior(link, floor));
  return priors;
}

std::vector<LinkParameters> linksOf(const std::vector<LinkPrior>& priors) {
  std::vector<LinkParameters> links;
  links.reserve(priors.size());
  for (const LinkPrior& prior : priors) links.push_back(prior.link);
  return links;
}

}  // namespace

ArmFitter::ArmFitter(const Chain& description, const LinkFloor& floor)
    : chain_(description),
      prior_(priorsOf(description, floor)),
      fast_(Model(withoutMotors(description, linksOf(prior_)))) {}

void ArmFitter::check(const ArmFit& fit) const {
  const Index joints = chain_.jointCount();
  const bool fits = fit.parameters.rows() == 10 && fit.parameters.cols() == joints &&
                    fit.rotor_inertia.size() == joints && areGains(joints, fit.drive_gains) &&
                    static_cast<Index>(fit.friction.size()) == joints;
  if (!fits) {
    throw ModelError("ArmFitter: fit", "parameters, rotor_inertia, friction",
                     "those of " + std::to_string(joints) + " joints",
                     "of " + std::to_string(fit.parameters.cols()), "fit the same arm");
  }
}

ArmFit ArmFitter::fit(const std::vector<ArmSamples>& blocks, const ArmFitOptions& options,
                      const ArmFit* start) const {
  checkSamples(chain_.jointCount(), blocks);
  if (start != nullptr) check(*start);
  checkOptions(chain_.jointCount(), options);
  return Rounds(*this, blocks, options).run(start);
}

ArmInformation ArmFitter::information(const ArmFit& fit, const std::vector<ArmSamples>& blocks,
                                      const ArmFitOptions& options) const {
  checkSamples(chain_.jointCount(), blocks);
  check(fit);
  ArmFitOptions of = options;
  of.drive_gains = fit.drive_gains;  // a step begins at the fit
  if (fit.noise.size() != chain_.jointCount()) {
    throw ModelError("ArmFitter: fit", "noise", std::to_string(chain_.jointCount()) + " numbers",
                     std::to_string(fit.noise.size()), "take a fit to samples");
  }
  const Fit linear = linearPart(fit, options.terms);
  RegressorGram all(chain_.jointCount(), linear.own.rows());
  VectorXd x(all.unknowns());
  x << Eigen::Map<const VectorXd>(linear.parameters.data(), linear.parameters.size()),
      Eigen::Map<const VectorXd>(linear.own.data(), linear.own.size());
  const VectorXd weights = fit.noise.array().square().inverse();
  ArmInformation result;
  result.scores.resize(x.size(), static_cast<Index>(blocks.size()));
  MatrixXd A(x.size(), x.size());
  VectorXd b(x.size());
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    RegressorGram gram(chain_.jointCount(), linear.own.rows());
    addToGram(fit, blocks[k], gram);
    gram.normalEquations(weights, A, b);
    result.scores.col(static_cast<Index>(k)) = b - A * x;
    all.add(gram);
  }
  FitOptions how;
  how.prior_strength = options.prior_strength;
  Information found = ::inverse_dynamics_identification::information(
      all, Rounds(*this, blocks, of).prior(fit, true), how, linear);
  result.data = std::move(found.data);
  result.prior = std::move(found.prior);
  return result;
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

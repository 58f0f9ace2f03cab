// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/arm_fit.hpp"

#include <algorithm>
#include <chain_dynamics/error.hpp>
#include <cmath>
#include <functional>
#include <limits>
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
constexpr int kNoiseIterations = 4;

double logRatio(double to, double from) { return std::log(to / from); }

OwnColumn drawnTo(double center, double deviation) {
  return {false, std::numeric_limits<double>::infinity(), center, deviation};
}

/// The own columns of a fit whose shift, width, vs and drive gains are held.
std::vector<Index> heldColumns(FrictionTerms terms) {
  using namespace own_column;
  std::vector<Index> columns = {kAcceleration, kVelocity, kOne, kStep};
  if (terms != FrictionTerms::kStep) columns.push_back(kLoad);
  if (terms == FrictionTerms::kStribeck) columns.push_back(kStribeck);
  return columns;
}

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

  /// Of all columns.
  std::vector<OwnColumn> columns(const StepFriction& law, FrictionTerms terms) const {
    const double infinity = std::numeric_limits<double>::infinity();
    std::vector<OwnColumn> columns(static_cast<std::size_t>(ownColumns(terms)));
    for (const Index c : {own_column::kAcceleration, own_column::kVelocity, own_column::kStep}) {
      columns[at(c)] = OwnColumn::positive();
    }
    columns[at(own_column::kOne)] = {false, infinity, 0, 1e4};  // for a joint that stands still
    const double factor = std::log(prior_.width_factor);
    columns[at(own_column::kShift)] = drawnTo(-law.shift, prior_.shift * greatest_);
    columns[at(own_column::kWidth)] =
        drawnTo(logRatio(prior_.width * greatest_, law.width), factor);
    if (terms == FrictionTerms::kStep) return columns;
    columns[at(own_column::kLoad)] = {true, prior_.most_load, 0, prior_.load};
    if (terms == FrictionTerms::kLoad) return columns;
    columns[at(own_column::kStribeck)] = OwnColumn::positive();
    columns[at(own_column::kStribeckVelocity)] =
        drawnTo(logRatio(prior_.stribeck_velocity * greatest_, law.vs), factor);
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

 private:
  static std::size_t at(Index column) { return static_cast<std::size_t>(column); }

  FrictionPrior prior_;
  double greatest_;
};

void addGreatest(const ConstStates& qd, VectorXd& greatest) {
  for (Index k = 0; k < qd.count; ++k) {
    for (Index j = 0; j < qd.joints; ++j) greatest[j] = std::max(greatest[j], std::abs(qd(j, k)));
  }
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
  using GramAt = std::function<RegressorGram(const ArmFit&)>;

  Rounds(const std::vector<LinkPrior>& links, const VectorXd& greatest_velocities,
         const ArmFitOptions& options)
      : links_(links), options_(options), gains_(options.drive_gains.size() > 0) {
    for (const double greatest : greatest_velocities) {
      steps_.emplace_back(options.friction, greatest);
    }
  }

  /// Of all unknowns at a fit, or of those that it is linear in.
  Prior prior(const ArmFit& fit, bool linear) const {
    Prior prior;
    for (const LinkPrior& link : links_) prior.links.push_back(link.link);
    if (linear) prior.columns = heldColumns(options_.terms);
    for (std::size_t j = 0; j < steps_.size(); ++j) {
      std::vector<OwnColumn> all = steps_[j].columns(fit.friction[j], options_.terms);
      if (gains_) all.push_back(drawnTo(-gainRatio(fit, j), kGainDeviation));
      if (!linear) prior.own.insert(prior.own.end(), all.begin(), all.end());
      for (const Index c : prior.columns) prior.own.push_back(all[static_cast<std::size_t>(c)]);
    }
    return prior;
  }

  /// The best fit of all passes. gram_at: sums of the samples at a fit.
  ArmFit run(const ArmFit* start, const GramAt& gram_at) {
    ArmFit tried = start != nullptr ? *start : beginning();
    if (!gains_ || tried.drive_gains.size() != joints()) tried.drive_gains = options_.drive_gains;
    if (options_.terms != FrictionTerms::kStribeck) withoutStribeck(tried);
    int pass = 1;
    if (start != nullptr) {
      last_ = linearPart(tried, options_.terms);
    } else if (options_.most_passes > 1) {  // no step without heights and loads
      last_ = linearFit(tried, gram_at(tried));
      tried = with(tried, last_);
      ++pass;
    }
    ArmFit best, current;
    best.cost = current.cost = std::numeric_limits<double>::infinity();
    Steps by;
    int shrunk = 0;
    for (; pass <= options_.most_passes; ++pass) {
      const RegressorGram gram = gram_at(tried);
      const Fit fit = linearFit(tried, gram);
      ArmFit next = with(tried, fit);
      next.cost = cost(fit, next, gram.samples());
      const double gain = current.cost - next.cost;
      if (pass > kFirstPasses && !(gain > 0)) {
        if (++shrunk > kMostShrunk) break;
        for (Eigen::Vector4d& step : by) step *= 0.3;
        tried = moved(current, by);
        continue;
      }
      current = next;
      last_ = fit;
      if (next.cost < best.cost) best = next;
      if (pass == options_.most_passes) break;
      by = stepOf(gram, next);
      if (settled(by, next) || (pass > kFirstPasses && gain < kGain)) break;
      tried = moved(next, by);
    }
    best.passes = std::min(pass, options_.most_passes);
    return best;
  }

 private:
  using Steps = std::vector<Eigen::Vector4d>;  // of shift, log width, log vs, log gain
  static constexpr double kGain = 1e-1;        // of the cost, that is worth another pass
  static constexpr int kFirstPasses = 2;       // the way to a better fit may begin with a worse one
  static constexpr int kMostShrunk = 2;        // steps that are tried again

  Index joints() const { return static_cast<Index>(steps_.size()); }

  ArmFit beginning() const {
    ArmFit fit;
    fit.parameters.resize(10, joints());
    for (Index j = 0; j < joints(); ++j) {
      fit.parameters.col(j) = links_[static_cast<std::size_t>(j)].link.toVector();
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

  /// With shift, width, vs and gains of an arm, from the last fit on.
  Fit linearFit(const ArmFit& arm, const RegressorGram& gram) const {
    return consistentFit(gram, prior(arm, true), fitOptions(),
                         last_.own.size() > 0 ? &last_ : nullptr);
  }

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

  /// From the last fit.
  Steps stepOf(const RegressorGram& gram, const ArmFit& arm) const {
    FitOptions options = fitOptions();
    options.noise_iterations = 1;
    const Fit fit = consistentFit(gram, prior(arm, false), options, &last_);
    const bool stribeck = options_.terms == FrictionTerms::kStribeck;
    Steps by;
    for (Index j = 0; j < joints(); ++j) {
      by.emplace_back(fit.own(own_column::kShift, j), fit.own(own_column::kWidth, j),
                      stribeck ? fit.own(own_column::kStribeckVelocity, j) : 0.0,
                      gains_ ? fit.own(fit.own.rows() - 1, j) : 0.0);
    }
    return by;
  }

  ArmFit moved(const ArmFit& fit, const Steps& by) const {
    ArmFit result = fit;
    for (std::size_t j = 0; j < steps_.size(); ++j) {
      result.friction[j] = steps_[j].moved(fit.friction[j], by[j]);
      if (gains_) {
        result.drive_gains[static_cast<Index>(j)] *= std::exp(std::clamp(by[j][3], -1.0, 1.0));
      }
    }
    return result;
  }

  static bool settled(const Steps& by, const ArmFit& fit) {
    for (std::size_t j = 0; j < by.size(); ++j) {
      const Eigen::Vector4d step(by[j][0] / fit.friction[j].width, by[j][1], by[j][2],
                                 by[j][3] * kSettledStep / kSettledGain);
      if (step.cwiseAbs().maxCoeff() > kSettledStep) return false;
    }
    return true;
  }

  const std::vector<LinkPrior>& links_;
  const ArmFitOptions& options_;
  bool gains_;  // whether they are fitted
  std::vector<StepPrior> steps_;
  Fit last_;  // of the last pass that was no worse, or what to start from
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

ArmFit ArmFitter::fit(const ArmData& data, const ArmFitOptions& options,
                      const ArmFit* start) const {
  if (start != nullptr) check(*start);
  checkOptions(chain_.jointCount(), options);
  std::vector<const ArmData::Block*> blocks;
  RegressorGram links(chain_.jointCount());
  VectorXd greatest = VectorXd::Zero(chain_.jointCount());
  for (std::size_t b = 0; b < data.blocks_.size(); ++b) {
    if (static_cast<int>(b) == options.without) continue;
    blocks.push_back(&data.blocks_[b]);
    links.add(data.blocks_[b].links);
    addGreatest(data.blocks_[b].samples.qd, greatest);
  }
  if (links.samples() == 0) throw ModelError("ArmFitter: expected samples, got none");
  const auto gram_at = [&](const ArmFit& fit) { return gramOf(fit, options.terms, blocks, links); };
  return Rounds(prior_, greatest, options).run(start, gram_at);
}

ArmInformation ArmFitter::information(const ArmFit& fit, const ArmData& data,
                                      const ArmFitOptions& options) const {
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
  result.scores.resize(x.size(), static_cast<Index>(data.blocks_.size()));
  MatrixXd A(x.size(), x.size());
  VectorXd b(x.size());
  VectorXd greatest = VectorXd::Zero(chain_.jointCount());
  for (std::size_t k = 0; k < data.blocks_.size(); ++k) {
    const ArmData::Block& block = data.blocks_[k];
    addGreatest(block.samples.qd, greatest);
    const RegressorGram gram = gramOf(fit, options.terms, {&block}, block.links);
    gram.normalEquations(weights, A, b);
    result.scores.col(static_cast<Index>(k)) = b - A * x;
    all.add(gram);
  }
  FitOptions how;
  how.prior_strength = options.prior_strength;
  Information found = ::inverse_dynamics_identification::information(
      all, Rounds(prior_, greatest, of).prior(fit, false), how, linear);
  result.data = std::move(found.data);
  result.prior = std::move(found.prior);
  return result;
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

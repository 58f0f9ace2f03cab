// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/arm_fit.hpp"

#include <algorithm>
#include <chain_dynamics/error.hpp>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/regressor_gram.hpp>
#include <chain_dynamics/states.hpp>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "friction_columns.hpp"
#include "own_rows.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

using chain_dynamics::ConstStates;
using chain_dynamics::Mechanism;
using chain_dynamics::Model;
using chain_dynamics::ModelError;
using chain_dynamics::RegressorGram;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSettledStep = 0.02;  // Gauss-Newton step, relative to the width, that ends it
constexpr double kSettledGain = 1e-3;  // the same, of the logarithm of a drive gain
constexpr int kNoiseIterations = 4;
constexpr double kHeld = 1e-6;  // deviation of a shift at zero, by the greatest velocity
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An unknown of a joint that torques aren't linear in: a fit takes Gauss-Newton steps of it, or of its
/// logarithm.
struct Curved {
  Index column;                 // of the derivative
  double StepFriction::*value;  // null: the drive gain
  bool is_logarithm;
  double center, deviation;  // what it is drawn to
  double least, most;
  double settled = kSettledStep;

  double of(const ArmFit& fit, Index j) const {
    return value != nullptr ? fit.friction[static_cast<std::size_t>(j)].*value : fit.drive_gains[j];
  }
  double distance(const ArmFit& fit, Index j) const {
    return is_logarithm ? std::log(of(fit, j) / center) : of(fit, j) - center;
  }
  /// Length of the longest step: the width of friction, or a factor e.
  double unit(const ArmFit& fit, Index j) const {
    return is_logarithm ? 1.0 : fit.friction[static_cast<std::size_t>(j)].width;
  }
  double moved(const ArmFit& fit, Index j, double by) const {
    const double longest = unit(fit, j), step = std::clamp(by, -longest, longest);
    return std::clamp(is_logarithm ? of(fit, j) * std::exp(step) : of(fit, j) + step, least, most);
  }
};

/// How far and how fast what has friction moves: by the coupling, or joints.
class Reach {
 public:
  explicit Reach(Index laws)
      : greatest_(VectorXd::Zero(laws)),
        lower_(VectorXd::Constant(laws, kInfinity)),
        upper_(-lower_) {}

  void add(const ArmSamples& samples, const OwnedMatrix& coupling) {
    for (Index k = 0; k < samples.qd.count; ++k) {
      for (Index j = 0; j < laws(); ++j) {
        const double v = atLaw(coupling, j, [&](Index i) { return samples.qd(i, k); });
        const double q = atLaw(coupling, j, [&](Index i) { return samples.q(i, k); });
        greatest_[j] = std::max(greatest_[j], std::abs(v));
        lower_[j] = std::min(lower_[j], q);
        upper_[j] = std::max(upper_[j], q);
      }
    }
  }

  Index laws() const { return greatest_.size(); }
  /// The greatest velocity.
  double velocity(Index j) const { return std::max(greatest_[j], kLeast); }
  /// From the least to the greatest position.
  double range(Index j) const { return std::max(upper_[j] - lower_[j], kLeast); }

 private:
  static constexpr double kLeast = 1e-6;  // of a joint that stands still
  VectorXd greatest_, lower_, upper_;
};

/// The curved unknowns of a law and, if it is a joint's, of its drive gain.
std::vector<Curved> curvedUnknowns(const ArmFitOptions& options, Index law, const Reach& reach) {
  using namespace own_column;
  const FrictionPrior& prior = options.friction;
  const double greatest = reach.velocity(law), range = reach.range(law);
  const double factor = std::log(prior.width_factor);
  const double shift = (options.shift ? prior.shift : kHeld) * greatest;
  const double most_shift = options.shift ? prior.most_shift * greatest : 0.0;
  std::vector<Curved> curved = {
      {kShift, &StepFriction::shift, false, 0, shift, -most_shift, most_shift},
      {kWidth, &StepFriction::width, true, prior.width * greatest, factor,
       prior.least_width * greatest, prior.most_width * greatest}};
  if (options.terms >= FrictionTerms::kStribeck) {
    curved.push_back({kStribeckVelocity, &StepFriction::vs, true,
                      prior.stribeck_velocity * greatest, factor, 0, greatest});
  }
  if (options.terms >= FrictionTerms::kMemory) {
    curved.push_back({kDistance, &StepFriction::distance, true, prior.distance * range, factor,
                      prior.least_distance * range, prior.most_distance * range});
  }
  if (options.drive_gains.size() > law) {
    curved.push_back({ownColumns(options.terms), nullptr, true, options.drive_gains[law],
                      std::log(kDriveGainFactor), 0, kInfinity, kSettledGain});
  }
  return curved;
}

/// Prior of the coefficient of a column that torques are linear in.
OwnColumn linearColumn(Index column, const FrictionPrior& prior) {
  if (column == own_column::kOne) return {false, kInfinity, 0, 1e4};  // a joint may stand still
  if (column == own_column::kLoad) return {true, prior.most_load, 0, prior.load};
  return OwnColumn::positive();
}

/// The own columns that a fit is linear in.
std::vector<Index> linearColumns(FrictionTerms terms) {
  std::vector<Index> columns = {own_column::kAcceleration};
  for (const auto& [c, coefficient] : kLinear) {
    if (c < ownColumns(terms)) columns.push_back(c);
  }
  return columns;
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

/// The unknowns of a fit, the steps of those that it isn't linear in zero.
Fit linearPart(const ArmFit& arm, const OwnRows& rows) {
  Fit fit;
  fit.parameters = arm.parameters;
  fit.noise = fit.weighed_by = arm.noise;
  fit.own = MatrixXd::Zero(rows.columns(), arm.rotor_inertia.size());
  fit.own.row(own_column::kAcceleration) = arm.rotor_inertia.transpose();
  for (Index j = 0; j < fit.own.cols(); ++j) {
    for (const OwnRows::Place& place : rows.of(j)) {
      for (const auto& [c, coefficient] : kLinear) {
        if (c >= rows.lawColumns()) continue;
        fit.own(place.first + c, j) =
            arm.friction[static_cast<std::size_t>(place.law)].*coefficient;
      }
    }
  }
  if (arm.springs.size() > 0) fit.own.bottomRows(2) = arm.springs;
  return fit;
}

/// The fits that take turns with passes over the samples.
class Rounds {
 public:
  using GramAt = std::function<RegressorGram(const ArmFit&)>;

  Rounds(const std::vector<LinkPrior>& links, const OwnRows& rows, Reach reach,
         const ArmFitOptions& options)
      : links_(links),
        rows_(rows),
        options_(options),
        has_gains_(options.drive_gains.size() > 0),
        reach_(std::move(reach)) {
    for (Index j = 0; j < laws(); ++j) {
      curved_.push_back(curvedUnknowns(options, j, reach_));
    }
  }

  /// Prior of all unknowns at a fit, or of those that it is linear in.
  Prior prior(const ArmFit& fit, bool linear) const {
    Prior prior;
    for (const LinkPrior& link : links_) prior.links.push_back(link.link);
    if (linear) prior.columns = linearOnes();
    for (Index j = 0; j < joints(); ++j) {
      // of springs and of columns without unknown, as of offsets
      std::vector<OwnColumn> all(at(rows_.columns()),
                                 linearColumn(own_column::kOne, options_.friction));
      for (const auto& [k, joint, factor, first] : rows_.of(j)) {
        for (const Index c : linearColumns(options_.terms)) {
          all[at(first + c)] = linearColumn(c, options_.friction);
        }
        for (const Curved& unknown : curvedOf(k)) {
          if (unknown.value == nullptr && k != j) continue;
          all[at(first + unknown.column)] = {false, kInfinity, -unknown.distance(fit, k),
                                             unknown.deviation};
        }
      }
      if (!linear) prior.own.insert(prior.own.end(), all.begin(), all.end());
      for (const Index c : prior.columns) prior.own.push_back(all[at(c)]);
    }
    return prior;
  }

  /// The best fit of all passes. gram_at: sums of the samples at a fit.
  ArmFit run(const ArmFit* start, const GramAt& gram_at) {
    ArmFit tried = start != nullptr ? *start : beginning();
    if (!has_gains_ || tried.drive_gains.size() != joints()) {
      tried.drive_gains = options_.drive_gains;
    }
    for (StepFriction& law : tried.friction) {
      if (options_.terms < FrictionTerms::kStribeck) law.fs = 0;
      if (options_.terms < FrictionTerms::kMemory) law.fm = 0;
      if (!options_.shift) law.shift = 0;
    }
    for (Index j = 0; j < laws(); ++j) {  // of a start without memory
      double& distance = tried.friction[at(j)].distance;
      if (distance == 0) distance = options_.friction.distance * reach_.range(j);
    }
    int pass = 1;
    if (start != nullptr) {
      last_ = linearPart(tried, rows_);
    } else if (options_.most_passes > 1) {  // no step without heights and loads
      last_ = linearFit(tried, gram_at(tried));
      tried = with(tried, last_);
      ++pass;
    }
    ArmFit best, current;
    best.cost = current.cost = kInfinity;
    MatrixXd by;
    int shrunk = 0;
    for (; pass <= options_.most_passes; ++pass) {
      const RegressorGram gram = gram_at(tried);
      const Fit fit = linearFit(tried, gram);
      ArmFit next = with(tried, fit);
      next.cost = cost(fit, next, gram.samples());
      const double gain = current.cost - next.cost;
      if (pass > kFirstPasses && !(gain > 0)) {
        if (++shrunk > kMostShrunk) break;
        by *= 0.3;
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
  static constexpr double kGain = 1e-1;   // of the cost, that is worth another pass
  static constexpr int kFirstPasses = 2;  // the way to a better fit may begin with a worse one
  static constexpr int kMostShrunk = 2;   // steps that are tried again

  static std::size_t at(Index j) { return static_cast<std::size_t>(j); }

  Index joints() const { return static_cast<Index>(rows_.unknowns().size()); }
  Index laws() const { return rows_.laws(); }
  const std::vector<Curved>& curvedOf(Index law) const { return curved_[at(law)]; }

  /// The columns of rows that a fit is linear in.
  std::vector<Index> linearOnes() const {
    std::vector<Index> columns = linearColumns(options_.terms);
    const std::vector<Index> of_law = columns;
    const Index own = rows_.lawColumns() + (has_gains_ ? 1 : 0);
    for (Index first = own; first < rows_.springs(); first += rows_.lawColumns()) {
      for (const Index c : of_law) columns.push_back(first + c);
    }
    for (Index c = rows_.springs(); c < rows_.columns(); ++c) columns.push_back(c);
    return columns;
  }

  ArmFit beginning() const {
    ArmFit fit;
    fit.parameters.resize(10, static_cast<Index>(links_.size()));
    fit.rotor_inertia.setZero(joints());
    for (Index i = 0; i < fit.parameters.cols(); ++i) {
      fit.parameters.col(i) = links_[at(i)].link.toVector();
    }
    for (Index j = 0; j < laws(); ++j) {
      StepFriction& law = fit.friction.emplace_back();
      law.width = options_.friction.width * reach_.velocity(j);
      law.vs = options_.friction.stribeck_velocity * reach_.velocity(j);
    }
    return fit;
  }

  FitOptions fitOptions(int noise_iterations) const {
    FitOptions options;
    options.prior_strength = options_.prior_strength;
    options.noise_iterations = noise_iterations;
    if (last_.noise.size() > 0) options.noise = last_.noise;
    return options;
  }

  /// From the last fit on.
  Fit linearFit(const ArmFit& arm, const RegressorGram& gram) const {
    return consistentFit(gram, prior(arm, true), fitOptions(kNoiseIterations),
                         last_.own.size() > 0 ? &last_ : nullptr);
  }

  ArmFit with(const ArmFit& tried, const Fit& fit) const {
    ArmFit next = tried;
    next.parameters = fit.parameters;
    next.rotor_inertia = fit.own.row(own_column::kAcceleration).transpose();
    next.noise = fit.noise;
    for (Index k = 0; k < laws(); ++k) {
      const OwnRows::Place& home = rows_.home(k);
      for (const auto& [c, coefficient] : kLinear) {
        next.friction[at(k)].*coefficient =
            c < rows_.lawColumns() ? fit.own(home.first + c, home.joint) : 0.0;
      }
    }
    if (rows_.springs() < rows_.columns()) next.springs = fit.own.bottomRows(2);
    return next;
  }

  /// Twice the negative logarithm of the likelihood of what was measured, with the penalties.
  double cost(const Fit& fit, const ArmFit& arm, Index samples) const {
    const auto N = static_cast<double>(samples);
    double sum = fit.cost - N * (fit.noise.array() / fit.weighed_by.array()).square().sum() +
                 2 * N * fit.noise.array().log().sum();
    for (Index j = 0; j < laws(); ++j) {
      for (const Curved& unknown : curvedOf(j)) {
        const double deviations = unknown.distance(arm, j) / unknown.deviation;
        sum += deviations * deviations;
      }
      if (has_gains_ && j < joints()) sum -= 2 * N * std::log(arm.drive_gains[j]);
    }
    return sum;
  }

  /// Step of each curved unknown and law, from the last fit.
  MatrixXd stepOf(const RegressorGram& gram, const ArmFit& arm) const {
    const Fit fit = consistentFit(gram, prior(arm, false), fitOptions(1), &last_);
    MatrixXd by = MatrixXd::Zero(static_cast<Index>(curvedOf(0).size()), laws());
    for (Index k = 0; k < laws(); ++k) {
      Index i = 0;
      const OwnRows::Place& home = rows_.home(k);
      for (const Curved& unknown : curvedOf(k)) {
        by(i++, k) = fit.own(home.first + unknown.column, home.joint);
      }
    }
    return by;
  }

  ArmFit moved(const ArmFit& fit, const MatrixXd& by) const {
    ArmFit result = fit;
    for (Index j = 0; j < laws(); ++j) {
      StepFriction& law = result.friction[at(j)];
      Index i = 0;
      for (const Curved& unknown : curvedOf(j)) {
        double& value = unknown.value != nullptr ? law.*unknown.value : result.drive_gains[j];
        value = unknown.moved(fit, j, by(i++, j));
      }
      law.vs = std::max(law.vs, 2 * law.width);
    }
    return result;
  }

  bool settled(const MatrixXd& by, const ArmFit& fit) const {
    for (Index j = 0; j < laws(); ++j) {
      Index i = 0;
      for (const Curved& unknown : curvedOf(j)) {
        if (std::abs(by(i++, j)) > unknown.settled * unknown.unit(fit, j)) return false;
      }
    }
    return true;
  }

  const std::vector<LinkPrior>& links_;
  const OwnRows& rows_;
  const ArmFitOptions& options_;
  bool has_gains_;  // whether they are fitted
  Reach reach_;
  std::vector<std::vector<Curved>> curved_;  // of each law
  Fit last_;  // of the last pass that was no worse, or what to start from
};

std::vector<LinkPrior> priorsOf(const Mechanism& description, const LinkFloor& floor) {
  std::vector<LinkPrior> priors;
  for (const LinkParameters& link : chain_dynamics::linksOf(description))
    priors.push_back(linkPrior(link, floor));
  return priors;
}

/// Links without motor or friction: the regressor's, and its gravity.
Model withoutMotors(const Mechanism& description, const std::vector<LinkPrior>& priors) {
  std::vector<LinkParameters> links;
  links.reserve(priors.size());
  for (const LinkPrior& prior : priors) links.push_back(prior.link);
  return Model(withLinks(description, links, VectorXd::Zero(description.coordinates.jointCount())));
}

}  // namespace

ArmFitter::ArmFitter(const Mechanism& description, const LinkFloor& floor,
                     const OwnedMatrix& coupling, std::vector<SpringTerms> springs,
                     std::vector<std::string> places)
    : robot_(description),
      coupling_(coupling),
      springs_(std::move(springs)),
      places_(std::move(places)),
      prior_(priorsOf(description, floor)),
      fast_(withoutMotors(description, prior_)) {
  const Index n = joints(), laws = coupling.rows();
  if (!springs_.empty() && static_cast<Index>(springs_.size()) != n) {
    throw ModelError("ArmFitter: springs", "", std::to_string(n) + ", one for each joint, or none",
                     std::to_string(springs_.size()), "");
  }
  const bool fits = coupling.cols() == n && laws >= n &&
                    laws <= chain_dynamics::kMostFrictionLaws && coupling.allFinite() &&
                    (coupling.array() != 0).rowwise().any().all();
  for (Index k = 0; k < laws - n && places_.size() < static_cast<std::size_t>(laws - n); ++k) {
    places_.push_back("place " + std::to_string(k + 1));
  }
  if (coupling.size() == 0 || fits) return;
  throw ModelError("ArmFitter: coupling", "",
                   std::to_string(n) + " to " + std::to_string(chain_dynamics::kMostFrictionLaws) +
                       " rows of " + std::to_string(n) + " finite numbers, not all of a row zero",
                   std::to_string(laws) + " x " + std::to_string(coupling.cols()),
                   "state a row for the friction of each joint, then one for each other place");
}

OwnRows ArmFitter::rowsOf(FrictionTerms terms, bool has_gains) const {
  return {coupling_, springs_, joints(), terms, has_gains};
}

void ArmFitter::check(const ArmFit& fit) const {
  const Index n = joints();
  const bool fits = fit.parameters.rows() == 10 && fit.parameters.cols() == links() &&
                    fit.rotor_inertia.size() == n && areGains(n, fit.drive_gains) &&
                    static_cast<Index>(fit.friction.size()) == laws() &&
                    fit.springs.size() == (springs_.empty() ? 0 : 2 * n);
  if (!fits) {
    throw ModelError(
        "ArmFitter: fit", "parameters, rotor_inertia, friction",
        "those of " + std::to_string(links()) + " links, " + std::to_string(n) + " joints",
        "of " + std::to_string(fit.parameters.cols()) + ", " +
            std::to_string(fit.rotor_inertia.size()),
        "fit the same arm");
  }
}

ArmFit ArmFitter::fit(const ArmData& data, const ArmFitOptions& options,
                      const ArmFit* start) const {
  if (start != nullptr) check(*start);
  checkOptions(joints(), options);
  std::vector<const ArmData::Block*> blocks;
  RegressorGram links = fast_.emptyGram();
  Reach reach(laws());
  for (std::size_t b = 0; b < data.blocks_.size(); ++b) {
    if (static_cast<int>(b) == options.without) continue;
    blocks.push_back(&data.blocks_[b]);
    links.add(data.blocks_[b].links);
    reach.add(data.blocks_[b].samples, coupling_);
  }
  if (links.samples() == 0) throw ModelError("ArmFitter: expected samples, got none");
  const auto gram_at = [&](const ArmFit& fit) { return gramOf(fit, options.terms, blocks, links); };
  const OwnRows rows = rowsOf(options.terms, options.drive_gains.size() > 0);
  ArmFit found = Rounds(prior_, rows, reach, options).run(start, gram_at);
  for (Index j = 0; j < laws(); ++j) {
    StepFriction& law = found.friction[static_cast<std::size_t>(j)];
    if (isCoupled(coupling_, j)) law.fl = 0;
    if (law.fm == 0) law.distance = 0;
  }
  return found;
}

ArmInformation ArmFitter::information(const ArmFit& fit, const ArmData& data,
                                      const ArmFitOptions& options) const {
  check(fit);
  ArmFitOptions of = options;
  of.drive_gains = fit.drive_gains;  // a step begins at the fit
  if (fit.noise.size() != joints()) {
    throw ModelError("ArmFitter: fit", "noise", std::to_string(joints()) + " numbers",
                     std::to_string(fit.noise.size()), "take a fit to samples");
  }
  const OwnRows rows = rowsOf(options.terms, fit.drive_gains.size() > 0);
  Fit linear = linearPart(fit, rows);
  for (Index j = 0; j < joints() && rows.lawColumns() > own_column::kLoad; ++j) {
    for (const OwnRows::Place& place : rows.of(j)) {  // within its prior, where there is no load
      if (!isCoupled(coupling_, place.law)) continue;
      linear.own(place.first + own_column::kLoad, j) = options.friction.load;
    }
  }
  RegressorGram all = fast_.emptyGram(rows.columns());
  all.share(rows.unknowns());
  VectorXd x(all.unknowns());
  x.head(linear.parameters.size()) =
      Eigen::Map<const VectorXd>(linear.parameters.data(), linear.parameters.size());
  for (Index j = 0; j < joints(); ++j) {
    for (Index c = 0; c < rows.columns(); ++c) {
      if (all.unknownOf(j, c) >= 0)
        x[linear.parameters.size() + all.unknownOf(j, c)] = linear.own(c, j);
    }
  }
  const VectorXd weights = fit.noise.array().square().inverse();
  ArmInformation result;
  result.scores.resize(x.size(), static_cast<Index>(data.blocks_.size()));
  MatrixXd A(x.size(), x.size());
  VectorXd b(x.size());
  Reach reach(laws());
  for (std::size_t k = 0; k < data.blocks_.size(); ++k) {
    const ArmData::Block& block = data.blocks_[k];
    reach.add(block.samples, coupling_);
    const RegressorGram gram = gramOf(fit, options.terms, {&block}, block.links);
    gram.normalEquations(weights, A, b);
    result.scores.col(static_cast<Index>(k)) = b - A * x;
    all.add(gram);
  }
  FitOptions how;
  how.prior_strength = options.prior_strength;
  Information found = ::inverse_dynamics_identification::information(
      all, Rounds(prior_, rows, reach, of).prior(fit, false), how, linear);
  result.data = std::move(found.data);
  result.prior = std::move(found.prior);
  return result;
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

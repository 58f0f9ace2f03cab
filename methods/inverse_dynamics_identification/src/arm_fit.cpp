// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/arm_fit.hpp"

#include <algorithm>
#include <chain_dynamics/error.hpp>
#include <chain_dynamics/friction.hpp>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/regressor_gram.hpp>
#include <chain_dynamics/states.hpp>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "curved_unknowns.hpp"
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

constexpr int kNoiseIterations = 4;
constexpr int kNoiseIterationsOfStep = 1;  // from nearly the same noise

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
        reach_(std::move(reach)),
        longest_(VectorXd::Constant(rows.laws(), kFirstStep)) {
    for (Index j = 0; j < laws(); ++j) {
      curved_.push_back(curvedUnknowns(options, j, reach_));
    }
  }

  /// Prior of all unknowns at a fit, or of those that it is linear in. held: steps of curved unknowns and
  /// laws; NaN: it isn't held.
  Prior prior(const ArmFit& fit, bool linear, const MatrixXd& held = {}) const {
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
        Index i = 0;
        for (const Curved& unknown : curvedOf(k)) {
          const double step = held.size() > 0 ? held(i, k) : std::nan("");
          ++i;
          if (unknown.value == nullptr && k != j) continue;
          all[at(first + unknown.column)] =
              std::isnan(step)
                  ? OwnColumn{false, kInfinity, -unknown.distance(fit, k), unknown.deviation}
                  : OwnColumn{false, kInfinity, step, kHeld};
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
    const bool is_new = options_.terms >= FrictionTerms::kMemory && !remembers(tried);
    for (StepFriction& law : tried.friction) {
      if (law.distance == 0) law.distance = options_.friction.distance;
    }
    int pass = 1;
    if (start != nullptr) {
      last_ = linearPart(tried, rows_);
    } else if (options_.most_passes > 1) {  // no step without heights and loads
      last_ = linearFit(tried, gram_at(tried));
      tried = with(tried, last_);
      ++pass;
    }
    if (is_new) tried = withDistances(tried, gram_at);
    ArmFit best;
    best.cost = kInfinity;
    std::optional<RegressorGram> gram_of_best;
    int rejected = 0;
    for (; pass <= options_.most_passes; ++pass) {
      RegressorGram gram = gram_at(tried);
      const Fit fit = linearFit(tried, gram);
      ArmFit next = with(tried, fit);
      next.cost = cost(fit, next, gram.samples());
      const double gain = best.cost - next.cost;
      if (gram_of_best) adaptSteps(best, next);
      if (gain > 0) {
        best = next;
        last_ = fit;
        gram_of_best = std::move(gram);
        rejected = 0;
      } else if (!gram_of_best || ++rejected > kMostRejected) {
        break;
      }
      if (pass == options_.most_passes) break;
      const MatrixXd by = stepOf(fullFit(best, *gram_of_best, 1));
      if (gain > 0 && (settled(by, best) || gain < kGain)) break;
      tried = moved(best, by);
    }
    best.passes = std::min(pass, options_.most_passes);
    return best;
  }

  /// One step of all unknowns at once. gram: sums of other samples, at the fit.
  ArmFit step(const ArmFit& from, const RegressorGram& gram) {
    last_ = linearPart(from, rows_);
    longest_.setOnes();
    const Fit fit = fullFit(from, gram, kNoiseIterationsOfStep);
    return moved(with(from, fit), stepOf(fit));
  }

 private:
  static constexpr double kGain = 0.3;            // of the cost, that is worth another pass
  static constexpr double kStepTolerance = 1e-3;  // of the cost
  static constexpr int kMostRejected = 3;         // steps in turn
  static constexpr double kFirstStep = 0.3, kLongestStep = 0.6;  // units
  static constexpr double kStopped = 1e-3;                       // of a unit

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

  static bool remembers(const ArmFit& fit) {
    return std::any_of(fit.friction.begin(), fit.friction.end(),
                       [](const StepFriction& law) { return law.distance > 0; });
  }

  /// With the distance of each law, of a few, that leaves its joint the least errors: steps from afar end in
  /// a minimum nearby.
  ArmFit withDistances(const ArmFit& fit, const GramAt& gram_at) const {
    ArmFit best = fit, tried = fit;
    VectorXd least = VectorXd::Constant(laws(), kInfinity);
    for (const double factor : {1.0 / 3, 1.0, 3.0}) {
      const double distance = factor * options_.friction.distance;
      for (StepFriction& law : tried.friction) law.distance = distance;
      const Fit found = linearFit(tried, gram_at(tried));
      for (Index k = 0; k < laws(); ++k) {
        const double noise = found.noise[rows_.home(k).joint];
        if (noise >= least[k]) continue;
        least[k] = noise;
        best.friction[at(k)].distance = distance;
      }
    }
    return best;
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

  /// Shorter steps of laws whose joint's errors a step has made greater, longer ones of the others.
  void adaptSteps(const ArmFit& from, const ArmFit& to) {
    for (Index k = 0; k < laws(); ++k) {
      const Index j = rows_.home(k).joint;
      longest_[k] =
          to.noise[j] > from.noise[j] ? 0.3 * longest_[k] : std::min(kLongestStep, 2 * longest_[k]);
    }
  }

  /// The fit of all unknowns at once, with steps of the curved ones. Where limits stop some, the others
  /// are fitted again.
  Fit fullFit(const ArmFit& arm, const RegressorGram& gram, int noise_iterations) const {
    FitOptions how = fitOptions(noise_iterations);
    how.tolerance = kStepTolerance;
    const Fit fit = consistentFit(gram, prior(arm, false), how, &last_);
    const MatrixXd by = stepOf(fit);
    const ArmFit to = moved(arm, by);
    MatrixXd held = MatrixXd::Constant(by.rows(), by.cols(), std::nan(""));
    bool is_stopped = false;
    for (Index k = 0; k < laws(); ++k) {
      Index i = 0;
      for (const Curved& unknown : curvedOf(k)) {
        const double step = unknown.step(arm, to, k);
        if (std::abs(step - by(i, k)) > kStopped * unknown.unit(arm, k)) {
          held(i, k) = step;
          is_stopped = true;
        }
        ++i;
      }
    }
    return is_stopped ? consistentFit(gram, prior(arm, false, held), how, &fit) : fit;
  }

  /// Step of each curved unknown and law.
  MatrixXd stepOf(const Fit& fit) const {
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
        value = unknown.moved(fit, j, by(i++, j), longest_[j]);
      }
      const double over = std::sqrt(2 * law.width / law.vs);
      if (over > 1 && options_.terms >= FrictionTerms::kStribeck) {  // both give way
        law.width /= over;
        law.vs *= over;
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
  VectorXd longest_;                         // steps of each law's curved unknowns, in units
  Fit last_;  // of the last pass that was no worse, or what to start from
};

/// Without what the samples of a law can't tell.
ArmFit withoutUnused(ArmFit fit, const OwnedMatrix& coupling) {
  for (std::size_t k = 0; k < fit.friction.size(); ++k) {
    StepFriction& law = fit.friction[k];
    if (isCoupled(coupling, static_cast<Index>(k))) law.fl = 0;
    if (law.fm == 0) law.distance = 0;
  }
  return fit;
}

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
  for (const ArmData::Block& block : data.blocks_) {
    blocks.push_back(&block);
    links.add(block.links);
    reach.add(block.samples, coupling_);
  }
  if (links.samples() == 0) throw ModelError("ArmFitter: expected samples, got none");
  const auto gram_at = [&](const ArmFit& fit) { return gramOf(fit, options.terms, blocks, links); };
  const OwnRows rows = rowsOf(options.terms, options.drive_gains.size() > 0);
  return withoutUnused(Rounds(prior_, rows, reach, options).run(start, gram_at), coupling_);
}

std::vector<ArmFit> ArmFitter::leftOut(const ArmFit& fit, const ArmData& data,
                                       const ArmFitOptions& options) const {
  check(fit);
  checkOptions(joints(), options);
  ArmFitOptions of = options;
  of.drive_gains = fit.drive_gains;
  const OwnRows rows = rowsOf(options.terms, fit.drive_gains.size() > 0);
  RegressorGram before = fast_.emptyGram(rows.columns());  // a block
  before.share(rows.unknowns());
  Reach reach(laws());
  std::vector<RegressorGram> grams, after = {before};
  for (const ArmData::Block& block : data.blocks_) {
    reach.add(block.samples, coupling_);
    grams.push_back(gramOf(fit, options.terms, {&block}, block.links));
  }
  for (auto gram = grams.rbegin(); gram != grams.rend(); ++gram) {
    after.push_back(after.back());
    after.back().add(*gram);
  }
  Rounds rounds(prior_, rows, reach, of);
  std::vector<ArmFit> found;
  for (const RegressorGram& gram : grams) {
    after.pop_back();
    after.back().add(before);
    found.push_back(withoutUnused(rounds.step(fit, after.back()), coupling_));
    before.add(gram);
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

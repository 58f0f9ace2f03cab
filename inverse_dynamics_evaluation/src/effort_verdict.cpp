// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/effort_verdict.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include "checks.hpp"
#include "figures.hpp"
#include "inverse_dynamics_evaluation/joint_matching.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;

constexpr Index kStretches = 20;
constexpr double kLeastWon = 17.0 / 20.0;  // of the stretches; by a coin 1 in 750
constexpr double kLeastMargin = 1.1;
constexpr Index kLeastSamples = 5 * kStretches;
constexpr double kNothing = 1e-3;    // of a joint's efforts: smaller errors are as good as that
constexpr double kMostMisfit = 0.5;  // 0: prediction is recording; 1: they have nothing in common
constexpr double kWrongMount = 3.0;  // least margin of leaving gravity out: a wrong direction has 2
constexpr double kNoGravity = 0.01;  // of the computed torques
constexpr double kTiny = std::numeric_limits<double>::min();

std::string percent(double share) {
  return formatted(share < 1 ? "%.2g %%" : "%.0f %%", 100.0 * share);
}

bool clearlyWorse(const EffortCandidate& candidate, Index stretches) {
  const double share = static_cast<double>(candidate.worse_in) / static_cast<double>(stretches);
  return share >= kLeastWon && candidate.margin >= kLeastMargin;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Mean of the middle two of an even number.
double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

std::vector<double> selected(const ArrayXd& values, const Eigen::Array<bool, -1, 1>& mask) {
  std::vector<double> result;
  for (Index j = 0; j < values.size(); ++j) {
    if (mask[j]) {
      result.push_back(values[j]);
    }
  }
  return result;
}

}  // namespace

std::vector<std::string> EffortVerdict::rivals() const {
  std::vector<std::string> names;
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    if (!clearlyWorse(candidates[i], stretches)) {
      names.push_back(candidates[i].meaning);
    }
  }
  return names;
}

std::string EffortVerdict::summary() const {
  std::string text = best() + " is " + percent(candidates.front().error) + " of the range off";
  bool current = best() == kCurrent;
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    const EffortCandidate& other = candidates[i];
    text += ", " + other.meaning + " " + percent(other.error) + " (worse in " +
            std::to_string(other.worse_in) + " of " + std::to_string(stretches) + " stretches, " +
            formatted("%.3g", other.margin) + " times)";
    current = current || other.meaning == kCurrent;
  }
  return current ? text : text + "; current wasn't considered, as no drive gains are known";
}

EffortSums::EffortSums(Index count, Index joints, std::vector<double> drive_gains)
    : count_(count), drive_gains_(std::move(drive_gains)) {
  requireGains("meanings of effort", drive_gains_.size(), joints);
  const Index stretches = std::clamp<Index>(count, 1, kStretches);
  const double step = static_cast<double>(count) / static_cast<double>(stretches);
  for (Index i = 0; i < stretches; ++i) {
    starts_.push_back(static_cast<Index>(static_cast<double>(i) * step));
  }
  const ArrayXd none = ArrayXd::Zero(joints);
  effort_ = gravity_ = none;
  least_ = none + std::numeric_limits<double>::infinity();
  greatest_ = none - std::numeric_limits<double>::infinity();
  for (const std::string name : {kTorque, kTorqueWithoutGravity, kCurrent}) {
    if (name != kCurrent || !drive_gains_.empty()) {
      meanings_.push_back({name, Eigen::ArrayXXd::Zero(joints, stretches), none, none});
    }
  }
}

void EffortSums::add(const ConstMatrix& computed, const ConstMatrix& gravity,
                     const ConstMatrix& effort) {
  const Eigen::Map<const ArrayXd> gains(drive_gains_.data(),
                                        static_cast<Index>(drive_gains_.size()));
  ArrayXd prediction(effort.rows());
  for (Index k = 0; k < effort.cols(); ++k, ++added_) {
    const auto next = std::upper_bound(starts_.begin(), starts_.end(), added_);
    const Index stretch = std::distance(starts_.begin(), next) - 1;
    const auto recorded = effort.col(k).array();
    for (Meaning& meaning : meanings_) {
      prediction = computed.col(k).array();
      if (meaning.name == kTorqueWithoutGravity) {
        prediction -= gravity.col(k).array();
      } else if (meaning.name == kCurrent) {
        prediction /= gains;
      }
      meaning.squares.col(stretch) += (recorded - prediction).square();
      meaning.size += prediction.square();
      meaning.product += prediction * recorded;
    }
    effort_ += recorded.square();
    gravity_ += gravity.col(k).array().square();
    least_ = least_.min(recorded);
    greatest_ = greatest_.max(recorded);
  }
}

EffortVerdict EffortSums::verdict() const {
  const std::vector<Matrix> found = errors();
  EffortVerdict verdict;
  verdict.stretches = static_cast<Index>(starts_.size());
  verdict.candidates = ranked(found);
  verdict.reason = doubt(verdict, found);
  verdict.sure = verdict.reason.empty();
  return verdict;
}

EffortSums::Vector EffortSums::rms(const Vector& squares) const {
  return (squares / static_cast<double>(count_)).sqrt();
}

// Root mean square errors of each meaning, n x stretches.
std::vector<EffortSums::Matrix> EffortSums::errors() const {
  std::vector<Matrix> result;
  if (count_ == 0) {
    result.assign(meanings_.size(), Eigen::ArrayXXd::Ones(effort_.size(), 1));
    return result;
  }
  ArrayXd scale = rms(effort_);
  for (const Meaning& meaning : meanings_) {
    scale = scale.max(rms(meaning.size)).eval();
  }
  const ArrayXd least = (kNothing * scale).max(kTiny);
  for (const Meaning& meaning : meanings_) {
    Matrix error = meaning.squares;
    for (std::size_t i = 0; i < starts_.size(); ++i) {
      const Index end = i + 1 < starts_.size() ? starts_[i + 1] : count_;
      const auto samples = static_cast<double>(end - starts_[i]);
      const auto column = static_cast<Index>(i);
      error.col(column) = (meaning.squares.col(column) / samples).sqrt().max(least);
    }
    result.push_back(error);
  }
  return result;
}

std::vector<EffortCandidate> EffortSums::ranked(const std::vector<Matrix>& errors) const {
  const auto joints = static_cast<double>(effort_.size());
  std::vector<ArrayXd> scores;  // per stretch
  scores.reserve(errors.size());
  for (const Matrix& error : errors) {
    scores.emplace_back(error.log().colwise().sum().transpose() / joints);
  }
  std::vector<std::size_t> order(errors.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return scores[a].mean() < scores[b].mean();
  });
  const ArrayXd span = count_ > 0 ? ArrayXd(greatest_ - least_) : ArrayXd::Zero(effort_.size());
  const ArrayXd& best = scores[order.front()];
  std::vector<EffortCandidate> candidates;
  for (const std::size_t i : order) {
    const ArrayXd whole = errors[i].square().rowwise().mean().sqrt();
    const auto moved = static_cast<double>((span > 0).count());
    const double shares = (span > 0).select(whole / span.max(kTiny), 0.0).sum();
    candidates.push_back({meanings_[i].name, moved > 0 ? shares / moved : 0.0,
                          std::exp((scores[i] - best).mean()), (scores[i] > best).count()});
  }
  return candidates;
}

// Why the best meaning isn't sure; empty if it is.
std::string EffortSums::doubt(const EffortVerdict& verdict,
                              const std::vector<Matrix>& errors) const {
  if (count_ < kLeastSamples) {
    return std::to_string(count_) + " valid samples are too few, " + std::to_string(kLeastSamples) +
           " are needed";
  }
  std::vector<std::string> open = verdict.rivals();
  if (!open.empty()) {
    const bool loaded =
        rms(gravity_).maxCoeff() >= kNoGravity * rms(meanings_.front().size).maxCoeff();
    const std::string told = verdict.best() + " and " + listed(open) + " can't be told apart";
    open.push_back(verdict.best());
    const bool gravity_decides = contains(open, kTorque) && contains(open, kTorqueWithoutGravity);
    return gravity_decides && !loaded ? told + ", as gravity hardly loads the joints in this motion"
                                      : told;
  }
  std::size_t best = 0;
  while (meanings_[best].name != verdict.best()) {
    ++best;
  }
  const auto of = [&](std::size_t i) -> ArrayXd {
    return errors[i].square().rowwise().mean().sqrt();
  };
  Eigen::Array<bool, -1, 1> telling = Eigen::Array<bool, -1, 1>::Constant(effort_.size(), false);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (i != best) {
      telling = telling || of(i) > kLeastMargin * of(best);
    }
  }
  const ArrayXd size = (effort_ + meanings_[best].size).max(kTiny * static_cast<double>(count_));
  const std::vector<double> misfits =
      selected(meanings_[best].squares.rowwise().sum() / size, telling);
  bool mount = false;
  for (const EffortCandidate& other : verdict.candidates) {
    mount = mount || (verdict.best() == kTorqueWithoutGravity && other.meaning == kTorque &&
                      other.margin < kWrongMount);
  }
  return mount || (!misfits.empty() && median(misfits) > kMostMisfit) ? "no meaning fits" : "";
}

EffortVerdict compareMeanings(const ConstMatrix& computed, const ConstMatrix& gravity,
                              const ConstMatrix& effort, const std::vector<double>& drive_gains,
                              const Mask& mask) {
  requireSameSize("meanings of effort", "gravity", gravity, "computed", computed);
  requireSameSize("meanings of effort", "effort", effort, "computed", computed);
  requireMask("meanings of effort", mask.size(), computed);
  Mask counts = mask;
  for (Index k = 0; k < counts.size(); ++k) {
    counts[k] = mask[k] && computed.col(k).allFinite() && effort.col(k).allFinite();
  }
  EffortSums sums(counts.count(), computed.rows(), drive_gains);
  for (Index k = 0; k < counts.size(); ++k) {
    if (counts[k]) {
      sums.add(computed.col(k), gravity.col(k), effort.col(k));
    }
  }
  return sums.verdict();
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

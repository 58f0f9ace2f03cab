// SPDX-License-Identifier: Apache-2.0

/// @file
/// Sums of ArmFitter's samples, and torques.

#include <algorithm>
#include <chain_dynamics/error.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/friction_state.hpp>
#include <chain_dynamics/mechanism.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/regressor_gram.hpp>
#include <chain_dynamics/states.hpp>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "friction_columns.hpp"
#include "inverse_dynamics_identification/arm_fit.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

using chain_dynamics::ConstStates;
using chain_dynamics::FastModel;
using chain_dynamics::FrictionState;
using chain_dynamics::GramSamples;
using chain_dynamics::Model;
using chain_dynamics::ModelError;
using chain_dynamics::RegressorGram;
using chain_dynamics::States;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kBatch = 512;        // samples whose columns are held
constexpr Index kMostKept = 20'000;  // samples whose rows are kept: 50 MB of an arm of seven joints

bool isSomething(const LinkParameters& body) { return !body.toVector().isZero(0); }

void checkSamples(Index joints, const ArmSamples& block) {
  if (block.before.count > 0 && block.before.joints != joints) {
    throw ModelError("ArmFitter: samples", "before", std::to_string(joints) + " joints",
                     std::to_string(block.before.joints), "take positions of the same joints");
  }
  for (const ConstStates& states : {block.q, block.qd, block.qdd, block.tau}) {
    if (states.joints == joints && states.count == block.q.count) continue;
    throw ModelError(
        "ArmFitter: samples", "q, qd, qdd, tau",
        std::to_string(joints) + " joints and as many samples each",
        std::to_string(states.joints) + " joints, " + std::to_string(states.count) + " samples",
        "pair each torque with its state");
  }
}

/// Own columns and torques of a few samples at a fit.
class Batch {
 public:
  Batch(const ArmFit& fit, FrictionTerms terms, const OwnedMatrix& coupling)
      : fit_(fit),
        coupling_(coupling),
        has_gains_(fit.drive_gains.size() > 0),
        columns_(ownColumns(terms)),
        gravity_(fit.rotor_inertia.size(), kBatch),
        tau_(gravity_.rows(), kBatch) {
    loaded_.resizeLike(gravity_);
    alone_.resizeLike(gravity_);
    own_.resize(static_cast<std::size_t>(columns_ + (has_gains_ ? 1 : 0)));
    for (Rows& column : own_) column.resizeLike(gravity_);
  }

  /// The next rows are of another block, with these positions before.
  void restart(const ConstStates& before) {
    memories_.assign(fit_.friction.size(), {});
    if (before.count == 0) return;
    for (Index j = 0; j < before.joints; ++j) {
      presliding(fit_.friction[static_cast<std::size_t>(j)], j, atMotor(before, j));
    }
  }

  /// Rows of samples, whose torques are what was measured; loaded: the links with what they carry.
  GramSamples rows(const FastModel& alone, const FastModel& loaded, GramSamples samples) {
    const Index size = samples.q.count;
    const bool carries = &loaded != &alone;
    const ConstStates q = samples.q, qd = samples.qd, qdd = samples.qdd;
    loaded.gravityVectorBatch(q, gravity_.leftCols(size));
    if (has_gains_ || carries) loaded.torquesBatch(q, qd, qdd, loaded_.leftCols(size));
    if (carries) alone.torquesBatch(q, qd, qdd, alone_.leftCols(size));
    for (Index j = 0; j < q.joints; ++j) {
      const StepFriction& law = fit_.friction[static_cast<std::size_t>(j)];
      const auto part = [&](auto& of) { return of.row(j).head(size).array(); };
      Values load = part(gravity_).abs();
      const Values acceleration = valuesOf(qdd, j);
      if (coupling_.size() > 0 && !coupling_.row(j).head(j).isZero(0)) load.setZero();
      frictionColumns(law, atMotor(qd, j), acceleration, load, presliding(law, j, atMotor(q, j)),
                      columns_,
                      [&](Index c) { return part(own_[static_cast<std::size_t>(c)]); });
      part(tau_) = (has_gains_ ? fit_.drive_gains[j] : 1.0) * valuesOf(samples.tau, j);
      if (carries) part(tau_) -= part(loaded_) - part(alone_);
      if (has_gains_) part(own_.back()) = -part(loaded_) - linearPart(j, size);
    }
    subtractCoupled(size);
    samples.tau = tau_.leftCols(size);
    for (const Rows& column : own_) samples.own_columns.emplace_back(column.leftCols(size));
    samples.links = false;
    return samples;
  }

 private:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Values = Eigen::Array<double, 1, Eigen::Dynamic>;

  static Values valuesOf(const ConstStates& states, Index joint) {
    Values values(states.count);
    for (Index k = 0; k < states.count; ++k) values[k] = states(joint, k);
    return values;
  }

  /// Positions or velocities of the motor of joint j.
  Values atMotor(const ConstStates& states, Index j) const {
    Values values = valuesOf(states, j);
    for (Index i = 0; i < j && coupling_.size() > 0; ++i) {
      if (coupling_(j, i) != 0) values += coupling_(j, i) * valuesOf(states, i);
    }
    return values;
  }

  /// Presliding of a law along these positions, after those of the batch before.
  PreslidingValues<Values> presliding(const StepFriction& law, Index j, const Values& position) {
    PreslidingValues<Values> found;
    if (columns_ <= own_column::kMemory) return found;
    found.z = found.unknown = found.z_by_distance = found.unknown_by_distance = position;
    auto& [memory, last] = memories_[static_cast<std::size_t>(j)];
    for (Index k = 0; k < position.size(); ++k) {
      if (last) move(memory, position[k] - *last, law);
      last = position[k];
      found.z[k] = memory.z.value;
      found.unknown[k] = memory.unknown.value;
      found.z_by_distance[k] = memory.z.derivative[0];
      found.unknown_by_distance[k] = memory.unknown.derivative[0];
    }
    return found;
  }

  /// Takes friction of later motors off the torques of the joints that turn them.
  void subtractCoupled(Index size) {
    for (Index j = 0; j < coupling_.rows(); ++j) {
      for (Index i = 0; i < j; ++i) {
        if (coupling_(j, i) == 0) continue;
        tau_.row(i).head(size).array() -= coupling_(j, i) * linearPart(j, size, 0.0);
      }
    }
  }

  /// Torques of rotor and friction of a joint, from its columns.
  Values linearPart(Index j, Index size) const {
    return linearPart(j, size, fit_.rotor_inertia[j]);
  }
  Values linearPart(Index j, Index size, double rotor_inertia) const {
    const auto column = [&](Index c) {
      return own_[static_cast<std::size_t>(c)].row(j).head(size).array();
    };
    Values sum = rotor_inertia * column(own_column::kAcceleration);
    for (const auto& [c, coefficient] : kLinear) {
      if (c < columns_) sum += fit_.friction[static_cast<std::size_t>(j)].*coefficient * column(c);
    }
    return sum;
  }

  const ArmFit& fit_;
  const OwnedMatrix& coupling_;
  bool has_gains_;
  Index columns_;
  Rows gravity_, tau_, loaded_, alone_;  // of each joint
  std::vector<Rows> own_;
  std::vector<std::pair<FittedPresliding, std::optional<double>>> memories_;  // and last positions
};

/// Samples from `first` on, at most kBatch.
GramSamples batchOf(const ArmSamples& block, Index first) {
  const Index size = std::min(kBatch, block.q.count - first);
  return {block.q.middle(first, size), block.qd.middle(first, size), block.qdd.middle(first, size),
          block.tau.middle(first, size)};
}

}  // namespace

Model ArmFitter::robotOf(const OwnedMatrix& parameters, const OwnedVector* rotors,
                         const LinkParameters& carried) const {
  std::vector<LinkParameters> links;
  for (Index j = 0; j < parameters.cols(); ++j) {
    const Eigen::Matrix<double, 10, 1> p = parameters.col(j);
    links.push_back(LinkParameters::fromVector(p));
  }
  if (robot_.branches.empty()) {
    links.back() += robot_.coordinates.tip() * carried;
  } else {
    const chain_dynamics::Branch& first = robot_.branches.front();
    links[static_cast<std::size_t>(first.link.back())] += first.chain.tip() * carried;
  }
  VectorXd of_motors = VectorXd::Zero(joints());
  if (rotors != nullptr) of_motors = *rotors;
  return Model(withLinks(robot_, links, of_motors));
}

ArmData ArmFitter::data(std::vector<ArmSamples> blocks) const {
  Index samples = 0;
  for (const ArmSamples& block : blocks) {
    checkSamples(joints(), block);
    samples += block.q.count;
  }
  std::vector<ArmData::Block> found;
  for (ArmSamples& block : blocks) {
    ArmData::Block& to =
        found.emplace_back(ArmData::Block{std::move(block), fast_.emptyGram(), {}});
    for (Index first = 0; first < to.samples.q.count; first += kBatch) {
      GramSamples batch = batchOf(to.samples, first);
      if (samples <= kMostKept) batch.keep = &to.rows.emplace_back();
      fast_.addToGram(batch, to.links);
    }
  }
  return ArmData(std::move(found));
}

RegressorGram ArmFitter::gramOf(const ArmFit& fit, FrictionTerms terms,
                                const std::vector<const ArmData::Block*>& blocks,
                                const RegressorGram& links) const {
  RegressorGram gram = fast_.emptyGram(ownColumns(terms) + (fit.drive_gains.size() > 0 ? 1 : 0));
  const FastModel alone(robotOf(fit.parameters, nullptr), fast_);
  Batch batch(fit, terms, coupling_);
  for (const ArmData::Block* block : blocks) {
    const ArmSamples& samples = block->samples;
    std::optional<FastModel> loaded;
    if (isSomething(samples.carried)) {
      loaded.emplace(robotOf(fit.parameters, nullptr, samples.carried), fast_);
    }
    batch.restart(samples.before);
    auto rows = block->rows.begin();
    for (Index first = 0; first < samples.q.count; first += kBatch) {
      GramSamples of = batch.rows(alone, loaded ? *loaded : alone, batchOf(samples, first));
      if (rows != block->rows.end()) of.rows = &*rows++;
      fast_.addToGram(of, gram);
    }
  }
  gram.addLinks(links);
  return gram;
}

Model ArmFitter::model(const ArmFit& fit) const {
  check(fit);
  Model model = robotOf(fit.parameters, &fit.rotor_inertia);
  model.friction.assign(fit.friction.begin(), fit.friction.end());
  model.coupling = coupling_;
  return model;
}

void ArmFitter::torques(const ArmFit& fit, ConstStates q, ConstStates qd, ConstStates qdd,
                        States tau, ConstStates before) const {
  const Model found = model(fit);
  FastModel(found, fast_).torquesBatch(q, qd, qdd, tau);
  FrictionState friction(found);
  friction.moveAlong(before);
  friction.addAlong(q, qd, tau);
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

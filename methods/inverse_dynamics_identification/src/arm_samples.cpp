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
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "friction_columns.hpp"
#include "inverse_dynamics_identification/arm_fit.hpp"
#include "own_rows.hpp"

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
  Batch(const ArmFit& fit, const OwnRows& of, const OwnedMatrix& coupling,
        const std::vector<SpringTerms>& springs)
      : fit_(fit),
        rows_(of),
        coupling_(coupling),
        springs_(springs),
        has_gains_(fit.drive_gains.size() > 0),
        law_(of.lawColumns(), kBatch),
        gravity_(fit.rotor_inertia.size(), kBatch),
        tau_(gravity_.rows(), kBatch) {
    loaded_.resizeLike(gravity_);
    alone_.resizeLike(gravity_);
    own_.resize(static_cast<std::size_t>(of.columns()));
    for (Rows& column : own_) column.setZero(gravity_.rows(), kBatch);
  }

  /// The next rows are of another block, with these positions before.
  void restart(const ConstStates& before) {
    memories_.assign(fit_.friction.size(), {});
    if (before.count == 0) return;
    for (Index k = 0; k < rows_.laws(); ++k) {
      presliding(fit_.friction[static_cast<std::size_t>(k)], k, ofLaw(k, before));
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
    for (Index k = 0; k < rows_.laws(); ++k) addLaw(k, samples);
    for (Index j = 0; j < q.joints; ++j) {
      const auto part = [&](auto& of) { return of.row(j).head(size).array(); };
      if (!springs_.empty()) addSpring(j, valuesOf(q, j));
      part(tau_) = (has_gains_ ? fit_.drive_gains[j] : 1.0) * valuesOf(samples.tau, j);
      if (carries) part(tau_) -= part(loaded_) - part(alone_);
      if (has_gains_) part(ownAt(rows_.lawColumns())) = -part(loaded_) - linearPart(j, size);
    }
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

  /// Velocities or positions of a law.
  Values ofLaw(Index law, const ConstStates& states) const {
    return atLaw(coupling_, law, [&](Index j) { return valuesOf(states, j); });
  }

  /// Presliding of a law along these positions, after those of the batch before.
  PreslidingValues<Values> presliding(const StepFriction& law, Index j, const Values& position) {
    PreslidingValues<Values> found;
    if (rows_.lawColumns() <= own_column::kMemory) return found;
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

  Rows& ownAt(Index c) { return own_[static_cast<std::size_t>(c)]; }

  /// Columns of law k in the rows of all joints that it acts on. Gravity stands in gravity_.
  void addLaw(Index k, const GramSamples& samples) {
    const Index size = samples.q.count, n = samples.q.joints;
    const StepFriction& law = fit_.friction[static_cast<std::size_t>(k)];
    const Values velocity = ofLaw(k, samples.qd), position = ofLaw(k, samples.q);
    const bool is_joints = !isCoupled(coupling_, k);
    const Values load =
        is_joints ? Values(gravity_.row(k).head(size).array().abs()) : Values(Values::Zero(size));
    const Values acceleration = k < n ? valuesOf(samples.qdd, k) : Values(Values::Zero(size));
    frictionColumns(law, velocity, acceleration, load, presliding(law, k, position),
                    rows_.lawColumns(), [&](Index c) { return law_.row(c).head(size).array(); });
    for (Index j = 0; j < n; ++j) {
      for (const OwnRows::Place& place : rows_.of(j)) {
        if (place.law != k) continue;
        for (Index c = 0; c < rows_.lawColumns(); ++c) {
          const bool is_rotor = c == own_column::kAcceleration;
          if (is_rotor && k != j) continue;
          ownAt(place.first + c).row(j).head(size) =
              (is_rotor ? 1.0 : place.factor) * law_.row(c).head(size);
        }
      }
    }
  }

  void addSpring(Index j, const Values& q) {
    const auto column = [&](Index c) {
      return ownAt(rows_.springs() + c).row(j).head(q.size()).array();
    };
    switch (springs_[static_cast<std::size_t>(j)]) {
      case SpringTerms::kNone:
        break;
      case SpringTerms::kLinear:
        column(0) = q;
        break;
      case SpringTerms::kLever:
        column(0) = q.sin();
        column(1) = q.cos();
        break;
    }
  }

  /// Torques of rotor, friction and spring of a joint, from its columns.
  Values linearPart(Index j, Index size) const {
    const auto column = [&](Index c) {
      return own_[static_cast<std::size_t>(c)].row(j).head(size).array();
    };
    Values sum = fit_.rotor_inertia[j] * column(own_column::kAcceleration);
    for (const OwnRows::Place& place : rows_.of(j)) {
      const StepFriction& law = fit_.friction[static_cast<std::size_t>(place.law)];
      for (const auto& [c, coefficient] : kLinear) {
        if (c < rows_.lawColumns()) sum += law.*coefficient * column(place.first + c);
      }
    }
    for (Index c = 0; c < 2 && fit_.springs.size() > 0; ++c) {
      sum += fit_.springs(c, j) * column(rows_.springs() + c);
    }
    return sum;
  }

  const ArmFit& fit_;
  const OwnRows& rows_;
  const OwnedMatrix& coupling_;
  const std::vector<SpringTerms>& springs_;
  bool has_gains_;
  Rows law_;                             // columns of one law
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
  const OwnRows rows_of_joints = rowsOf(terms, fit.drive_gains.size() > 0);
  RegressorGram gram = fast_.emptyGram(rows_of_joints.columns());
  gram.share(rows_of_joints.unknowns());
  const FastModel alone(robotOf(fit.parameters, nullptr), fast_);
  Batch batch(fit, rows_of_joints, coupling_, springs_);
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
  model.friction_places = places_;
  if (springs_.empty()) return model;
  model.rest = model.stiffness = VectorXd::Zero(joints());
  model.levers = MatrixXd::Zero(2, joints());
  for (Index j = 0; j < joints(); ++j) {
    if (springs_[static_cast<std::size_t>(j)] == SpringTerms::kLinear) {
      model.stiffness[j] = fit.springs(0, j);
    } else {
      model.levers.col(j) = fit.springs.col(j);
    }
  }
  return model;
}

void ArmFitter::torques(const ArmFit& fit, ConstStates q, ConstStates qd, ConstStates qdd,
                        States tau, ConstStates before) const {
  const Model found = model(fit);
  const auto fast = springs_.empty()
                        ? std::make_unique<const FastModel>(found, fast_)
                        : std::make_unique<const FastModel>(found);  // of other kernels
  fast->torquesBatch(q, qd, qdd, tau);
  FrictionState friction(found);
  friction.moveAlong(before);
  friction.addAlong(q, qd, tau);
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

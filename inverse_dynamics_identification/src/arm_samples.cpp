// SPDX-License-Identifier: Apache-2.0

/// @file
/// What ArmFitter does with samples: rows for Gram matrices, and torques.

#include <algorithm>
#include <chain_dynamics/error.hpp>
#include <cmath>
#include <string>
#include <utility>

#include "inverse_dynamics_identification/arm_fit.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

using chain_dynamics::Chain;
using chain_dynamics::ConstStates;
using chain_dynamics::FastModel;
using chain_dynamics::GramSamples;
using chain_dynamics::Model;
using chain_dynamics::ModelError;
using chain_dynamics::RegressorGram;
using chain_dynamics::States;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kBatch = 512;  // samples whose columns are held

/// Of a gram, without that of the drive gain.
Index frictionColumns(const ArmFit& fit, const RegressorGram& gram) {
  const Index n = fit.rotor_inertia.size(), gain = fit.drive_gains.size() > 0 ? 1 : 0;
  const Index columns = gram.ownColumns() - gain;
  for (const FrictionTerms terms :
       {FrictionTerms::kStep, FrictionTerms::kLoad, FrictionTerms::kStribeck}) {
    if (gram.joints() == n && columns == ownColumns(terms)) return columns;
  }
  throw ModelError("ArmFitter.addToGram", "gram",
                   std::to_string(n) + " joints and " + std::to_string(6 + gain) + ", " +
                       std::to_string(7 + gain) + " or " + std::to_string(9 + gain) +
                       " own columns",
                   std::to_string(gram.joints()) + " joints and " +
                       std::to_string(gram.ownColumns()) + " columns",
                   "make it with ownColumns(terms)" +
                       std::string(gain > 0 ? " and one more for the drive gain" : ""));
}

bool isSomething(const LinkParameters& body) { return !body.toVector().isZero(0); }

/// A batch of samples, and what is computed of it. Columns: samples.
struct Batch {
  Batch(Index n, Index own_columns)
      : gravity(n, kBatch),
        loaded(n, kBatch),
        alone(n, kBatch),
        tau(n, kBatch),
        own(static_cast<std::size_t>(own_columns), MatrixXd(n, kBatch)) {}

  MatrixXd gravity, loaded, alone, tau;
  std::vector<MatrixXd> own;
};

}  // namespace

Chain ArmFitter::withLinks(const OwnedMatrix& parameters, const OwnedVector* rotors,
                           const LinkParameters& carried) const {
  std::vector<chain_dynamics::Joint> joints = chain_.joints();
  std::vector<LinkParameters> links;
  for (Index j = 0; j < parameters.cols(); ++j) {
    joints[static_cast<std::size_t>(j)].rotor_inertia = rotors == nullptr ? 0 : (*rotors)[j];
    const Eigen::Matrix<double, 10, 1> p = parameters.col(j);
    links.push_back(LinkParameters::fromVector(p));
  }
  links.back() += chain_.tip() * carried;
  return Chain(chain_.name(), std::move(joints), std::move(links), chain_.gravity(), chain_.tip());
}

void ArmFitter::addToGram(const ArmFit& fit, const ArmSamples& samples, RegressorGram& gram) const {
  check(fit);
  const Index n = chain_.jointCount(), columns = frictionColumns(fit, gram);
  const bool has_gains = fit.drive_gains.size() > 0, carries = isSomething(samples.carried);
  const FastModel alone(Model(withLinks(fit.parameters, nullptr)), fast_);
  const FastModel loaded(Model(withLinks(fit.parameters, nullptr, samples.carried)), fast_);
  Batch of(n, gram.ownColumns());
  VectorXd row(columns);
  for (Index first = 0; first < samples.q.count; first += kBatch) {
    const Index size = std::min(kBatch, samples.q.count - first);
    const ConstStates q = samples.q.middle(first, size), qd = samples.qd.middle(first, size),
                      qdd = samples.qdd.middle(first, size),
                      measured = samples.tau.middle(first, size);
    loaded.gravityVectorBatch(q, of.gravity.leftCols(size));
    if (has_gains || carries) loaded.torquesBatch(q, qd, qdd, of.loaded.leftCols(size));
    if (carries) alone.torquesBatch(q, qd, qdd, of.alone.leftCols(size));
    for (Index k = 0; k < size; ++k) {
      for (Index j = 0; j < n; ++j) {
        const StepFriction& law = fit.friction[static_cast<std::size_t>(j)];
        const double load = std::abs(of.gravity(j, k));
        ownColumnsAt(law, qd(j, k), qdd(j, k), load, row);
        for (Index c = 0; c < columns; ++c) of.own[static_cast<std::size_t>(c)](j, k) = row[c];
        const double known = carries ? of.loaded(j, k) - of.alone(j, k) : 0.0;
        of.tau(j, k) = (has_gains ? fit.drive_gains[j] : 1.0) * measured(j, k) - known;
        if (!has_gains) continue;
        of.own.back()(j, k) =
            -(of.loaded(j, k) + fit.rotor_inertia[j] * qdd(j, k) + friction(law, qd(j, k), load));
      }
    }
    const ConstStates tau = of.tau.leftCols(size);
    GramSamples batch{q, qd, qdd, tau};
    for (const MatrixXd& column : of.own) batch.own_columns.emplace_back(column.leftCols(size));
    fast_.addToGram(batch, gram);
  }
}

void ArmFitter::torques(const ArmFit& fit, ConstStates q, ConstStates qd, ConstStates qdd,
                        States tau) const {
  check(fit);
  const Index n = chain_.jointCount();
  const FastModel model(Model(withLinks(fit.parameters, &fit.rotor_inertia)), fast_);
  model.torquesBatch(q, qd, qdd, tau);
  MatrixXd gravity(n, kBatch);
  for (Index first = 0; first < q.count; first += kBatch) {
    const Index size = std::min(kBatch, q.count - first);
    model.gravityVectorBatch(q.middle(first, size), gravity.leftCols(size));
    for (Index k = 0; k < size; ++k) {
      for (Index j = 0; j < n; ++j) {
        tau(j, first + k) += friction(fit.friction[static_cast<std::size_t>(j)], qd(j, first + k),
                                      std::abs(gravity(j, k)));
      }
    }
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

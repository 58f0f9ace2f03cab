// SPDX-License-Identifier: Apache-2.0

/// @file
/// Information about an arm's unknowns from samples with correlated errors.

#include <chain_dynamics/error.hpp>
#include <chain_dynamics/fast_model.hpp>
#include <chain_dynamics/model.hpp>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "inverse_dynamics_identification/arm_fit.hpp"
#include "own_rows.hpp"
#include "whitening.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Rows of one joint: ten columns of each link, and its own. Means of them are filtered and added up.
struct WhitenedRows {
  WhitenedRows(double white, double correlated, double correlation_time, Index columns)
      : filter(white * white, correlated * correlated, correlation_time),
        row(VectorXd::Zero(columns)),
        state(row),
        sum(MatrixXd::Zero(columns, columns)) {}

  void addMean(double period, double weight) {
    row *= weight;
    filter.advance(period);
    filter.whiten(row, state);
    sum.selfadjointView<Eigen::Lower>().rankUpdate(row);
    row.setZero();
  }

  NoiseFilter filter;
  VectorXd row, state;  // row: the sum of those of a mean
  MatrixXd sum;         // lower triangle
};

}  // namespace

OwnedMatrix ArmFitter::whitenedInformation(const ArmFit& fit, FrictionTerms terms,
                                           const ArmData& data, const ResidualNoise& noise) const {
  check(fit);
  const OwnRows rows = rowsOf(terms, false);
  const Index n = joints(), own = rows.columns(), rigid = 10 * links();
  if (noise.white.size() != n || noise.correlated.size() != n) {
    throw chain_dynamics::ModelError("ArmFitter.whitenedInformation", "noise",
                                     "numbers of each joint", "others", "take that of the samples");
  }
  std::vector<WhitenedRows> whitened;
  whitened.reserve(static_cast<std::size_t>(n));
  for (Index j = 0; j < n; ++j) {
    whitened.emplace_back(noise.white[j], noise.correlated[j], noise.correlation_time, rigid + own);
  }
  const chain_dynamics::FastModel alone(robotOf(fit.parameters, nullptr), fast_);
  MatrixXd Y(n, rigid);
  VectorXd gravity(n), q(n), qd(n), qdd(n), law_row(rows.lawColumns());
  MatrixXd own_rows = MatrixXd::Zero(n, own);
  MeanSpan span(noise.correlation_time);
  double last = 0.0;  // s, of means
  const auto end_mean = [&] {
    for (WhitenedRows& joint : whitened) joint.addMean(span.time() - last, span.weight());
    last = span.time();
    span.restart();
  };
  for (const ArmData::Block& of : data.blocks_) {
    const ArmSamples& block = of.samples;
    if (block.time.size() != block.q.count) {
      throw chain_dynamics::ModelError(
          "ArmFitter.whitenedInformation", "time", std::to_string(block.q.count) + " numbers",
          std::to_string(block.time.size()), "pair each sample with its time");
    }
    for (WhitenedRows& joint : whitened) joint.filter.restart();
    std::vector<FittedPresliding> memories(static_cast<std::size_t>(laws()));
    VectorXd before;
    const auto remember = [&] {
      for (Index l = 0; l < laws() && before.size() > 0; ++l) {
        const auto of_law = [&](const VectorXd& x) {
          return atLaw(coupling_, l, [&](Index j) { return x[j]; });
        };
        move(memories[static_cast<std::size_t>(l)], of_law(q) - of_law(before),
             fit.friction[static_cast<std::size_t>(l)]);
      }
      before = q;
    };
    for (Index k = 0; k < block.before.count; ++k) {
      for (Index j = 0; j < n; ++j) q[j] = block.before(j, k);
      remember();
    }
    for (Index k = 0; k < block.q.count; ++k) {
      if (span.endsBefore(block.time[k])) end_mean();
      span.add(block.time[k]);
      for (Index j = 0; j < n; ++j) {
        q[j] = block.q(j, k);
        qd[j] = block.qd(j, k);
        qdd[j] = block.qdd(j, k);
      }
      remember();
      fast_.regressor(q.data(), qd.data(), qdd.data(), Y.data(), n);
      alone.gravityVector(q.data(), gravity.data());
      for (Index j = 0; j < n; ++j) {
        WhitenedRows& joint = whitened[static_cast<std::size_t>(j)];
        joint.row.head(rigid) += Y.row(j).transpose();
      }
      const auto memory = [&](Index law) -> const FittedPresliding& {
        return memories[static_cast<std::size_t>(law)];
      };
      fillOwnRows(rows, coupling_, springs_, fit.friction, q, qd, qdd, gravity, memory, law_row,
                  own_rows);
      for (Index j = 0; j < n; ++j) {
        whitened[static_cast<std::size_t>(j)].row.tail(own) += own_rows.row(j).transpose();
      }
    }
    if (!span.isEmpty()) end_mean();
  }
  OwnedMatrix information;
  information.resize(rigid + rows.unknownCount(), rigid + rows.unknownCount());
  information.setZero();
  for (Index j = 0; j < n; ++j) {
    const MatrixXd sum = whitened[static_cast<std::size_t>(j)].sum.selfadjointView<Eigen::Lower>();
    const std::vector<int>& unknowns = rows.unknowns()[static_cast<std::size_t>(j)];
    information.topLeftCorner(rigid, rigid) += sum.topLeftCorner(rigid, rigid);
    for (Index c = 0; c < own; ++c) {
      const Index to = rigid + unknowns[static_cast<std::size_t>(c)];
      if (to < rigid) continue;
      information.col(to).head(rigid) += sum.col(rigid + c).head(rigid);
      information.row(to).head(rigid) += sum.row(rigid + c).head(rigid);
      for (Index i = 0; i < own; ++i) {
        const Index from = rigid + unknowns[static_cast<std::size_t>(i)];
        if (from >= rigid) information(from, to) += sum(rigid + i, rigid + c);
      }
    }
  }
  return information;
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

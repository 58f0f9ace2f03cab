// SPDX-License-Identifier: Apache-2.0

/// @file
/// Own columns of the joints' rows, whose laws of friction may act on several joints, and their unknowns.

#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <chain_dynamics/owned.hpp>
#include <cmath>
#include <cstddef>
#include <vector>

#include "inverse_dynamics_identification/friction_step.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

/// A row has the columns of its joint's law, with its acceleration; that of the drive gain, if it is fitted;
/// those of each other law that acts on the joint, whose acceleration has no unknown; and two of springs. Laws
/// beyond those of joints have no offset: more offsets than joints can't be told apart.
///
/// Unknowns are ownColumns(terms) of each joint and its law, with the gain's, then those of the other laws, then
/// those of springs.
class OwnRows {
 public:
  /// Columns c of a law stand at first + c in the row, times the factor.
  struct Place {
    Eigen::Index law, joint;
    double factor;
    Eigen::Index first;
  };

  /// @param coupling  empty: each joint has its own law.
  /// @param springs   of each joint; empty: none.
  OwnRows(const chain_dynamics::OwnedMatrix& coupling, const std::vector<SpringTerms>& springs,
          Eigen::Index joints, FrictionTerms terms, bool has_gains)
      : law_columns_(ownColumns(terms)) {
    const Eigen::Index laws = coupling.size() == 0 ? joints : coupling.rows();
    const Eigen::Index own = law_columns_ + (has_gains ? 1 : 0);
    columns_ = own;
    homes_.resize(static_cast<std::size_t>(laws));
    for (Eigen::Index j = 0; j < joints; ++j) {
      std::vector<Place>& row = rows_.emplace_back();
      row.push_back({j, j, coupling.size() == 0 ? 1.0 : coupling(j, j), 0});
      Eigen::Index next = own;
      for (Eigen::Index k = 0; k < coupling.rows(); ++k) {
        if (k == j || coupling(k, j) == 0) continue;
        row.push_back({k, j, coupling(k, j), next});
        next += law_columns_;
      }
      columns_ = std::max(columns_, next);
      for (const Place& place : row) {
        if (place.law == j || place.law >= joints)
          homes_[static_cast<std::size_t>(place.law)] = place;
      }
    }
    springs_ = columns_;
    if (!springs.empty()) columns_ += 2;
    Eigen::Index of_springs = own * joints + (law_columns_ - 2) * (laws - joints);
    for (const std::vector<Place>& row : rows_) {
      std::vector<int>& unknowns = unknowns_.emplace_back(static_cast<std::size_t>(columns_), -1);
      for (const Place& place : row) {
        for (Eigen::Index c = 0; c < law_columns_; ++c) {
          unknowns[static_cast<std::size_t>(place.first + c)] =
              static_cast<int>(unknownOf(place, c, joints, own));
        }
      }
      if (has_gains) {
        unknowns[static_cast<std::size_t>(law_columns_)] =
            static_cast<int>(own * row.front().joint + law_columns_);
      }
      if (springs.empty()) continue;
      const auto terms_of_spring =
          static_cast<Eigen::Index>(springs[static_cast<std::size_t>(row.front().joint)]);
      for (Eigen::Index c = 0; c < terms_of_spring; ++c) {
        unknowns[static_cast<std::size_t>(springs_ + c)] = static_cast<int>(of_springs++);
      }
    }
    unknown_count_ = of_springs;
  }

  Eigen::Index laws() const { return static_cast<Eigen::Index>(homes_.size()); }
  /// Of a row; of one law; where those of springs begin.
  Eigen::Index columns() const { return columns_; }
  Eigen::Index lawColumns() const { return law_columns_; }
  Eigen::Index springs() const { return springs_; }
  /// Of all laws that act on the joint: its own first.
  const std::vector<Place>& of(Eigen::Index joint) const {
    return rows_[static_cast<std::size_t>(joint)];
  }
  /// One of the places of a law.
  const Place& home(Eigen::Index law) const { return homes_[static_cast<std::size_t>(law)]; }
  /// For RegressorGram::share().
  const std::vector<std::vector<int>>& unknowns() const { return unknowns_; }
  Eigen::Index unknownCount() const { return unknown_count_; }

 private:
  Eigen::Index unknownOf(const Place& place, Eigen::Index column, Eigen::Index joints,
                         Eigen::Index own) const {
    const bool is_own = place.law == place.joint;
    if (column == own_column::kAcceleration && !is_own) return -1;
    if (place.law < joints) return own * place.law + column;
    if (column == own_column::kOne) return -1;
    const Eigen::Index before = column > own_column::kOne ? 2 : 1;  // without an unknown
    return own * joints + (law_columns_ - 2) * (place.law - joints) + column - before;
  }

  Eigen::Index law_columns_, columns_ = 0, springs_ = 0, unknown_count_ = 0;
  std::vector<std::vector<Place>> rows_;
  std::vector<Place> homes_;
  std::vector<std::vector<int>> unknowns_;
};

/// Whether a law's row of the coupling isn't that of its joint alone.
inline bool isCoupled(const chain_dynamics::OwnedMatrix& coupling, Eigen::Index law) {
  return coupling.size() > 0 &&
         (law >= coupling.cols() || (coupling.row(law).array() != 0).count() > 1 ||
          coupling(law, law) != 1);
}

/// Velocity or position of a law from those of joints, x(j): numbers or arrays of them.
template <typename Of>
auto atLaw(const chain_dynamics::OwnedMatrix& coupling, Eigen::Index law, const Of& x) {
  if (coupling.size() == 0) return x(law);
  auto sum = coupling(law, 0) == 1 ? x(0) : decltype(x(0))(coupling(law, 0) * x(0));
  for (Eigen::Index j = 1; j < coupling.cols(); ++j) {
    if (coupling(law, j) != 0) sum += coupling(law, j) * x(j);
  }
  return sum;
}

/// The own columns of all joints' rows at one sample.
///
/// @param memory          memory(law): presliding of a law up to the sample.
/// @param[out] law_row    rows.lawColumns() numbers, for the columns of one law.
/// @param[out] own_rows   n x rows.columns(); those of drive gains stay as they are.
template <class Vector, class Memory>
void fillOwnRows(const OwnRows& rows, const chain_dynamics::OwnedMatrix& coupling,
                 const std::vector<SpringTerms>& springs, const std::vector<StepFriction>& laws,
                 const Vector& q, const Vector& qd, const Vector& qdd,
                 const Eigen::Ref<const Eigen::VectorXd>& gravity, const Memory& memory,
                 Eigen::Ref<Eigen::VectorXd> law_row, Eigen::Ref<Eigen::MatrixXd> own_rows) {
  for (Eigen::Index k = 0; k < rows.laws(); ++k) {
    const double velocity = atLaw(coupling, k, [&](Eigen::Index j) { return double(qd[j]); });
    const double load = isCoupled(coupling, k) ? 0.0 : std::abs(gravity[k]);
    ownColumnsAt(laws[static_cast<std::size_t>(k)], velocity, 0, load, memory(k), law_row);
    for (Eigen::Index j = 0; j < own_rows.rows(); ++j) {
      for (const OwnRows::Place& place : rows.of(j)) {
        if (place.law != k) continue;
        own_rows.row(j).segment(place.first, law_row.size()) = place.factor * law_row.transpose();
      }
    }
  }
  own_rows.col(own_column::kAcceleration) = qdd;
  for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(springs.size()); ++j) {
    const SpringTerms spring = springs[static_cast<std::size_t>(j)];
    const bool is_lever = spring == SpringTerms::kLever;
    own_rows(j, rows.springs()) = is_lever ? std::sin(q[j]) : q[j];
    own_rows(j, rows.springs() + 1) = is_lever ? std::cos(q[j]) : 0.0;
  }
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

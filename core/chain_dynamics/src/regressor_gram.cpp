// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/regressor_gram.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "fast/robot.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

using Eigen::Index;

constexpr Index kParameters = 10;

std::string sizeText(Index rows, Index cols) {
  return std::to_string(rows) + " x " + std::to_string(cols);
}

void requireSize(const char* what, Index rows, Index cols, Index got_rows, Index got_cols) {
  if (rows == got_rows && cols == got_cols) return;
  throw ModelError("Gram matrix of the regressor", what, sizeText(rows, cols),
                   sizeText(got_rows, got_cols), "");
}

/// The links that each joint of a chain moves.
std::vector<std::vector<int>> suffixes(Index joints) {
  if (joints < 1 || joints > fast::kMaxJoints) {
    throw ModelError("Gram matrix of the regressor", "joints",
                     "1 to " + std::to_string(fast::kMaxJoints), std::to_string(joints), "");
  }
  std::vector<std::vector<int>> moved(static_cast<std::size_t>(joints));
  for (Index j = 0; j < joints; ++j) {
    for (Index i = j; i < joints; ++i)
      moved[static_cast<std::size_t>(j)].push_back(static_cast<int>(i));
  }
  return moved;
}

}  // namespace

RegressorGram::RegressorGram(Index joints, Index own_columns)
    : RegressorGram(suffixes(joints), joints, own_columns) {}

RegressorGram::RegressorGram(std::vector<std::vector<int>> moved, Index links, Index own_columns)
    : moved_(std::move(moved)),
      links_(links),
      own_columns_(own_columns),
      own_unknowns_(own_columns * joints()) {
  if (own_columns < 0) {
    throw ModelError("Gram matrix of the regressor", "own columns", "0 or more",
                     std::to_string(own_columns), "");
  }
  sums_.resize(static_cast<std::size_t>(firstSum(joints())), 0.0);
}

void RegressorGram::share(std::vector<std::vector<int>> unknowns) {
  std::set<int> found;
  for (const std::vector<int>& of_joint : unknowns) {
    requireSize("own columns with an unknown", own_columns_, 1, static_cast<Index>(of_joint.size()),
                1);
    found.insert(of_joint.begin(), of_joint.end());
  }
  requireSize("joints with unknowns", joints(), 1, static_cast<Index>(unknowns.size()), 1);
  found.erase(-1);
  const auto count = static_cast<int>(found.size());
  if (count > 0 && (*found.begin() != 0 || *found.rbegin() != count - 1)) {
    throw ModelError("Gram matrix of the regressor", "unknowns of own columns",
                     "each from 0 on at least once, or -1 for none",
                     std::to_string(*found.begin()) + " to " + std::to_string(*found.rbegin()) +
                         ", " + std::to_string(count) + " of them",
                     "");
  }
  shared_ = std::move(unknowns);
  own_unknowns_ = count;
}

void RegressorGram::requireRobot(const RegressorGram& other) const {
  requireSize("joints", joints(), 1, other.joints(), 1);
  if (moved_ == other.moved_) return;
  throw ModelError("Gram matrix of the regressor", "links that each joint moves", "the same",
                   "others", "add sums of one robot");
}

void RegressorGram::add(const RegressorGram& other) {
  requireSize("joints x own columns", joints(), own_columns_, other.joints(), other.own_columns_);
  requireRobot(other);
  if (shared_ != other.shared_) {
    throw ModelError("Gram matrix of the regressor", "unknowns of own columns", "the same",
                     "others", "add sums of the same columns");
  }
  std::transform(sums_.begin(), sums_.end(), other.sums_.begin(), sums_.begin(), std::plus<>());
  samples_ += other.samples_;
}

void RegressorGram::addLinks(const RegressorGram& other) {
  requireRobot(other);
  for (Index j = 0; j < joints(); ++j) {
    const double* from = other.sums_.data() + other.firstLinks(j);
    double* to = sums_.data() + firstLinks(j);
    const Index links = storedLinks(j);
    for (Index a = 0; a < links; ++a, from += other.storedRow(j), to += storedRow(j)) {
      for (Index b = a; b < links; ++b) to[b] += from[b];
    }
  }
}

std::ptrdiff_t RegressorGram::storedRow(Index joint) const {
  return fast::ownRow(static_cast<int>(own_columns_)) +
         fast::linksRow(static_cast<int>(storedLinks(joint) / kParameters), 0);
}

std::ptrdiff_t RegressorGram::firstSum(Index joint) const {
  std::ptrdiff_t first = 0;
  for (Index j = 0; j < joint; ++j) first += storedRow(j) * storedRow(j);
  return first;
}

std::ptrdiff_t RegressorGram::firstLinks(Index joint) const {
  return firstSum(joint) + fast::ownRow(static_cast<int>(own_columns_)) * (storedRow(joint) + 1);
}

void RegressorGram::rowGram(Index joint, Eigen::Ref<Eigen::MatrixXd> G) const {
  if (joint < 0 || joint >= joints()) {
    throw ModelError("Gram matrix of the regressor", "joint",
                     "0 to " + std::to_string(joints() - 1), std::to_string(joint), "");
  }
  requireSize("matrix", rowSize(), rowSize(), G.rows(), G.cols());
  G.setZero();
  const Index rigid = kParameters * links_, stored = storedLinks(joint);
  const std::ptrdiff_t step = storedRow(joint);
  const double* row = sums_.data() + firstSum(joint);
  for (Index a = rigid; a < rowSize(); ++a, row += step) {
    for (Index b = a; b < rowSize(); ++b) G(a, b) = G(b, a) = row[b - rigid];
    const double* links = row + fast::ownRow(static_cast<int>(own_columns_));
    for (Index k = 0; k < stored; ++k) {
      const Index b = columnOf(joint, k);
      G(a, b) = G(b, a) = links[k];
    }
  }
  row = sums_.data() + firstLinks(joint);
  for (Index k = 0; k < stored; ++k, row += step) {
    const Index a = columnOf(joint, k);
    for (Index i = k; i < stored; ++i) {
      const Index b = columnOf(joint, i);
      G(a, b) = G(b, a) = row[i];
    }
  }
}

void RegressorGram::normalEquations(const Eigen::Ref<const Eigen::VectorXd>& weights,
                                    Eigen::Ref<Eigen::MatrixXd> A,
                                    Eigen::Ref<Eigen::VectorXd> b) const {
  requireSize("weights", joints(), 1, weights.rows(), weights.cols());
  requireSize("A", unknowns(), unknowns(), A.rows(), A.cols());
  requireSize("b", unknowns(), 1, b.rows(), b.cols());
  A.setZero();
  b.setZero();
  Eigen::MatrixXd G(rowSize(), rowSize());
  const Index rigid = kParameters * links_;
  const Index tau = rowSize() - 1;
  for (Index j = 0; j < joints(); ++j) {
    rowGram(j, G);
    const double w = weights[j];
    A.topLeftCorner(rigid, rigid) += w * G.topLeftCorner(rigid, rigid);
    b.head(rigid) += w * G.col(tau).head(rigid);
    for (Index c = 0; c < own_columns_; ++c) {
      const Index u = unknownOf(j, c), own = rigid + u;
      if (u < 0) continue;
      A.col(own).head(rigid) += w * G.col(rigid + c).head(rigid);
      A.row(own).head(rigid) += w * G.col(rigid + c).head(rigid);
      for (Index i = 0; i < own_columns_; ++i) {
        if (unknownOf(j, i) >= 0) A(rigid + unknownOf(j, i), own) += w * G(rigid + i, rigid + c);
      }
      b[own] += w * G(tau, rigid + c);
    }
  }
}

}  // namespace v2
}  // namespace chain_dynamics

// SPDX-License-Identifier: Apache-2.0

/// @file
/// What a fit of inertial parameters needs of measured motions: sums that don't grow with them.
///
///     RegressorGram gram = fast.emptyGram(3);                       // of 3 friction columns
///     const std::vector<ConstStates> friction = {qd, signs, ones};  // n x N each
///     fast.addToGram({q, qd, qdd, tau, friction}, gram);            // any number of times
///     gram.normalEquations(weights, A, b);                          // A x = b
///
/// The torque of joint j is linear in the inertial parameters p [regressor.hpp] and in whatever
/// else is linear, as most of friction is: `tau_j = Y_j p + c_j x_j`, c_j the joint's own columns.
/// All that least squares need of the samples are the products of the numbers of one row,
///
///     r_j = [Y_j | c_j | tau_j],    G_j = sum over the samples of w_j r_j' r_j
///
/// The regressor itself is never held: its rows are made a few states at a time, in the cache.
/// Each joint has a matrix of its own, so joints can be weighed against each other afterwards. Columns of
/// several joints may have one unknown: share().

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "chain_dynamics/states.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Rows Y_j of samples, which takes them 8 bytes for each of about 5 n (n + 1) numbers of a chain.
class RegressorRows {
  friend class FastModel;
  Eigen::Index samples_ = 0;
  std::vector<double> numbers_;
};

/// N samples of n joints. Views: what they look at must live as long.
struct GramSamples {
  ConstStates q, qd, qdd;  ///< rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2)
  ConstStates tau;         ///< N m (prismatic N)
  /// Each joint's own columns, n x N each: velocities, their signs, ones, accelerations (for rotor
  /// inertia), ...
  std::vector<ConstStates> own_columns = {};
  /// Of each joint and sample, none negative; all one where there are none.
  std::optional<ConstStates> weights = {};
  /// Whether products of two numbers of Y_j are summed: addLinks() has them from other sums.
  bool links = true;
  /// Where the rows Y_j, times their weights' roots, are to be kept; and those that were kept of the same
  /// samples, and needn't be made again.
  RegressorRows* keep = nullptr;
  const RegressorRows* rows = nullptr;
};

/// Gram matrices of the rows of all joints, which FastModel::addToGram() adds samples to.
///
/// A NaN among the samples makes sums NaN, even if its weight is zero. Threads: one object for each,
/// then add().
class RegressorGram {
 public:
  /// Zero, for chains of so many joints and rows with so many columns of the joint's own; of any robot:
  /// FastModel::emptyGram().
  ///
  /// @throws ModelError  no joint, more than 64, or a negative number of columns.
  explicit RegressorGram(Eigen::Index joints, Eigen::Index own_columns = 0);

  Eigen::Index joints() const { return static_cast<Eigen::Index>(moved_.size()); }
  Eigen::Index links() const { return links_; }  ///< of a chain as many as joints
  Eigen::Index ownColumns() const { return own_columns_; }
  /// How many have been added.
  Eigen::Index samples() const { return samples_; }
  /// Numbers of a row r_j: ten of each link, own columns, torque.
  Eigen::Index rowSize() const { return 10 * links_ + own_columns_ + 1; }
  /// Unknowns of the normal equations: ten parameters of each link, then each joint's own in turn, or those
  /// of share().
  Eigen::Index unknowns() const { return 10 * links_ + own_unknowns_; }
  /// The unknown, from 0 on behind those of the links, of a joint's own column; -1: none.
  Eigen::Index unknownOf(Eigen::Index joint, Eigen::Index column) const {
    if (shared_.empty()) return own_columns_ * joint + column;
    return shared_[static_cast<std::size_t>(joint)][static_cast<std::size_t>(column)];
  }

  /// States the unknown of each own column of each joint, as unknownOf() gives it: the same for columns of
  /// several joints, or of one. Each from 0 on at least once.
  ///
  /// @throws ModelError  another number of joints or columns, an unknown without a column.
  void share(std::vector<std::vector<int>> unknowns);
  /// The first link that joint j moves: columns of those before it are zero in its row.
  Eigen::Index firstLink(Eigen::Index joint) const {
    return moved_[static_cast<std::size_t>(joint)].front();
  }

  /// Adds the samples of another one.
  ///
  /// @throws ModelError  other numbers of joints, links or columns, other unknowns.
  void add(const RegressorGram& other);

  /// Adds the products of two numbers of Y_j of another one, whose own columns don't matter.
  ///
  /// @throws ModelError  another number of joints or links.
  void addLinks(const RegressorGram& other);

  /// G_j, symmetric; the columns of links that joint j doesn't move are zero.
  ///
  /// @param joint   0 .. n - 1.
  /// @param[out] G  rowSize() x rowSize(), entries in the order of r_j.
  /// @throws ModelError  no such joint, or a matrix of another size.
  void rowGram(Eigen::Index joint, Eigen::Ref<Eigen::MatrixXd> G) const;

  /// `Y' W Y` and `Y' W tau` over all joints and samples, own columns included: A x = b is solved by
  /// the least squares with these weights.
  ///
  /// @param weights  n: of each joint, times those of the samples.
  /// @param[out] A   unknowns() x unknowns(), symmetric, in general singular: not all parameters
  ///                 have an influence.
  /// @param[out] b   unknowns().
  /// @throws ModelError  another size.
  void normalEquations(const Eigen::Ref<const Eigen::VectorXd>& weights,
                       Eigen::Ref<Eigen::MatrixXd> A, Eigen::Ref<Eigen::VectorXd> b) const;

 private:
  friend class FastModel;

  /// For each joint the numbers of the links that it moves, ascending.
  RegressorGram(std::vector<std::vector<int>> moved, Eigen::Index links, Eigen::Index own_columns);

  /// Where the matrix of a joint begins: own columns and torque, then the links that it moves.
  std::ptrdiff_t firstSum(Eigen::Index joint) const;
  std::ptrdiff_t firstLinks(Eigen::Index joint) const;
  /// Numbers of a row there.
  std::ptrdiff_t storedRow(Eigen::Index joint) const;

  /// Numbers of Y_j that are stored, and the column of the k-th one.
  Eigen::Index storedLinks(Eigen::Index joint) const {
    return 10 * static_cast<Eigen::Index>(moved_[static_cast<std::size_t>(joint)].size());
  }
  Eigen::Index columnOf(Eigen::Index joint, Eigen::Index k) const {
    return Eigen::Index{10} *
               moved_[static_cast<std::size_t>(joint)][static_cast<std::size_t>(k / 10)] +
           k % 10;
  }
  void requireRobot(const RegressorGram& other) const;

  std::vector<std::vector<int>> moved_;
  Eigen::Index links_, own_columns_, own_unknowns_, samples_ = 0;
  std::vector<std::vector<int>> shared_;  // [joint][column]; empty: each column has its own
  std::vector<double> sums_;              // one matrix after the other: src/fast/gram.hpp
};

}  // namespace v2
}  // namespace chain_dynamics

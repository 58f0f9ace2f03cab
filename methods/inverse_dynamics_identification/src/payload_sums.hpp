// SPDX-License-Identifier: Apache-2.0
/// @file
/// Sums of filtered rows, by block of time and joint, in constant memory.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace inverse_dynamics_identification {
inline namespace v2 {

using Row = Eigen::Matrix<double, 12, 1>;    // 10 of the body, 1 of the offset, the residual
using Gram = Eigen::Matrix<double, 12, 12>;  // sum of row row'

/// Of a joint: sums of its rows, and of what its K deviations of the arm's model [arm_uncertainty.hpp]
/// have with them.
struct JointSums {
  explicit JointSums(Eigen::Index deviations)
      : arm(Eigen::MatrixXd::Zero(deviations, 12 + deviations)) {}

  void setZero() {
    body.setZero();
    arm.setZero();
  }
  void add(const Row& row, const Eigen::VectorXd& deviations) {
    body.noalias() += row * row.transpose();
    if (deviations.size() == 0) return;
    arm.leftCols<12>().noalias() += deviations * row.transpose();
    arm.rightCols(deviations.size()).selfadjointView<Eigen::Lower>().rankUpdate(deviations);
  }
  void operator+=(const JointSums& other) {
    body += other.body;
    arm += other.arm;
  }
  void operator-=(const JointSums& other) {
    body -= other.body;
    arm -= other.arm;
  }

  Gram body = Gram::Zero();
  Eigen::MatrixXd arm;  // K x (12 + K): deviations row', lower triangle of deviations deviations'
};

/// Sums of each joint and block. Where there are too many blocks, neighbours are joined
/// and later blocks are as long as two were.
class PayloadSums {
 public:
  PayloadSums(Eigen::Index joints, Eigen::Index deviations, double block_length)
      : joints_(static_cast<std::size_t>(joints)),
        first_length_(block_length),
        sums_(kMostBlocks * static_cast<std::size_t>(joints), JointSums(deviations)) {
    restart();
  }

  void restart() {
    blocks_ = 0;
    length_ = first_length_;
  }

  /// A new block begins with this time if the last one is long enough.
  void begin(double time) {
    if (blocks_ > 0 && time - begun_ < length_) return;
    if (blocks_ == kMostBlocks) {
      joinNeighbours();
      if (time - begun_ < length_) return;
    }
    for (std::size_t j = 0; j < joints_; ++j) at(blocks_, j).setZero();
    ++blocks_;
    begun_ = time;
  }

  void add(std::size_t joint, const Row& row, const Eigen::VectorXd& deviations) {
    at(blocks_ - 1, joint).add(row, deviations);
  }

  /// Blocks, the last one counted if it is at least half as long as the others, else as part of the
  /// one before.
  std::size_t blocks(double time) const {
    const bool last_is_short = blocks_ > 1 && time - begun_ < 0.5 * length_;
    return blocks_ - (last_is_short ? 1 : 0);
  }

  /// Sums of a joint in one of so many blocks.
  void get(std::size_t block, std::size_t joint, std::size_t blocks, JointSums& sum) const {
    sum = at(block, joint);
    if (block + 1 == blocks && blocks < blocks_) sum += at(blocks, joint);
  }

 private:
  static constexpr std::size_t kMostBlocks = 32;

  JointSums& at(std::size_t block, std::size_t joint) { return sums_[block * joints_ + joint]; }
  const JointSums& at(std::size_t block, std::size_t joint) const {
    return sums_[block * joints_ + joint];
  }

  void joinNeighbours() {
    for (std::size_t block = 0; block < kMostBlocks / 2; ++block) {
      for (std::size_t j = 0; j < joints_; ++j) {
        if (block > 0) at(block, j) = at(2 * block, j);
        at(block, j) += at(2 * block + 1, j);
      }
    }
    blocks_ = kMostBlocks / 2;
    begun_ -= length_;
    length_ *= 2.0;
  }

  std::size_t joints_, blocks_ = 0;
  double first_length_, length_ = 0.0, begun_ = 0.0;
  std::vector<JointSums> sums_;
};

}  // namespace v2
}  // namespace inverse_dynamics_identification

// SPDX-License-Identifier: Apache-2.0

/// @file
/// Recorded positions without the seams that drivers make who report within one turn.
///
///     Unwrapper unwrapper(solver.jointTypes());
///     while (stream.next(block)) unwrapper.unwrap(block);   // rewind() before another pass

#pragma once

#include <chain_dynamics/chain.hpp>
#include <string>
#include <utility>
#include <vector>

#include "sample_stream.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Makes positions of continuous joints go on where they jump by a turn from one sample to the next,
/// and counts such jumps of revolute joints, which stay as they are.
class Unwrapper {
 public:
  explicit Unwrapper(std::vector<chain_dynamics::JointType> types)
      : types_(std::move(types)), turns_(types_.size()) {}

  /// Changes the positions of the next samples; those of other joints than the types' stay.
  void unwrap(SampleBlock& block);

  /// Makes the first sample the next one.
  void rewind();

  /// A sentence for each revolute joint that has jumped in this pass.
  std::vector<std::string> findings(const std::vector<std::string>& joint_names) const;

 private:
  struct JointTurns {
    double offset = 0.0;     // rad; whole turns that its positions get
    Eigen::Index jumps = 0;  // that its positions keep
    Eigen::Index first = 0;  // number of the sample of the first of them
  };

  std::vector<chain_dynamics::JointType> types_;
  std::vector<JointTurns> turns_;
  Eigen::VectorXd q_, qd_;  // of the sample before, as recorded
  double time_ = 0.0;       // s; likewise
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

// SPDX-License-Identifier: Apache-2.0

#include "unwrapper.hpp"

#include <cmath>
#include <cstddef>

#include "pi.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

using chain_dynamics::JointType;
using chain_dynamics::unwrapped;
using Eigen::Index;

// A driver that reports within one turn jumps by one. A longer jump is of other units (360 degrees
// are 57 turns of a radian) or of another start, and stays for the diagnosis to see.
constexpr double kLongestJump = 1.5 * 2.0 * kPi;  // rad

// What a whole turn may be off by where velocity and time between two samples say how far the joint
// went: 3 rad/s over stamps that are wrong by 30 ms.
constexpr double kSeam = 0.1;  // rad

}  // namespace

void Unwrapper::unwrap(SampleBlock& block) {
  if (block.q.rows() != static_cast<Index>(types_.size())) return;  // refused elsewhere
  for (Index k = 0; k < block.size(); ++k) {
    if (q_.size() == 0) q_ = block.q.col(k);
    for (Index j = 0; j < q_.size(); ++j) {
      JointTurns& joint = turns_[static_cast<std::size_t>(j)];
      const double recorded = block.q(j, k), change = recorded - q_[j];
      if (std::abs(change) > kPi && std::abs(change) < kLongestJump) {
        const double turn = unwrapped(JointType::kContinuous, recorded, q_[j]) - recorded;
        const double way = 0.5 * (block.time[k] - time_) * (qd_[j] + block.qd(j, k));
        const JointType type = types_[static_cast<std::size_t>(j)];
        if (type == JointType::kContinuous) {
          // unless velocity says that the joint went there: in degrees it goes far between samples
          if (std::abs(change + turn - way) < std::abs(change - way)) joint.offset += turn;
        } else if (type == JointType::kRevolute && std::abs(change + turn - way) < kSeam) {
          if (joint.jumps++ == 0) joint.first = block.first + k;
        }
      }
      q_[j] = recorded;
      if (joint.offset != 0.0) block.q(j, k) += joint.offset;
    }
    qd_ = block.qd.col(k);
    time_ = block.time[k];
  }
}

void Unwrapper::rewind() {
  turns_.assign(types_.size(), {});
  q_.resize(0);
}

std::vector<std::string> Unwrapper::findings(const std::vector<std::string>& joint_names) const {
  std::vector<std::string> found;
  for (std::size_t j = 0; j < turns_.size(); ++j) {
    if (turns_[j].jumps == 0) continue;
    found.push_back("positions of " + joint_names[j] + " jump by a whole turn " +
                    std::to_string(turns_[j].jumps) +
                    (turns_[j].jumps == 1 ? " time" : " times, first") + " in sample " +
                    std::to_string(turns_[j].first + 1) +
                    ", and stay as recorded: the robot's model says that the joint is revolute; if "
                    "it has no limits, state it as continuous");
  }
  return found;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

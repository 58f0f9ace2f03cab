// SPDX-License-Identifier: Apache-2.0

#include "turns.hpp"

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

// Jumps of a joint by a whole turn.
struct Jumps {
  Index count = 0;
  Index first = 0;  // number of the sample
};

// Unwraps a continuous joint; finds the jumps of a revolute one.
Jumps unwrapJoint(SampleTable& table, Index j, JointType type) {
  Jumps jumps;
  double offset = 0.0;  // rad; whole turns that positions get
  double before = table.q(j, 0);
  for (Index k = 1; k < table.size(); ++k) {
    const double recorded = table.q(j, k), change = recorded - before;
    if (std::abs(change) > kPi && std::abs(change) < kLongestJump) {
      const double turn = unwrapped(JointType::kContinuous, recorded, before) - recorded;
      const double way =
          0.5 * (table.time[k] - table.time[k - 1]) * (table.qd(j, k - 1) + table.qd(j, k));
      if (type == JointType::kContinuous) {
        // unless velocity says that the joint went there: in degrees it goes far between samples
        if (std::abs(change + turn - way) < std::abs(change - way)) offset += turn;
      } else if (std::abs(change + turn - way) < kSeam) {
        if (jumps.count++ == 0) jumps.first = k;
      }
    }
    before = recorded;
    if (offset != 0.0) table.q(j, k) += offset;
  }
  return jumps;
}

}  // namespace

std::vector<std::string> unwrapPositions(SampleTable& table, const std::vector<JointType>& types,
                                         const std::vector<std::string>& joint_names) {
  std::vector<std::string> found;
  if (table.q.rows() != static_cast<Index>(types.size()) || table.size() == 0) return found;
  for (std::size_t j = 0; j < types.size(); ++j) {
    if (types[j] != JointType::kContinuous && types[j] != JointType::kRevolute) continue;
    const Jumps jumps = unwrapJoint(table, static_cast<Index>(j), types[j]);
    if (jumps.count == 0) continue;
    found.push_back("positions of " + joint_names[j] + " jump by a whole turn " +
                    std::to_string(jumps.count) + (jumps.count == 1 ? " time" : " times, first") +
                    " in sample " + std::to_string(jumps.first + 1) +
                    ", and stay as recorded: the robot's model says that the joint is revolute; if "
                    "it has no limits, state it as continuous");
  }
  return found;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

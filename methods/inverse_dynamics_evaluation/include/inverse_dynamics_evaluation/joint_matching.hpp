// SPDX-License-Identifier: Apache-2.0

/// @file
/// Where the joints of a chain are among the names of a message.
///
///     JointMatching matching({"joint_1", "joint_2"});
///     if (matching.match(message.name) == JointMatching::Found::kAll)
///       q[0] = message.position[matching.columns()[0]];
///
/// Joints are matched by name. Other joints may be there, in any order.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Finds joints among names, and remembers the answer for the same names in the next message.
class JointMatching {
 public:
  /// What a message has of the joints.
  enum class Found {
    kAll,       ///< each of them once: see columns()
    kNone,      ///< none: a message of other joints, a gripper's for one
    kMissing,   ///< some: culprits() are missing
    kRepeated,  ///< all, but culprits() more than once
  };

  /// @param joints  names, in the order wanted; each once.
  explicit JointMatching(std::vector<std::string> joints);

  /// Looks for the joints. Real time: no allocation if the names are those of the last call.
  Found match(const std::vector<std::string>& names);

  /// Index among the names of each joint, after kAll.
  const std::vector<std::size_t>& columns() const { return columns_; }

  /// Joints that are missing or repeated, after kMissing or kRepeated.
  const std::vector<std::string>& culprits() const { return culprits_; }

  const std::vector<std::string>& joints() const { return joints_; }

 private:
  std::vector<std::string> joints_;
  std::vector<std::string> names_;  // of the last call
  std::vector<std::size_t> columns_;
  std::vector<std::string> culprits_;
  Found found_ = Found::kNone;
};

/// `a, b, c`: names as texts list them, no more than 20; the middle of long ones is left out.
std::string listed(const std::vector<std::string>& names);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

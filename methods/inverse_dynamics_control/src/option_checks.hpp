// SPDX-License-Identifier: Apache-2.0
/// @file
/// Checks of options, with errors that name law, option and joint.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "chain_dynamics/text.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

/// Valid range of an option's numbers.
enum class Range {
  kAny,               ///< not NaN
  kNotNegative,       ///< finite and >= 0
  kPositive,          ///< finite and > 0
  kPositiveOrAbsent,  ///< > 0, infinity for none
  kShare,             ///< from 0 to 1
  kRate,              ///< from 0.001 to 1e6: far beyond what any arm needs, far from overflow
};

/// Throws inverse_dynamics_solver::InvalidParameterValueException unless `values` has a number per
/// joint, each in its range.
///
/// @param where  law and option: "computed torque: damping".
/// @param unit   of the numbers, for the text.
void requireJointNumbers(const std::string& where, const Eigen::Ref<const Eigen::VectorXd>& values,
                         Range range, const std::string& unit,
                         const std::vector<std::string>& joint_names);

/// Whether `values` has n numbers, each in its range.
bool areJointNumbers(const Eigen::Ref<const Eigen::VectorXd>& values, Range range,
                     Eigen::Index n) noexcept;

/// Gains Kp and Kd instead of those kept, without allocation; or, where they aren't as many, finite
/// and >= 0, nothing and false.
template <class PairOfGains>
bool replaceGains(const PairOfGains& gains, PairOfGains& kept) noexcept {
  if (!areJointNumbers(gains.Kp, Range::kNotNegative, kept.Kp.size()) ||
      !areJointNumbers(gains.Kd, Range::kNotNegative, kept.Kd.size())) {
    return false;
  }
  kept.Kp = gains.Kp;
  kept.Kd = gains.Kd;
  return true;
}

/// The same of one number.
void requireNumber(const std::string& where, double value, Range range, const std::string& unit);

using chain_dynamics::numberText;

}  // namespace v2
}  // namespace inverse_dynamics_control

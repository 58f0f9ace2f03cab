// SPDX-License-Identifier: Apache-2.0
#include "option_checks.hpp"

#include <algorithm>
#include <chain_dynamics/text.hpp>
#include <cmath>
#include <cstddef>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_control {
inline namespace v2 {
namespace {

bool isWithin(double value, Range range) {
  switch (range) {
    case Range::kAny:
      return !std::isnan(value);
    case Range::kNotNegative:
      return std::isfinite(value) && value >= 0;
    case Range::kPositive:
      return std::isfinite(value) && value > 0;
    case Range::kPositiveOrAbsent:
      return value > 0;
    case Range::kShare:
      return value >= 0 && value <= 1;
    case Range::kRate:
      return value >= 1e-3 && value <= 1e6;
  }
  return false;
}

const char* inWords(Range range) {
  switch (range) {
    case Range::kAny:
      return "a number, or infinity for no limit";
    case Range::kNotNegative:
      return "a finite number that isn't negative";
    case Range::kPositive:
      return "a finite number above zero";
    case Range::kPositiveOrAbsent:
      return "a number above zero, or infinity for no limit";
    case Range::kShare:
      return "a share from 0 to 1";
    case Range::kRate:
      return "a number from 0.001 to 1e6";
  }
  return "";
}

}  // namespace

void requireJointNumbers(const std::string& where, const Eigen::Ref<const Eigen::VectorXd>& values,
                         Range range, const std::string& unit,
                         const std::vector<std::string>& joint_names) {
  using inverse_dynamics_solver::errorText;
  using inverse_dynamics_solver::InvalidParameterValueException;

  const auto n = static_cast<Eigen::Index>(joint_names.size());
  if (values.size() != n) {
    throw InvalidParameterValueException(
        where, "wrong size", std::to_string(n) + " numbers [" + unit + "]",
        std::to_string(values.size()),
        "give one for each of the joints " + chain_dynamics::joined(joint_names));
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    if (isWithin(values[j], range)) continue;
    throw InvalidParameterValueException(
        where + ": joint " + joint_names[static_cast<std::size_t>(j)], "wrong value",
        std::string(inWords(range)) + " [" + unit + "]", numberText(values[j]),
        "correct this number");
  }
}

bool areJointNumbers(const Eigen::Ref<const Eigen::VectorXd>& values, Range range,
                     Eigen::Index n) noexcept {
  if (values.size() != n) return false;
  return std::all_of(values.data(), values.data() + n,
                     [range](double value) { return isWithin(value, range); });
}

void requireNumber(const std::string& where, double value, Range range, const std::string& unit) {
  if (isWithin(value, range)) return;
  throw inverse_dynamics_solver::InvalidParameterValueException(
      where, "wrong value", std::string(inWords(range)) + " [" + unit + "]", numberText(value),
      "correct this number");
}

}  // namespace v2
}  // namespace inverse_dynamics_control

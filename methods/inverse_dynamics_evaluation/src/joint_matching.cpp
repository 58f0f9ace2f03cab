// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/joint_matching.hpp"

#include <algorithm>
#include <chain_dynamics/text.hpp>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
JointMatching::JointMatching(std::vector<std::string> joints)
    : joints_(std::move(joints)), columns_(joints_.size()) {}

JointMatching::Found JointMatching::match(const std::vector<std::string>& names) {
  if (names != names_) {
    names_ = names;
    culprits_.clear();
    std::vector<std::string> repeated;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const auto at = std::find(names_.begin(), names_.end(), joints_[j]);
      if (at == names_.end()) {
        culprits_.push_back(joints_[j]);
        continue;
      }
      columns_[j] = static_cast<std::size_t>(at - names_.begin());
      if (std::find(at + 1, names_.end(), joints_[j]) != names_.end()) {
        repeated.push_back(joints_[j]);
      }
    }
    if (culprits_.size() == joints_.size()) {
      found_ = Found::kNone;
    } else if (!culprits_.empty()) {
      found_ = Found::kMissing;
    } else {
      culprits_ = repeated;
      found_ = repeated.empty() ? Found::kAll : Found::kRepeated;
    }
  }
  return found_;
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 20, kLongest = 60;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    text += (i == 0 ? "" : ", ") + chain_dynamics::printable(names[i], kLongest);
  }
  if (names.size() > kMost) text += " and " + std::to_string(names.size() - kMost) + " others";
  return text;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

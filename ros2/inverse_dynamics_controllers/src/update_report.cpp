// SPDX-License-Identifier: Apache-2.0
#include "update_report.hpp"

#include <algorithm>
#include <atomic>
#include <chain_dynamics/text.hpp>
#include <cstddef>
#include <cstdint>
#include <inverse_dynamics_control/reference_guard.hpp>
#include <inverse_dynamics_control/status.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {

using chain_dynamics::joined;
using inverse_dynamics_control::isRefusal;
using inverse_dynamics_control::Status;
using inverse_dynamics_control::StopReason;

namespace {

std::uint64_t maskOf(const UpdateReport::Joints& joints) noexcept {
  std::uint64_t mask = 0;
  for (Eigen::Index j = 0; j < std::min<Eigen::Index>(joints.size(), 64); ++j) {
    if (joints[j]) mask |= std::uint64_t{1} << j;
  }
  return mask;
}

}  // namespace

void UpdateReport::note(Status status, const Joints& saturated,
                        const Joints& rate_limited) noexcept {
  cycles_[static_cast<std::size_t>(status)].fetch_add(1, kRelaxed);
  saturated_.fetch_or(maskOf(saturated), kRelaxed);
  rate_limited_.fetch_or(maskOf(rate_limited), kRelaxed);
}

void UpdateReport::noteStop(StopReason reason, Eigen::Index joint) noexcept {
  stop_joint_.store(static_cast<int>(joint), kRelaxed);
  stop_.store(static_cast<int>(reason), std::memory_order_release);
}

void UpdateReport::noteGivenUp(Status why) noexcept {
  given_up_.store(static_cast<int>(why), kRelaxed);
}

std::string UpdateReport::names(std::uint64_t mask) const {
  std::vector<std::string> names;
  for (std::size_t j = 0; j < std::min<std::size_t>(joints_.size(), 64); ++j) {
    if ((mask >> j & 1U) != 0) names.push_back(joints_[j]);
  }
  return joined(names);
}

std::vector<UpdateReport::Line> UpdateReport::takeLines() {
  std::vector<Line> lines;
  const auto stop = static_cast<StopReason>(stop_.exchange(0, std::memory_order_acquire));
  if (stop != StopReason::kNone) {
    const int joint = stop_joint_.load(kRelaxed);
    const std::string whose =
        joint < 0 ? "" : " (" + joints_[static_cast<std::size_t>(joint)] + ")";
    lines.push_back({true, std::string(text(stop)) + whose +
                               ": stopping; references are ignored until the controller is "
                               "activated again"});
  }
  const auto given_up = static_cast<Status>(given_up_.exchange(0, kRelaxed));
  if (given_up != Status::kOk) {
    lines.push_back({true, std::string(text(given_up)) +
                               ", for longer than tolerated_fault_time: nothing but the safe "
                               "torque until the controller is activated again"});
  }
  for (std::size_t k = 0; k < cycles_.size(); ++k) {
    const auto status = static_cast<Status>(k);
    const std::uint32_t cycles = cycles_[k].exchange(0, kRelaxed);
    if (cycles == 0 || !isRefusal(status)) continue;
    lines.push_back({true, std::string(text(status)) + ": safe torque in " +
                               std::to_string(cycles) + " cycles"});
  }
  if (const std::uint64_t mask = saturated_.exchange(0, kRelaxed)) {
    lines.push_back({false, "effort cut to its limit: " + names(mask)});
  }
  if (const std::uint64_t mask = rate_limited_.exchange(0, kRelaxed)) {
    lines.push_back({false, "effort held back by limits.effort_rate: " + names(mask)});
  }
  if (ramps_.exchange(0, kRelaxed) != 0) {
    lines.push_back({false, std::string(text(StopReason::kStep)) + ": ramped"});
  }
  if (const std::uint32_t times = not_written_.exchange(0, kRelaxed)) {
    lines.push_back({true, "an effort couldn't be written to the hardware in " +
                               std::to_string(times) + " cycles"});
  }
  return lines;
}

}  // namespace inverse_dynamics_controllers

// SPDX-License-Identifier: Apache-2.0
#include "wrench_report.hpp"

#include <cstddef>
#include <cstdint>
#include <inverse_dynamics_control/external_torque_estimator.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_controllers {

using inverse_dynamics_control::EstimateStatus;

void WrenchReport::note(EstimateStatus status, Eigen::Index unseen) noexcept {
  cycles_[static_cast<std::size_t>(status)].fetch_add(1, kRelaxed);
  if (status != EstimateStatus::kOk || unseen <= blind_) return;
  const auto directions = static_cast<std::uint32_t>(unseen);
  unseen_cycles_.fetch_add(1, kRelaxed);
  if (directions > most_unseen_.load(kRelaxed)) most_unseen_.store(directions, kRelaxed);
}

void WrenchReport::noteGivenUp(EstimateStatus why) noexcept {
  given_up_.store(static_cast<int>(why), kRelaxed);
}

std::vector<ReportLine> WrenchReport::takeLines() {
  std::vector<ReportLine> lines;
  const auto given_up = static_cast<EstimateStatus>(given_up_.exchange(0, kRelaxed));
  if (given_up != EstimateStatus::kOk) {
    lines.push_back({true, std::string(text(given_up)) +
                               ", for longer than tolerated_fault_time: no wrench until the "
                               "controller is activated again"});
  }
  for (std::size_t k = 0; k < cycles_.size(); ++k) {
    const auto status = static_cast<EstimateStatus>(k);
    const std::uint32_t cycles = cycles_[k].exchange(0, kRelaxed);
    if (cycles == 0 || status == EstimateStatus::kOk || status == EstimateStatus::kStarting) {
      continue;
    }
    lines.push_back(
        {true, std::string(text(status)) + ": no wrench in " + std::to_string(cycles) + " cycles"});
  }
  const std::uint32_t directions = most_unseen_.exchange(0, kRelaxed);
  if (const std::uint32_t cycles = unseen_cycles_.exchange(0, kRelaxed)) {
    lines.push_back({false, "the joints don't feel " + std::to_string(directions) +
                                " of 6 directions of a wrench, near a singularity, in " +
                                std::to_string(cycles) + " cycles: taken for zero"});
  }
  return lines;
}

}  // namespace inverse_dynamics_controllers

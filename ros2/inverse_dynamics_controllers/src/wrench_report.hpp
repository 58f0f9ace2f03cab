// SPDX-License-Identifier: Apache-2.0
/// @file
/// Counts what happens to the estimates of wrenches; another thread logs it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <inverse_dynamics_control/external_torque_estimator.hpp>
#include <vector>

#include "report_log.hpp"

namespace inverse_dynamics_controllers {

/// Counts what the loop's estimates ended with. Real time: all but takeLines(): no allocation, lock,
/// exception or system call.
class WrenchReport {
 public:
  using EstimateStatus = inverse_dynamics_control::EstimateStatus;

  /// @param joints  n: fewer than six never feel 6 - n directions, which isn't worth a line.
  explicit WrenchReport(Eigen::Index joints) noexcept : blind_(joints < 6 ? 6 - joints : 0) {}

  /// A cycle's end.
  ///
  /// @param unseen  directions of a wrench that the joints don't feel.
  void note(EstimateStatus status, Eigen::Index unseen) noexcept;

  /// The controller gives up: no estimate until it is activated again.
  void noteGivenUp(EstimateStatus why) noexcept;

  /// Events since the last call. Allocates.
  std::vector<ReportLine> takeLines();

 private:
  Eigen::Index blind_;
  std::array<std::atomic<std::uint32_t>, 8> cycles_{};  // by EstimateStatus
  std::atomic<std::uint32_t> unseen_cycles_{0}, most_unseen_{0};
  std::atomic<int> given_up_{0};
};

}  // namespace inverse_dynamics_controllers

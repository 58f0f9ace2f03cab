// SPDX-License-Identifier: Apache-2.0
/// @file
/// Counts what happens in the control loop; another thread logs it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <inverse_dynamics_control/output_stage.hpp>
#include <inverse_dynamics_control/reference_guard.hpp>
#include <inverse_dynamics_control/status.hpp>
#include <string>
#include <utility>
#include <vector>

#include "report_log.hpp"

namespace inverse_dynamics_controllers {

/// Counts what the loop's updates ended with, joint by joint (of the first 64).
class UpdateReport {
 public:
  using Joints = inverse_dynamics_control::OutputStage::Joints;

  using Line = ReportLine;

  explicit UpdateReport(std::vector<std::string> joints) : joints_(std::move(joints)) {}

  /// A cycle's end. Real time, as all that follow but takeLines(): no allocation, lock, exception
  /// or system call.
  void note(inverse_dynamics_control::Status status, const Joints& saturated,
            const Joints& rate_limited) noexcept;

  /// The reference is followed no longer.
  void noteStop(inverse_dynamics_control::StopReason reason, Eigen::Index joint) noexcept;

  /// A reference was too far, and is approached.
  void noteRamp() noexcept { ramps_.fetch_add(1, kRelaxed); }

  /// The controller gives up: nothing but the safe torque from now on.
  void noteGivenUp(inverse_dynamics_control::Status why) noexcept;

  /// An effort couldn't be written to the hardware.
  void noteNotWritten() noexcept { not_written_.fetch_add(1, std::memory_order_relaxed); }

  /// Events since the last call. Allocates.
  std::vector<Line> takeLines();

 private:
  std::string names(std::uint64_t mask) const;

  std::vector<std::string> joints_;
  std::array<std::atomic<std::uint32_t>, 9> cycles_{};  // by Status
  std::atomic<std::uint64_t> saturated_{0}, rate_limited_{0};
  std::atomic<std::uint32_t> not_written_{0}, ramps_{0};
  std::atomic<int> stop_{0}, stop_joint_{-1}, given_up_{0};
};

}  // namespace inverse_dynamics_controllers

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Joint states of a recording, as a Python object.
#pragma once

#include <atomic>
#include <inverse_dynamics_evaluation/joint_log.hpp>
#include <inverse_dynamics_evaluation/joint_state_source.hpp>
#include <memory>
#include <utility>

#include "initialized.hpp"

namespace inverse_dynamics_tools {

/// A source, and the memory of its blocks.
struct JointStates {
  explicit JointStates(std::unique_ptr<inverse_dynamics_evaluation::JointStateSource> given)
      : source(std::move(given)) {}

  std::unique_ptr<inverse_dynamics_evaluation::JointStateSource> source;
  inverse_dynamics_evaluation::JointStateBlock block;
  std::atomic<bool> in_use{false};
};

/// Joint states for one reader at a time: a second one, as in a callback of the first or in another
/// thread, would take messages away from it.
class InUse {
 public:
  /// @throws RecordingError: they are being read.
  explicit InUse(JointStates& states) : states_(states) {
    if (states.in_use.exchange(true)) {
      throw inverse_dynamics_evaluation::RecordingError(
          states.source->where() +
          ": expected one reader at a time, got a second one while the joint states are being "
          "read, "
          "in a callback or another thread; open the recording a second time for it");
    }
  }
  ~InUse() { states_.in_use = false; }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  JointStates& states_;
};

}  // namespace inverse_dynamics_tools

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_tools::JointStates)

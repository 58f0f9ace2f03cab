// SPDX-License-Identifier: Apache-2.0
/// @file
/// Joint states of a recording, as a Python object.
#pragma once

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
};

}  // namespace inverse_dynamics_tools

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_tools::JointStates)

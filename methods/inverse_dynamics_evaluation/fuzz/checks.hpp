// SPDX-License-Identifier: Apache-2.0

/// @file
/// What the fuzz targets of this directory share.

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "../test/joint_state_block.hpp"

namespace inverse_dynamics_evaluation::fuzz {

/// Ends the program, as a finding, unless a condition holds.
void require(bool condition, const char* what, const std::string& detail = "");

/// The text of an error names `where` at its beginning, is short and fit for a terminal.
void requireText(const std::string& text, const std::string& where);

/// Whether all that two blocks hold is the same, to the bit.
bool isSame(const JointStateBlock& a, const JointStateBlock& b);

/// Inputs to begin with.
using Seeds = std::vector<std::vector<std::uint8_t>>;

/// Writes seeds and ends the program where its arguments are `--seeds DIRECTORY`.
void writeSeedsIfAsked(int argc, char** argv, Seeds (*seeds)());

}  // namespace inverse_dynamics_evaluation::fuzz

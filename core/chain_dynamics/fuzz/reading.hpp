// SPDX-License-Identifier: Apache-2.0

/// @file
/// What is required of every robot that a file gives, and of every error about one.

#pragma once

#include <string>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/model.hpp"
#include "equal_kernels.hpp"

namespace chain_dynamics::fuzz {

/// Some state for n joints.
State someState(Eigen::Index n);

/// Whether the fast kernels take the robot and its numbers are below 1e6: beyond it squares and
/// products of them leave the range of double.
bool isModerate(const Model& model);

/// The text of an error isn't empty and names `where`; ends the program otherwise.
void requireText(const ModelError& error, const std::string& where);

}  // namespace chain_dynamics::fuzz

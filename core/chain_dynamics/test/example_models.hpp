// SPDX-License-Identifier: Apache-2.0

/// @file
/// Models of every kind that the fast kernels tell apart.
///
///     for (const auto& [name, model] : models()) { ... }

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/model_file.hpp"
#include "chain_dynamics/urdf.hpp"
#include "random_chains.hpp"
#include "reference.hpp"

namespace chain_dynamics::test {

using Eigen::Index;

std::string robotFile(const std::string& name);

/// The same joints and links, all turning.
Chain revolute(const Chain& chain);

/// Placements with right angles, parallel and intersecting axes: robots as they are built.
Chain rightAngled(Index n, std::uint32_t seed, bool sliding);

/// Identified models with parameters of any sign: for each row, for gravity.
Model identified(const Chain& chain, bool rows, bool gravity, std::uint32_t seed);

/// The same with friction that depends on load, on velocity (Stribeck), on both, and on neither.
Model withChangingSteps(Model model, std::uint32_t seed);

/// The same with springs at all joints that aren't continuous, but the second.
Model withSprings(Model model);

struct NamedModel {
  std::string name;
  Model model;
};

std::vector<NamedModel> models();

}  // namespace chain_dynamics::test

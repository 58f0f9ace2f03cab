// SPDX-License-Identifier: Apache-2.0
/// @file
/// Model files: by name from the package inverse_dynamics_robots, or by path.
///
///     auto model = readModel("ur10_identified");         // share/inverse_dynamics_robots/models/
///     auto model = readModel("calibration/ur10.yaml");   // a file of one's own
#pragma once

#include <string>
#include <vector>

#include "chain_dynamics/model.hpp"

namespace rigid_body_inverse_dynamics_solver {
inline namespace v2 {

/// Names of the models that the installed package inverse_dynamics_robots brings, sorted.
///
/// Throws inverse_dynamics_solver::Exception: the package isn't there.
std::vector<std::string> installedModels();

/// A model, by name or path.
///
/// @param name_or_path  what ends in .yaml or .yml, or has a directory, is a path (from the working
///     directory); anything else is one of installedModels().
/// Throws inverse_dynamics_solver::Exception: no such model, and which there are; or the file's
/// mistake with line and key.
chain_dynamics::Model readModel(const std::string& name_or_path);

}  // namespace v2
}  // namespace rigid_body_inverse_dynamics_solver

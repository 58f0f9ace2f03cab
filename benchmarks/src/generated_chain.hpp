// SPDX-License-Identifier: Apache-2.0

/// @file
/// Chains that nobody built: any number of joints, axes at any angle to one another.
#pragma once

#include <string>

namespace inverse_dynamics_benchmarks {

enum class Joints { kTurning, kTurningAndSliding };

/// URDF of a chain in general position, the same text on every machine: every third joint slides if
/// asked for, each link is a box of 1 to 5 kg lying anyhow.
std::string generatedChain(int joints, Joints kind);

}  // namespace inverse_dynamics_benchmarks

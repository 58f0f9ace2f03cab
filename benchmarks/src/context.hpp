// SPDX-License-Identifier: Apache-2.0

/// @file
/// What a measurement depends on.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace inverse_dynamics_benchmarks {

/// Processor, compiler with its flags, instruction set of the fast kernels, versions of the other
/// libraries that this program was built with: names with texts.
std::vector<std::pair<std::string, std::string>> measurementContext();

}  // namespace inverse_dynamics_benchmarks

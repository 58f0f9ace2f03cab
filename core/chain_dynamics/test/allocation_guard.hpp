// SPDX-License-Identifier: Apache-2.0

/// @file
/// The guard of the conformance suite, which needs no library.
#pragma once

#include <inverse_dynamics_solver/conformance/allocation_guard.hpp>

namespace chain_dynamics::test {

using inverse_dynamics_solver::conformance::AllocationGuard;
using inverse_dynamics_solver::conformance::kAllocationGuardWorks;

}  // namespace chain_dynamics::test

// SPDX-License-Identifier: Apache-2.0
/// @file
/// ur10_inverse_dynamics_solver.hpp under the name that it had in the reference implementation's first release, 0.1.1.
#pragma once

#include "ur10_inverse_dynamics_solver/ur10_inverse_dynamics_solver.hpp"

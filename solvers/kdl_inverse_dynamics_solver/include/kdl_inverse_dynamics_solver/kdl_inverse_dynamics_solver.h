// SPDX-License-Identifier: Apache-2.0
/// @file
/// kdl_inverse_dynamics_solver.hpp under the name that it had in the reference implementation's first release, 0.1.1.
#pragma once

#include "kdl_inverse_dynamics_solver/kdl_inverse_dynamics_solver.hpp"

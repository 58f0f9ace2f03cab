// SPDX-License-Identifier: Apache-2.0
/// @file
/// exceptions.hpp under the name that it had in the reference implementation's first release, 0.1.1.
#pragma once

#include "inverse_dynamics_solver/exceptions.hpp"

// SPDX-License-Identifier: Apache-2.0
#include <inverse_dynamics_solver/plugin.hpp>

#include "pinocchio_inverse_dynamics_solver/pinocchio_inverse_dynamics_solver.hpp"

INVERSE_DYNAMICS_SOLVER_EXPORT_PLUGIN(
    pinocchio_inverse_dynamics_solver::InverseDynamicsSolverPinocchio)

// SPDX-License-Identifier: Apache-2.0
#include <inverse_dynamics_solver/plugin.hpp>

#include "franka_inria_inverse_dynamics_solver/franka_inria_inverse_dynamics_solver.hpp"

INVERSE_DYNAMICS_SOLVER_EXPORT_PLUGIN(
    franka_inria_inverse_dynamics_solver::InverseDynamicsSolverFrankaInria)

// SPDX-License-Identifier: Apache-2.0
#include <inverse_dynamics_solver/plugin.hpp>

#include "pendulum_inverse_dynamics_solver/pendulum_inverse_dynamics_solver.hpp"

INVERSE_DYNAMICS_SOLVER_EXPORT_PLUGIN(
    pendulum_inverse_dynamics_solver::InverseDynamicsSolverPendulum)

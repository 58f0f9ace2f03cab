// SPDX-License-Identifier: Apache-2.0
#include <inverse_dynamics_solver/plugin.hpp>

#include "ur10_inverse_dynamics_solver/ur10_inverse_dynamics_solver.hpp"

INVERSE_DYNAMICS_SOLVER_EXPORT_PLUGIN(ur10_inverse_dynamics_solver::InverseDynamicsSolverUR10)

// SPDX-License-Identifier: Apache-2.0
#include <inverse_dynamics_solver/plugin.hpp>

#include "kdl_inverse_dynamics_solver/kdl_inverse_dynamics_solver.hpp"

INVERSE_DYNAMICS_SOLVER_EXPORT_PLUGIN(kdl_inverse_dynamics_solver::InverseDynamicsSolverKDL)

// SPDX-License-Identifier: Apache-2.0
#include <inverse_dynamics_solver/plugin.hpp>

#include "rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp"

INVERSE_DYNAMICS_SOLVER_EXPORT_PLUGIN(
    rigid_body_inverse_dynamics_solver::InverseDynamicsSolverRigidBody)

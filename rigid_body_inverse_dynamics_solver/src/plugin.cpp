// SPDX-License-Identifier: Apache-2.0
#include <pluginlib/class_list_macros.hpp>

#include "rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp"

PLUGINLIB_EXPORT_CLASS(rigid_body_inverse_dynamics_solver::InverseDynamicsSolverRigidBody,
                       inverse_dynamics_solver::InverseDynamicsSolver)

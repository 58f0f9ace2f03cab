// SPDX-License-Identifier: Apache-2.0
#include <pluginlib/class_list_macros.hpp>

#include "pinocchio_inverse_dynamics_solver/pinocchio_inverse_dynamics_solver.hpp"

PLUGINLIB_EXPORT_CLASS(pinocchio_inverse_dynamics_solver::InverseDynamicsSolverPinocchio,
                       inverse_dynamics_solver::InverseDynamicsSolver)

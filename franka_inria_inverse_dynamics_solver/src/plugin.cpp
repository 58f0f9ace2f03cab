// SPDX-License-Identifier: Apache-2.0
#include <pluginlib/class_list_macros.hpp>

#include "franka_inria_inverse_dynamics_solver/franka_inria_inverse_dynamics_solver.hpp"

PLUGINLIB_EXPORT_CLASS(franka_inria_inverse_dynamics_solver::InverseDynamicsSolverFrankaInria,
                       inverse_dynamics_solver::InverseDynamicsSolver)

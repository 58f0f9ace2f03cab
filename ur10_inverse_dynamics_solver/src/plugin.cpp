// SPDX-License-Identifier: Apache-2.0
#include <pluginlib/class_list_macros.hpp>

#include "ur10_inverse_dynamics_solver/ur10_inverse_dynamics_solver.hpp"

PLUGINLIB_EXPORT_CLASS(ur10_inverse_dynamics_solver::InverseDynamicsSolverUR10,
                       inverse_dynamics_solver::InverseDynamicsSolver)

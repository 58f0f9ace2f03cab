// SPDX-License-Identifier: Apache-2.0
#include <pluginlib/class_list_macros.hpp>

#include "kdl_inverse_dynamics_solver/kdl_inverse_dynamics_solver.hpp"

PLUGINLIB_EXPORT_CLASS(kdl_inverse_dynamics_solver::InverseDynamicsSolverKDL,
                       inverse_dynamics_solver::InverseDynamicsSolver)

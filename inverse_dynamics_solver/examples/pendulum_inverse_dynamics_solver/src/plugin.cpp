// SPDX-License-Identifier: Apache-2.0
#include <pluginlib/class_list_macros.hpp>

#include "pendulum_inverse_dynamics_solver/pendulum_inverse_dynamics_solver.hpp"

PLUGINLIB_EXPORT_CLASS(pendulum_inverse_dynamics_solver::InverseDynamicsSolverPendulum,
                       inverse_dynamics_solver::InverseDynamicsSolver)

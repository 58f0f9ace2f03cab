// SPDX-License-Identifier: Apache-2.0
/// @file
/// Registers plugins in a library that is built without ROS, by the macro of pluginlib.
///
///     PLUGINLIB_EXPORT_CLASS(my_package::MySolver, inverse_dynamics_solver::InverseDynamicsSolver)
#pragma once

#include <inverse_dynamics_solver/plugin.hpp>

#define PLUGINLIB_EXPORT_CLASS(Derived, Base) INVERSE_DYNAMICS_SOLVER_REGISTER_(Derived, Base)

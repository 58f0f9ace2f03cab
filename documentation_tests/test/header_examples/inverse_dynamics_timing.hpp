// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the examples of inverse_dynamics_timing take for granted. Compiled, never linked.
#pragma once

#include <Eigen/Core>
#include <inverse_dynamics_timing/retime.hpp>
#include <memory>
#include <stdexcept>

using namespace inverse_dynamics_solver;
using namespace inverse_dynamics_timing;

namespace given {

extern const std::shared_ptr<InverseDynamicsSolver> solver;
extern const Trajectory trajectory;
extern Eigen::VectorXd q, qd, qdd;

// What means something else in each header.
namespace retime_examples {
extern const Eigen::MatrixXd waypoints;
extern const double t;
}  // namespace retime_examples

}  // namespace given

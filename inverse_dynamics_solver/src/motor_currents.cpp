// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/motor_currents.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

// Out of line, so that there is one type information for dynamic_cast across plugin libraries.
MotorCurrents::~MotorCurrents() = default;

}  // namespace v2
}  // namespace inverse_dynamics_solver

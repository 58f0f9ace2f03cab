// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/motor_currents.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

MotorCurrents::~MotorCurrents() = default;

MotorCurrents::Gains MotorCurrents::gains(const char* method) const {
  jointsFor(method);
  return driveGains();
}

void MotorCurrents::getCurrents(const ConstVectorRef& q, const ConstVectorRef& qd,
                                const ConstVectorRef& qdd, VectorRef i) const {
  const Gains K = gains("getCurrents");
  torqueSolver().getTorques(q, qd, qdd, i);  // checks the arguments
  i.array() /= K.array();
}

}  // namespace v2
}  // namespace inverse_dynamics_solver

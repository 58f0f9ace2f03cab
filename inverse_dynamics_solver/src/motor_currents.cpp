// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/motor_currents.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

// Out of line, so that there is one type information for dynamic_cast across plugin libraries.
MotorCurrents::~MotorCurrents() = default;

MotorCurrents::Gains MotorCurrents::gains(const char* method) const {
  jointsFor(method);
  return driveGains();
}

// The current of each term is its torque divided by the gain of its joint, i = K^-1 tau. The
// solver's methods check the arguments.

void MotorCurrents::getCurrents(const ConstVectorRef& q, const ConstVectorRef& qd,
                                const ConstVectorRef& qdd, VectorRef i) const {
  const Gains K = gains("getCurrents");
  torqueSolver().getTorques(q, qd, qdd, i);
  i.array() /= K.array();
}

void MotorCurrents::getInertiaCurrents(const ConstVectorRef& q, MatrixRef i) const {
  const Gains K = gains("getInertiaCurrents");
  torqueSolver().getInertiaMatrix(q, i);
  i.array().colwise() /= K.array();
}

void MotorCurrents::getCoriolisCurrents(const ConstVectorRef& q, const ConstVectorRef& qd,
                                        VectorRef i) const {
  const Gains K = gains("getCoriolisCurrents");
  torqueSolver().getCoriolisVector(q, qd, i);
  i.array() /= K.array();
}

void MotorCurrents::getGravityCurrents(const ConstVectorRef& q, VectorRef i) const {
  const Gains K = gains("getGravityCurrents");
  torqueSolver().getGravityVector(q, i);
  i.array() /= K.array();
}

void MotorCurrents::getFrictionCurrents(const ConstVectorRef& q, const ConstVectorRef& qd,
                                        VectorRef i) const {
  const Gains K = gains("getFrictionCurrents");
  torqueSolver().getFrictionVector(q, qd, i);
  i.array() /= K.array();
}

}  // namespace v2
}  // namespace inverse_dynamics_solver

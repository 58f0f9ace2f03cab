// SPDX-License-Identifier: Apache-2.0

/// @file
/// What is computed of one state, from its numbers in memory.
///
/// Included by kernels.cpp only [pack.hpp].

#pragma once

#include "friction.hpp"
#include "linear_solve.hpp"
#include "regressor.hpp"
#include "turns.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

void torquesOfState(const Robot& robot, int structure, const double* q, const double* qd,
                    const double* qdd, double* tau) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  if (robot.friction == nullptr) {
    torquesOf(robot, structure, State<double>{c.values, s.values, q, qd, qdd}, tau);
    return;
  }
  JointNumbers f;
  if (robot.changing_steps) {
    const State<double> state{c.values, s.values, q, qd, qdd};
    changingFriction(robot, structure, state, f.values);
  } else {
    frictionNumbers(robot, qd, f.values);
  }
  torquesOf(robot, structure, State<double>{c.values, s.values, q, qd, qdd}, tau);
  for (int i = 0; i < robot.joints; ++i) tau[i] += f.values[i];
}

void coriolisOfState(const Robot& robot, int structure, const double* q, const double* qd,
                     double* coriolis) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  leaveOutFirst(c.values, s.values);
  const State<double> state{c.values, s.values, q, qd, kAtRest};
  recursionsOf<double>(structure).torques(robot, state, kNoGravity, coriolis);
}

void gravityOfState(const Robot& robot, int structure, const double* q, double* g) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, nullptr, nullptr};
  recursionsOf<double>(structure).gravity(robot, state, g);
}

void inertiaOfState(const Robot& robot, int structure, const double* q, Matrices H) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, nullptr, nullptr};
  const Entries<double> entries{H.data, H.row_step, H.column_step};
  recursionsOf<double>(structure).inertia(robot, state, entries);
}

void componentsOfState(const Robot& robot, int structure, const double* q, const double* qd,
                       Matrices H, double* coriolis, double* g) {
  JointNumbers c;
  JointNumbers s;
  JointNumbers gravity;  // may stand where the state does
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, qd, kAtRest};
  const Recursions<double>& recursions = recursionsOf<double>(structure);
  recursions.inertia(robot, state, Entries<double>{H.data, H.row_step, H.column_step});
  recursions.gravity(robot, state, gravity.values);
  leaveOutFirst(c.values, s.values);
  recursions.torques(robot, state, kNoGravity, coriolis);
  for (int i = 0; i < robot.joints; ++i) g[i] = gravity.values[i];
}

FAST_APART void changingFrictionOfState(const Robot& robot, int structure, const double* q,
                                        const double* qd, double* f) {
  JointNumbers c;
  JointNumbers s;
  if (robot.load_friction) turnsOfState(robot, q, c.values, s.values);
  changingFriction(robot, structure, State<double>{c.values, s.values, q, qd, nullptr}, f);
}

void frictionOfState(const Robot& robot, int structure, const double* q, const double* qd,
                     double* f) {
  if (robot.friction == nullptr) {
    for (int i = 0; i < robot.joints; ++i) f[i] = 0.0 * qd[i];  // keeps a NaN
    return;
  }
  JointNumbers numbers;
  if (robot.changing_steps) {
    changingFrictionOfState(robot, structure, q, qd, numbers.values);
  } else {
    frictionNumbers(robot, qd, numbers.values);
  }
  for (int i = 0; i < robot.joints; ++i) f[i] = numbers.values[i];
}

void forwardDynamicsOfState(const Robot& robot, int structure, const double* q, const double* qd,
                            const double* tau, double* qdd) {
  const int n = robot.joints;
  JointNumbers c;
  JointNumbers s;
  JointNumbers bias;
  double H[kMaxJoints * kMaxJoints];
  double accelerating[kMaxJoints];
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, qd, kAtRest};
  torquesOf(robot, structure, state, bias.values);
  for (int i = 0; i < n; ++i) accelerating[i] = tau[i] - bias.values[i];
  if (robot.friction != nullptr) {
    if (robot.changing_steps) {
      changingFriction(robot, structure, state, bias.values);
    } else {
      frictionNumbers(robot, qd, bias.values);
    }
    for (int i = 0; i < n; ++i) accelerating[i] -= bias.values[i];
  }
  recursionsOf<double>(structure).inertia(robot, state, Entries<double>{H, n, 1});
  (robot.rows != nullptr ? solveGeneral : solveSymmetric<double>)(n, H, accelerating);
  for (int i = 0; i < n; ++i) qdd[i] = accelerating[i];
}

void regressorOfState(const Robot& robot, const double* q, const double* qd, const double* qdd,
                      double* Y, std::ptrdiff_t outer_step) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  regressor(robot, State<double>{c.values, s.values, q, qd, qdd}, Y, outer_step);
}

void torqueDerivativesOfState(const Robot& robot, int structure, const double* q, const double* qd,
                              const double* qdd, double* by_q, double* by_qd, double* by_qdd,
                              std::ptrdiff_t outer_step) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, qd, qdd};
  const DerivativeEntries<double> entries{by_q, by_qd, by_qdd, outer_step};
  derivativesOf(robot, structure, state, entries);
  if (robot.changing_steps) {
    addChangingFrictionDerivatives(robot, structure, state, entries);
  } else if (robot.friction != nullptr) {
    frictionSlopes(robot, qd, c.values);
    for (int i = 0; i < robot.joints; ++i) by_qd[i + i * outer_step] += c.values[i];
  }
}

void coriolisMatrixOfState(const Robot& robot, int structure, const double* q, const double* qd,
                           double* C, std::ptrdiff_t outer_step) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, qd, nullptr};
  coriolisMatrixOf<double>(robot, structure)(robot, state, C, outer_step);
}

void tipPoseOfState(const Robot& robot, int structure, const double* q, double* R, double* p) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, nullptr, nullptr};
  tipKinematicsOf<double>(structure).pose(robot, state, R, p);
}

void tipJacobianOfState(const Robot& robot, int structure, const double* q, double* J,
                        std::ptrdiff_t outer_step) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, nullptr, nullptr};
  tipKinematicsOf<double>(structure).jacobian(robot, state, JacobianEntries<double>{J, outer_step});
}

void tipJacobianDerivativeOfState(const Robot& robot, int structure, const double* q,
                                  const double* qd, double* dJ, std::ptrdiff_t outer_step) {
  JointNumbers c;
  JointNumbers s;
  turnsOfState(robot, q, c.values, s.values);
  const State<double> state{c.values, s.values, q, qd, nullptr};
  tipKinematicsOf<double>(structure).jacobian_derivative(robot, state,
                                                         JacobianEntries<double>{dJ, outer_step});
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics

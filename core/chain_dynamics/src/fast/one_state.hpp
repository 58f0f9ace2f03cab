// SPDX-License-Identifier: Apache-2.0

/// @file
/// What is computed of one state, from its numbers in memory.
///
/// Included by kernels.cpp only [pack.hpp].

#pragma once

#include <cstddef>

#include "friction.hpp"
#include "linear_solve.hpp"
#include "regressor.hpp"
#include "turns.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// A state with cosine and sine of its joints.
struct TurnedState {
  JointNumbers c, s;
  State<double> state;

  FAST_INLINE TurnedState(const Robot& robot, const double* q, const double* qd = nullptr,
                          const double* qdd = nullptr)
      : state{c.values, s.values, q, qd, qdd} {
    turnsOfState(robot, q, c.values, s.values);
  }
};

void torquesOfState(const Robot& robot, int structure, const double* q, const double* qd,
                    const double* qdd, double* tau) {
  const TurnedState x(robot, q, qd, qdd);
  if (robot.friction == nullptr) return torquesOf(robot, structure, x.state, tau);
  JointNumbers f;  // first: tau may stand where the state does
  frictionOfJoints(robot, structure, x.state, f.values);
  torquesOf(robot, structure, x.state, tau);
  for (int i = 0; i < robot.joints; ++i) tau[i] += f.values[i];
}

void coriolisOfState(const Robot& robot, int structure, const double* q, const double* qd,
                     double* coriolis) {
  TurnedState x(robot, q, qd, kAtRest);
  leaveOutFirst(x.c.values, x.s.values);
  recursionsOf<double>(structure).torques(robot, x.state, kNoGravity, coriolis);
}

void gravityOfState(const Robot& robot, int structure, const double* q, double* g) {
  recursionsOf<double>(structure).gravity(robot, TurnedState(robot, q).state, g);
}

void inertiaOfState(const Robot& robot, int structure, const double* q, Matrices H) {
  const Entries<double> entries{H.data, H.row_step, H.column_step};
  recursionsOf<double>(structure).inertia(robot, TurnedState(robot, q).state, entries);
}

void componentsOfState(const Robot& robot, int structure, const double* q, const double* qd,
                       Matrices H, double* coriolis, double* g) {
  TurnedState x(robot, q, qd, kAtRest);
  JointNumbers gravity;  // may stand where the state does
  const Recursions<double>& recursions = recursionsOf<double>(structure);
  recursions.inertia(robot, x.state, Entries<double>{H.data, H.row_step, H.column_step});
  recursions.gravity(robot, x.state, gravity.values);
  leaveOutFirst(x.c.values, x.s.values);
  recursions.torques(robot, x.state, kNoGravity, coriolis);
  for (int i = 0; i < robot.joints; ++i) g[i] = gravity.values[i];
}

FAST_APART void loadedFriction(const Robot& robot, int structure, const double* q, const double* qd,
                               double* f) {
  frictionOfJoints(robot, structure, TurnedState(robot, q, qd).state, f);
}

void frictionOfState(const Robot& robot, int structure, const double* q, const double* qd,
                     double* f) {
  if (robot.friction == nullptr) {
    for (int i = 0; i < robot.joints; ++i) f[i] = 0.0 * qd[i];  // keeps a NaN
    return;
  }
  JointNumbers numbers;
  if (robot.load_friction) {
    loadedFriction(robot, structure, q, qd, numbers.values);
  } else {
    const State<double> without_positions{nullptr, nullptr, nullptr, qd, nullptr};
    frictionOfJoints(robot, structure, without_positions, numbers.values);
  }
  for (int i = 0; i < robot.joints; ++i) f[i] = numbers.values[i];
}

void forwardDynamicsOfState(const Robot& robot, int structure, const double* q, const double* qd,
                            const double* tau, double* qdd) {
  const int n = robot.joints;
  const TurnedState x(robot, q, qd, kAtRest);
  JointNumbers bias;
  double H[kMaxJoints * kMaxJoints];
  double accelerating[kMaxJoints];
  torquesOf(robot, structure, x.state, bias.values);
  for (int i = 0; i < n; ++i) accelerating[i] = tau[i] - bias.values[i];
  if (robot.friction != nullptr) {
    frictionOfJoints(robot, structure, x.state, bias.values);
    for (int i = 0; i < n; ++i) accelerating[i] -= bias.values[i];
  }
  recursionsOf<double>(structure).inertia(robot, x.state, Entries<double>{H, n, 1});
  (robot.rows != nullptr ? solveGeneral : solveSymmetric<double>)(n, H, accelerating);
  for (int i = 0; i < n; ++i) qdd[i] = accelerating[i];
}

void regressorOfState(const Robot& robot, const double* q, const double* qd, const double* qdd,
                      double* Y, std::ptrdiff_t outer_step) {
  regressor(robot, TurnedState(robot, q, qd, qdd).state, Y, outer_step);
}

void torqueDerivativesOfState(const Robot& robot, int structure, const double* q, const double* qd,
                              const double* qdd, double* by_q, double* by_qd, double* by_qdd,
                              std::ptrdiff_t outer_step) {
  const TurnedState x(robot, q, qd, qdd);
  const DerivativeEntries<double> entries{by_q, by_qd, by_qdd, outer_step};
  derivativesOf(robot, structure, x.state, entries);
  if (robot.changing_steps) {
    addChangingFrictionDerivatives(robot, structure, x.state, entries);
  } else if (robot.friction != nullptr) {
    JointNumbers slopes;
    frictionSlopes(robot, qd, slopes.values);
    for (int i = 0; i < robot.joints; ++i) by_qd[i + i * outer_step] += slopes.values[i];
  }
}

void coriolisMatrixOfState(const Robot& robot, int structure, const double* q, const double* qd,
                           double* C, std::ptrdiff_t outer_step) {
  const TurnedState x(robot, q, qd);
  coriolisMatrixOf<double>(robot, structure)(robot, x.state, C, outer_step);
}

void tipPoseOfState(const Robot& robot, int structure, const double* q, double* R, double* p) {
  tipKinematicsOf<double>(structure).pose(robot, TurnedState(robot, q).state, R, p);
}

void tipJacobianOfState(const Robot& robot, int structure, const double* q, double* J,
                        std::ptrdiff_t outer_step) {
  tipKinematicsOf<double>(structure).jacobian(robot, TurnedState(robot, q).state, {J, outer_step});
}

void tipJacobianDerivativeOfState(const Robot& robot, int structure, const double* q,
                                  const double* qd, double* dJ, std::ptrdiff_t outer_step) {
  tipKinematicsOf<double>(structure).jacobian_derivative(robot, TurnedState(robot, q, qd).state,
                                                         {dJ, outer_step});
}

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics

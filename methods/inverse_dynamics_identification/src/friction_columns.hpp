// SPDX-License-Identifier: Apache-2.0
/// @file
/// Own columns of a fit at one sample, or at many of one joint: numbers or arrays of them.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <utility>

#include "inverse_dynamics_identification/friction_step.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

/// Coefficients that a law is linear in, and their columns.
constexpr std::pair<Eigen::Index, double StepFriction::*> kLinear[] = {
    {own_column::kVelocity, &StepFriction::fv}, {own_column::kOne, &StepFriction::fo},
    {own_column::kStep, &StepFriction::fc},     {own_column::kLoad, &StepFriction::fl},
    {own_column::kStribeck, &StepFriction::fs}, {own_column::kMemory, &StepFriction::fm}};

/// z and u [chain_dynamics/friction_state.hpp], and their derivatives by log(distance).
template <typename Values>
struct PreslidingValues {
  Values z, unknown, z_by_distance, unknown_by_distance;
};

/// tanh(x), with an error of 1e-16 of one, in a third of the time.
template <typename Values>
Values smoothStep(const Values& x) {
  using std::exp;
  return 1.0 - 2.0 / (1.0 + exp(2.0 * x));
}

/// column(c): where column c goes, of the first `count` ones.
template <typename Values, typename Column>
void frictionColumns(const StepFriction& law, const Values& qd, const Values& qdd,
                     const Values& load, const PreslidingValues<Values>& memory, Eigen::Index count,
                     const Column& column) {
  using std::exp;
  const Values x = (qd + law.shift) / law.width;
  const Values step = smoothStep(x);
  Values height = law.fc + law.fl * load;  // of the step
  Values lagging = 0.0 * qd;               // of what may lag behind it
  if (count > own_column::kStribeck) {
    const bool remembers = count > own_column::kMemory;
    const Values acting = remembers ? Values(memory.z + memory.unknown * step) : step;
    const Values v = qd / law.vs;
    const Values falling = exp(-v * v);
    lagging = law.fs * falling;
    column(own_column::kStribeck) = falling * acting;
    column(own_column::kStribeckVelocity) = law.fs * 2.0 * v * v * falling * acting;
    if (remembers) {
      lagging += law.fm;
      column(own_column::kMemory) = acting;
      column(own_column::kDistance) =
          lagging * (memory.z_by_distance + memory.unknown_by_distance * step);
      lagging *= memory.unknown;
    }
  }
  if (count > own_column::kLoad) column(own_column::kLoad) = load * step;
  const Values slope = (height + lagging) * (1.0 - step * step);
  column(own_column::kAcceleration) = qdd;
  column(own_column::kVelocity) = qd;
  column(own_column::kOne) = 0.0 * qd + 1.0;
  column(own_column::kStep) = step;
  column(own_column::kShift) = slope / law.width;
  column(own_column::kWidth) = -slope * x;
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

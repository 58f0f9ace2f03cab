// SPDX-License-Identifier: Apache-2.0

/// @file
/// Springs of a model, of one coordinate at a time.

#pragma once

#include <cmath>

#include "chain_dynamics/model.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Coordinates, or none where there are no springs.
inline Eigen::Index springCount(const Model& model) {
  return model.stiffness.size() > 0 ? model.stiffness.size() : model.levers.cols();
}

inline bool hasLever(const Model& model, Eigen::Index j) {
  return model.levers.size() > 0 && (model.levers(0, j) != 0 || model.levers(1, j) != 0);
}

/// `k (q - rest) + a sin(q) + b cos(q)`; a NaN of a coordinate without spring goes no further.
template <class Positions>
double springTorque(const Model& model, Eigen::Index j, const Positions& q) {
  double tau = 0;
  if (model.stiffness.size() > 0 && model.stiffness[j] != 0) {
    tau = model.stiffness[j] * (q[j] - model.rest[j]);
  }
  if (hasLever(model, j)) {
    tau += model.levers(0, j) * std::sin(q[j]) + model.levers(1, j) * std::cos(q[j]);
  }
  return tau;
}

/// Its derivative by q.
template <class Positions>
double springSlope(const Model& model, Eigen::Index j, const Positions& q) {
  double slope = model.stiffness.size() > 0 ? model.stiffness[j] : 0;
  if (hasLever(model, j)) {
    slope += model.levers(0, j) * std::cos(q[j]) - model.levers(1, j) * std::sin(q[j]);
  }
  return slope;
}

}  // namespace v2
}  // namespace chain_dynamics

// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/friction_step.hpp"

#include <cmath>

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

double stribeck(const StepFriction& law, double qd) {
  return std::exp(-(qd / law.vs) * (qd / law.vs));
}

}  // namespace

double friction(const StepFriction& law, double qd, double load) {
  const double height = law.fc + law.fl * load + (law.fs != 0 ? law.fs * stribeck(law, qd) : 0.0);
  return law.fv * qd + law.fo + height * std::tanh((qd + law.shift) / law.width);
}

Eigen::Index ownColumns(FrictionTerms terms) {
  switch (terms) {
    case FrictionTerms::kStep:
      return own_column::kLoad;
    case FrictionTerms::kLoad:
      return own_column::kStribeck;
    case FrictionTerms::kStribeck:
      break;
  }
  return own_column::kStribeckVelocity + 1;
}

void ownColumnsAt(const StepFriction& law, double qd, double qdd, double load,
                  Eigen::Ref<Eigen::VectorXd> row) {
  const double x = (qd + law.shift) / law.width;
  const double step = std::tanh(x);
  double height = law.fc + law.fl * load;
  if (row.size() > own_column::kStribeck) {
    const double v = qd / law.vs;
    const double falling = std::exp(-v * v);
    height += law.fs * falling;
    row[own_column::kStribeck] = falling * step;
    row[own_column::kStribeckVelocity] = law.fs * 2 * v * v * falling * step;
  }
  if (row.size() > own_column::kLoad) row[own_column::kLoad] = load * step;
  const double slope = height * (1 - step * step);
  row[own_column::kAcceleration] = qdd;
  row[own_column::kVelocity] = qd;
  row[own_column::kOne] = 1;
  row[own_column::kStep] = step;
  row[own_column::kShift] = slope / law.width;
  row[own_column::kWidth] = -slope * x;
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/friction_step.hpp"

#include <cmath>

#include "friction_columns.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

double stribeck(const StepFriction& law, double qd) {
  return std::exp(-(qd / law.vs) * (qd / law.vs));
}

}  // namespace

double friction(const StepFriction& law, double qd, double load) {
  const double height = law.fc + law.fl * load + (law.fs != 0 ? law.fs * stribeck(law, qd) : 0.0);
  return law.fv * qd + law.fo + height * smoothStep((qd + law.shift) / law.width);
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
  frictionColumns(law, qd, qdd, load, row.size(),
                  [&](Eigen::Index c) -> double& { return row[c]; });
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

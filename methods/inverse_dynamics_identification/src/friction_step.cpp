// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/friction_step.hpp"

#include "friction_columns.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {

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

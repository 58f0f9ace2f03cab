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
      return own_column::kMemory;
    case FrictionTerms::kMemory:
      break;
  }
  return own_column::kDistance + 1;
}

void move(FittedPresliding& memory, double by, const StepFriction& law) {
  // d/dlog(distance) = distance d/ddistance
  auto distance = chain_dynamics::Dual<double, 1>::variable(law.distance, 0);
  distance.derivative[0] = law.distance;
  memory.move(by, distance);
}

void ownColumnsAt(const StepFriction& law, double qd, double qdd, double load,
                  const FittedPresliding& memory, Eigen::Ref<Eigen::VectorXd> row) {
  frictionColumns(law, qd, qdd, load,
                  PreslidingValues<double>{memory.z.value, memory.unknown.value,
                                           memory.z.derivative[0], memory.unknown.derivative[0]},
                  row.size(), [&](Eigen::Index c) -> double& { return row[c]; });
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/torque_deviation.hpp"

#include <chain_dynamics/model.hpp>
#include <vector>

#include "method_call.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

TorqueDeviation::~TorqueDeviation() = default;

bool TorqueDeviation::hasTorqueDeviation() const {
  jointsFor("hasTorqueDeviation");
  return torqueDeviation().size() != 0;
}

void TorqueDeviation::getTorqueDeviation(VectorRef deviation) const {
  MethodCall("getTorqueDeviation", torqueSolver()).vector("deviation", deviation);
  const Deviations known = torqueDeviation();
  if (known.size() == 0) {
    throw Exception("getTorqueDeviation", "not known",
                    "a model that states torque_deviation for each joint", "one without",
                    "identify the robot (ids identify), or ask hasTorqueDeviation() "
                    "first");
  }
  deviation = known;
}

const std::vector<chain_dynamics::SeenRange>& TorqueDeviation::seenRanges() const {
  jointsFor("seenRanges");
  return seenRangesImpl();
}

}  // namespace v2
}  // namespace inverse_dynamics_solver

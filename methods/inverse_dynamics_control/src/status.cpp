// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_control/status.hpp"

namespace inverse_dynamics_control {
inline namespace v2 {

const char* text(Status status) noexcept {
  switch (status) {
    case Status::kOk:
      return "as commanded";
    case Status::kSaturated:
      return "a joint's torque was cut to its effort limit";
    case Status::kRateLimited:
      return "a joint's torque was held back by its rate limit";
    case Status::kNoPeriod:
      return "the period isn't above zero and up to a second: torques with a rate limit are held";
    case Status::kReferenceNotFinite:
      return "the reference isn't finite: safe torque instead";
    case Status::kStateNotFinite:
      return "the measured state isn't finite: safe torque instead";
    case Status::kTorqueNotFinite:
      return "the computed torque isn't finite: safe torque instead";
    case Status::kSolverFailed:
      return "the solver failed: safe torque instead";
    case Status::kWrongSize:
      return "an argument hasn't one number per joint: safe torque instead";
  }
  return "unknown status";
}

}  // namespace v2
}  // namespace inverse_dynamics_control

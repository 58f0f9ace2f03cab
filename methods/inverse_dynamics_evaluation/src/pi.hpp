// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace inverse_dynamics_evaluation {
inline namespace v2 {

constexpr double kPi = 3.14159265358979323846;

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

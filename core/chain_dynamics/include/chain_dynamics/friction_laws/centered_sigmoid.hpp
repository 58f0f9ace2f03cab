// SPDX-License-Identifier: Apache-2.0

/// @file
/// A smooth step that is zero at rest:
/// `f = A / (1 + exp(-alpha (qd + delta))) - A / (1 + exp(-alpha delta))`.

#pragma once

#include <array>

#include "chain_dynamics/friction_laws/coefficients.hpp"
#include "chain_dynamics/friction_laws/sigmoid.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// `f = A / (1 + exp(-alpha (qd + delta))) - A / (1 + exp(-alpha delta))`.
///
/// [Gaz et al. 2019, doi 10.1109/LRA.2019.2931248]
struct CenteredSigmoid {
  double A = 0;      ///< height of the step [N m]
  double alpha = 0;  ///< steepness [s/rad]
  double delta = 0;  ///< shift [rad/s]: the step is at qd = -delta

  static constexpr const char* kName = "centered_sigmoid";
  static constexpr int kSchema = 1;

  static constexpr std::array<Coefficient<CenteredSigmoid>, 3> coefficients() {
    return {{{"A", &CenteredSigmoid::A, true},
             {"alpha", &CenteredSigmoid::alpha, false},
             {"delta", &CenteredSigmoid::delta, false}}};
  }

  FrictionForm form() const {
    FrictionForm form;
    form.A = A;
    form.alpha = alpha;
    form.shift = delta;
    form.center = sigmoid(alpha * delta);
    return form;
  }
};

}  // namespace v2
}  // namespace chain_dynamics

// SPDX-License-Identifier: Apache-2.0

/// @file
/// A smooth step with a viscous part and an offset:
/// `f = fv qd + fo + fc / (1 + exp(-alpha (qd + nu)))`.

#pragma once

#include <array>

#include "chain_dynamics/friction_laws/coefficients.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// `f = fv qd + fo + fc / (1 + exp(-alpha (qd + nu)))`.
///
/// Not zero at rest: the step goes from fo to fo + fc. [Petrone et al. 2025,
/// doi 10.1109/TII.2025.3534415]
struct ViscousOffsetSigmoid {
  double fv = 0;     ///< viscous coefficient [N m s/rad]
  double fo = 0;     ///< offset [N m]
  double fc = 0;     ///< height of the step [N m], of either sign
  double alpha = 0;  ///< steepness [s/rad], of either sign
  double nu = 0;     ///< shift [rad/s]: the step is at qd = -nu

  static constexpr const char* kName = "viscous_offset_sigmoid";
  static constexpr int kSchema = 1;

  static constexpr std::array<Coefficient<ViscousOffsetSigmoid>, 5> coefficients() {
    return {{{"fv", &ViscousOffsetSigmoid::fv, true},
             {"fo", &ViscousOffsetSigmoid::fo, true},
             {"fc", &ViscousOffsetSigmoid::fc, true},
             {"alpha", &ViscousOffsetSigmoid::alpha, false},
             {"nu", &ViscousOffsetSigmoid::nu, false}}};
  }

  FrictionForm form() const {
    FrictionForm form;
    form.fv = fv;
    form.fo = fo;
    form.A = fc;
    form.alpha = alpha;
    form.shift = nu;
    return form;
  }
};

}  // namespace v2
}  // namespace chain_dynamics

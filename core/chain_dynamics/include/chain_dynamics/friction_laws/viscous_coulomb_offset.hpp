// SPDX-License-Identifier: Apache-2.0

/// @file
/// Coulomb friction with a viscous part and an offset: `f = fv qd + fc sign(qd) + fo`.

#pragma once

#include <array>

#include "chain_dynamics/friction_laws/coefficients.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// `f = fv qd + fc sign(qd) + fo`. ViscousCoulombOffset{} is no friction at all.
struct ViscousCoulombOffset {
  double fv = 0;  ///< viscous coefficient [N m s/rad] (prismatic: N s/m)
  double fc = 0;  ///< Coulomb friction [N m] (prismatic: N); zero at qd = 0
  double fo = 0;  ///< offset [N m] (prismatic: N), at rest too

  static constexpr const char* kName = "viscous_coulomb_offset";
  static constexpr int kSchema = 1;

  static constexpr std::array<Coefficient<ViscousCoulombOffset>, 3> coefficients() {
    return {{{"fv", &ViscousCoulombOffset::fv, true},
             {"fc", &ViscousCoulombOffset::fc, true},
             {"fo", &ViscousCoulombOffset::fo, true}}};
  }

  FrictionForm form() const {
    FrictionForm form;
    form.fv = fv;
    form.fc = fc;
    form.fo = fo;
    return form;
  }
};

}  // namespace v2
}  // namespace chain_dynamics

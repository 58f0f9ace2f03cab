// SPDX-License-Identifier: Apache-2.0
/// @file
/// The law smooth_coulomb as a dict of its coefficients, by the keys of the model file.
#pragma once

#include <pybind11/pybind11.h>

#include <chain_dynamics/friction_laws/smooth_coulomb.hpp>
#include <string>

namespace pybind11::detail {

/// Optional coefficients may be absent. A law's load and Stribeck terms are left out if they are zero.
template <>
class type_caster<chain_dynamics::SmoothCoulomb> {
 public:
  PYBIND11_TYPE_CASTER(chain_dynamics::SmoothCoulomb, const_name("dict[str, float]"));

  bool load(handle source, bool /*convert*/) {
    if (!isinstance<dict>(source)) return false;
    const auto numbers = reinterpret_borrow<dict>(source);
    value = {};
    value.vs = 1;  // without a meaning where it is absent
    for (const auto& coefficient : chain_dynamics::SmoothCoulomb::coefficients()) {
      if (numbers.contains(coefficient.name)) {
        value.*coefficient.value = float_(numbers[coefficient.name]);
      } else if (coefficient.required) {
        return false;
      }
    }
    return true;
  }

  static handle cast(const chain_dynamics::SmoothCoulomb& law, return_value_policy /*policy*/,
                     handle /*parent*/) {
    dict numbers;
    for (const auto& coefficient : chain_dynamics::SmoothCoulomb::coefficients()) {
      const std::string name = coefficient.name;
      const bool is_absent =
          (name == "fl" && law.fl == 0) || ((name == "fs" || name == "vs") && law.fs == 0);
      if (!is_absent) numbers[coefficient.name] = law.*coefficient.value;
    }
    return numbers.release();
  }
};

}  // namespace pybind11::detail

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Bodies at the tip of a solver's robot: dictionaries of the arguments of set_payload().
#pragma once

#include <pybind11/pybind11.h>

#include <inverse_dynamics_solver/payload.hpp>
#include <inverse_dynamics_solver/variable_gravity.hpp>
#include <string>

#include "arrays.hpp"

namespace inverse_dynamics_tools {

/// The body of the arguments of set_payload(); None: the default of RigidBody.
///
/// @throws inverse_dynamics_solver::InvalidParameterValueException  an argument that isn't numbers
///     of its shape: center_of_mass (3,), inertia (3, 3) or the 6 numbers ixx ixy ixz iyy iyz izz,
///     frame (4, 4).
inverse_dynamics_solver::RigidBody bodyOf(double mass, const pybind11::object& center_of_mass,
                                          const pybind11::object& inertia,
                                          const pybind11::object& frame);
pybind11::dict dictionaryOf(const inverse_dynamics_solver::RigidBody& body);

/// Three numbers. Throws as bodyOf(); `where` is method and argument.
Eigen::Vector3d vectorOf(const std::string& where, const pybind11::object& numbers);

}  // namespace inverse_dynamics_tools

namespace pybind11::detail {

template <>
struct type_caster<inverse_dynamics_solver::RigidBody> {
  PYBIND11_TYPE_CASTER(inverse_dynamics_solver::RigidBody, const_name("dict[str, typing.Any]"));

  bool load(handle source, bool /*convert*/) {
    if (!isinstance<dict>(source)) return false;
    const auto part = [&source](const char* key) -> object { return source.attr("get")(key); };
    value = inverse_dynamics_tools::bodyOf(part("mass").cast<double>(), part("center_of_mass"),
                                           part("inertia"), part("frame"));
    if (const object tip = part("tip"); !tip.is_none()) value.tip = tip.cast<std::string>();
    return true;
  }
  static handle cast(const inverse_dynamics_solver::RigidBody& body, return_value_policy, handle) {
    return inverse_dynamics_tools::dictionaryOf(body).release();
  }
};

}  // namespace pybind11::detail

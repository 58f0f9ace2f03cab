// SPDX-License-Identifier: Apache-2.0
/// @file
/// Bodies at the tip of a solver's robot, from and to Python.
#pragma once

#include <pybind11/pybind11.h>

#include <inverse_dynamics_solver/payload.hpp>
#include <inverse_dynamics_solver/variable_gravity.hpp>
#include <string>

namespace inverse_dynamics_tools {

/// The body of the arguments of set_payload(); None: the default of RigidBody.
///
/// @throws inverse_dynamics_solver::InvalidParameterValueException  an argument that isn't numbers
///     of its shape: center_of_mass (3,), inertia (3, 3) or the 6 numbers ixx ixy ixz iyy iyz izz,
///     frame (4, 4).
inverse_dynamics_solver::RigidBody bodyOf(double mass, const pybind11::object& center_of_mass,
                                          const pybind11::object& inertia,
                                          const pybind11::object& frame);

/// A dictionary of the arguments of set_payload().
pybind11::dict dictionaryOf(const inverse_dynamics_solver::RigidBody& body);

/// Three numbers. Throws as bodyOf(); `where` is method and argument.
Eigen::Vector3d vectorOf(const std::string& where, const pybind11::object& numbers);

/// (3,) numbers.
pybind11::object arrayOf(const Eigen::Vector3d& vector);

/// A capability of the solver.
///
/// @throws inverse_dynamics_solver::Exception  the solver doesn't have it; `what` it is.
template <class Capability>
Capability& capabilityOf(inverse_dynamics_solver::InverseDynamicsSolver& solver,
                         const std::string& method, const std::string& plugin) {
  if (auto* const capability = dynamic_cast<Capability*>(&solver)) return *capability;
  throw inverse_dynamics_solver::Exception(inverse_dynamics_solver::errorText(
      method, "this solver can't", "", plugin,
      "all plugins of this workspace can; see the solver's documentation"));
}

}  // namespace inverse_dynamics_tools

namespace pybind11::detail {

/// Bodies are dictionaries of the arguments of set_payload().
template <>
struct type_caster<inverse_dynamics_solver::RigidBody> {
  PYBIND11_TYPE_CASTER(inverse_dynamics_solver::RigidBody, const_name("dict[str, typing.Any]"));

  bool load(handle source, bool /*convert*/) {
    if (!isinstance<dict>(source)) return false;
    const auto part = [&source](const char* key) -> object { return source.attr("get")(key); };
    value = inverse_dynamics_tools::bodyOf(part("mass").cast<double>(), part("center_of_mass"),
                                           part("inertia"), part("frame"));
    return true;
  }
  static handle cast(const inverse_dynamics_solver::RigidBody& body, return_value_policy, handle) {
    return inverse_dynamics_tools::dictionaryOf(body).release();
  }
};

}  // namespace pybind11::detail

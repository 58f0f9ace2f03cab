// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <inverse_dynamics_solver/payload.hpp>
#include <inverse_dynamics_solver/plausibility.hpp>
#include <inverse_dynamics_solver/variable_gravity.hpp>
#include <string>

#include "arrays.hpp"
#include "solver_class.hpp"
#include "solver_payload.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
namespace ids = inverse_dynamics_solver;

/// A UserWarning, if there is a text.
void warn(const std::string& text) {
  if (!text.empty() && PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) {
    throw py::error_already_set();
  }
}

// A change waits for batches, so setters release the interpreter's lock.
ids::Payloads payloads(const Solver& solver) {
  auto& payload = solver.as<ids::Payload>("payloads");
  return unlocked([&] { return payload.payloads(); });
}

Floats gravity(const Solver& solver) {
  auto& mount = solver.as<ids::VariableGravity>("gravity");
  return arrayOf(unlocked([&] { return mount.gravity(); }));
}

Floats baseAcceleration(const Solver& solver) {
  auto& mount = solver.as<ids::VariableGravity>("base_acceleration");
  return arrayOf(unlocked([&] { return mount.baseAcceleration(); }));
}

void setPayload(const Solver& solver, const std::string& name, double mass,
                const MaybeArrayLike& center_of_mass, const MaybeArrayLike& inertia,
                const MaybeArrayLike& frame, const std::string& tip) {
  auto& payload = solver.as<ids::Payload>("set_payload");
  ids::RigidBody body = bodyOf(mass, center_of_mass, inertia, frame);
  body.tip = tip;
  unlocked([&] { payload.setPayload(name, body); });
  warn(ids::doubtOf(body));
}

void setGravity(const Solver& solver, const ArrayLike& gravity) {
  auto& mount = solver.as<ids::VariableGravity>("set_gravity");
  const Eigen::Vector3d numbers = vectorOf("set_gravity: argument gravity", gravity);
  unlocked([&] { mount.setGravity(numbers); });
  warn(ids::doubtOf(numbers));
}

void setBaseAcceleration(const Solver& solver, const ArrayLike& acceleration) {
  auto& mount = solver.as<ids::VariableGravity>("set_base_acceleration");
  const Eigen::Vector3d numbers =
      vectorOf("set_base_acceleration: argument acceleration", acceleration);
  unlocked([&] { mount.setBaseAcceleration(numbers); });
}

}  // namespace

py::dict changesOf(const Solver& solver) {
  py::dict changes;
  if (!solver.find<ids::Payload>() || !solver.find<ids::VariableGravity>()) return changes;
  changes["payloads"] = payloads(solver);
  changes["gravity"] = gravity(solver);
  changes["base_acceleration"] = baseAcceleration(solver);
  return changes;
}

void change(const Solver& solver, const py::dict& changes) {
  if (changes.empty()) return;
  auto& payload = solver.as<ids::Payload>("payloads");
  payload.clearPayloads();
  for (const auto& [name, body] : changes["payloads"].cast<ids::Payloads>()) {
    payload.setPayload(name, body);
  }
  auto& mount = solver.as<ids::VariableGravity>("gravity");
  mount.setGravity(vectorOf("gravity", changes["gravity"]));
  mount.setBaseAcceleration(vectorOf("base_acceleration", changes["base_acceleration"]));
}

void bindChanges(py::class_<Solver>& solver) {
  solver
      .def(
          "set_payload", &setPayload, "name"_a, "mass"_a, "center_of_mass"_a = py::none(),
          "inertia"_a = py::none(), "frame"_a = py::none(), "tip"_a = "",
          R"(Adds a rigid body to the tip, or replaces the one of that name, also while other threads compute.

Parameters
----------
name : str
mass : float
    kg.
center_of_mass : array_like, (3,), optional
    m, in the body's frame; by default its origin.
inertia : array_like, (3, 3) or ixx ixy ixz iyy iyz izz, optional
    kg m^2, about the center of mass, in the axes of the body's frame; by default a point mass.
frame : array_like, (4, 4), optional
    Pose of the body's frame in the tip frame; by default the same.
tip : str, optional
    Which of tip_names carries it; by default the first.

Warns
-----
UserWarning
    A body that is implausible: 5 m away, for one.

Examples
--------
>>> from inverse_dynamics import Solver
>>> arm = Solver("ur10_real")
>>> arm.set_payload("gripper", 1.5, center_of_mass=[0, 0, 0.06])
>>> sorted(arm.payloads)
['gripper'])")
      .def(
          "remove_payload",
          [](const Solver& s, const std::string& name) {
            auto& payload = s.as<ids::Payload>("remove_payload");
            return unlocked([&] { return payload.removePayload(name); });
          },
          "name"_a, R"(Takes a body away.

Parameters
----------
name : str
    As set_payload() had it.

Returns
-------
bool
    False if there is none of that name.)")
      .def(
          "clear_payloads",
          [](const Solver& s) {
            auto& payload = s.as<ids::Payload>("clear_payloads");
            unlocked([&] { payload.clearPayloads(); });
          },
          "Takes all bodies away.")
      .def_property_readonly("payloads", &payloads,
                             "The bodies: name to the arguments of set_payload().")
      .def("set_gravity", &setGravity, "gravity"_a,
           R"(Sets the gravitational acceleration.

Parameters
----------
gravity : array_like, (3,)
    m/s^2, in the axes of the root link.

Warns
-----
UserWarning
    An implausible one: 981, for one.)")
      .def("set_base_acceleration", &setBaseAcceleration, "acceleration"_a,
           R"(Sets how the root link accelerates. Not for a base that rotates.

Parameters
----------
acceleration : array_like, (3,)
    m/s^2, in the axes of the root link.)")
      .def_property_readonly("gravity", &gravity, "(3,) m/s^2.")
      .def_property_readonly("base_acceleration", &baseAcceleration, "(3,) m/s^2.");
}

}  // namespace inverse_dynamics_tools

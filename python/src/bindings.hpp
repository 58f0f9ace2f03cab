// SPDX-License-Identifier: Apache-2.0
/// @file
/// Parts of the extension module, one function per source, and what they share.
#pragma once

#include <pybind11/pybind11.h>

#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <memory>
#include <string>

#include "annotations.hpp"

namespace inverse_dynamics_tools {

/// C++ exceptions become the Python exceptions of inverse_dynamics.errors, with the same text.
void bindErrors();

void bindSolver(pybind11::module_& module);
void bindFastModel(pybind11::module_& module);
void bindAccelerations(pybind11::module_& module);
void bindRecordings(pybind11::module_& module);
void bindYaml(pybind11::module_& module);
void bindRobotDescription(pybind11::module_& module);
void bindRunConfiguration(pybind11::module_& module);
void bindEvaluator(pybind11::module_& module);
void bindControl(pybind11::module_& module);
void bindContact(pybind11::module_& module);
void bindPayload(pybind11::module_& module);
void bindIdentification(pybind11::module_& module);
void bindTiming(pybind11::module_& module);

/// Makes wrong calls readable; after all the others.
///
/// A public function, constructor or method raises `inverse_dynamics.errors.ArgumentError`, one line
/// that names the argument, where pybind11 raises its list of signatures. An object whose `__init__`
/// hasn't run (`Solver.__new__(Solver)`) raises TypeError, where pybind11 reads memory without an
/// object in it.
void explainWrongCalls(pybind11::module_& module);

/// Throws the exception of that name of inverse_dynamics.errors.
[[noreturn]] void throwError(const char* name, const std::string& text);

/// The solver inside an object of class Solver; it outlives the object if need be.
///
/// @throws pybind11::type_error  another class.
std::shared_ptr<const inverse_dynamics_solver::InverseDynamicsSolver> solverOf(
    const pybind11::handle& object);

/// A constructor that takes a Solver, then Options.
template <class Made, class... Options>
auto ofSolver() {
  return pybind11::init([](const SolverObject& solver, const Options&... options) {
    return std::make_unique<Made>(solverOf(solver), options...);
  });
}

}  // namespace inverse_dynamics_tools

// SPDX-License-Identifier: Apache-2.0
/// @file
/// The extension module `inverse_dynamics._core`: solvers by name, recordings and their samples,
/// accelerations, metrics and control laws, on numpy arrays.
///
/// A batch is an (N, n) array, one state per row. Solvers compute from and into doubles where they
/// are, whatever their layout; another type is copied once on the way in. To the other functions an
/// array row after row is, byte for byte, the n x N matrix of Eigen with one state per column, and
/// anything else is copied once on the way in. All computing releases the GIL.

#include "bindings.hpp"

PYBIND11_MODULE(_core, module) {
  module.doc() = "Solvers, samples of recordings, accelerations, metrics and control laws in C++.";
  inverse_dynamics_tools::bindErrors();
  // classes before the functions whose signatures name them
  inverse_dynamics_tools::bindYaml(module);
  inverse_dynamics_tools::bindRobotDescription(module);
  inverse_dynamics_tools::bindRecordings(module);
  inverse_dynamics_tools::bindEvaluator(module);
  inverse_dynamics_tools::bindRunConfiguration(module);
  inverse_dynamics_tools::bindSolver(module);
  inverse_dynamics_tools::bindFastModel(module);
  inverse_dynamics_tools::bindAccelerations(module);
  inverse_dynamics_tools::bindControl(module);
  inverse_dynamics_tools::bindContact(module);
  inverse_dynamics_tools::bindPayload(module);
  inverse_dynamics_tools::bindIdentification(module);
  inverse_dynamics_tools::bindTiming(module);
  inverse_dynamics_tools::explainWrongCalls(module);
  pybind11::module_::import("inverse_dynamics.installation.wheels").attr("find_other_wheels")();
}

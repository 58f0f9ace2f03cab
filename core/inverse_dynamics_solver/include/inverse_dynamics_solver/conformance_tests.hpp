// SPDX-License-Identifier: Apache-2.0
/// @file
/// The tests that every solver passes: a GoogleTest suite, instantiated by each plugin package.
///
///     #include "inverse_dynamics_solver/conformance_tests.hpp"
///
///     struct MySolverTraits : inverse_dynamics_solver::conformance::SolverTraits {
///       static constexpr const char* kPlugin = "my_solver/MySolver";
///       static ParameterMap parameters() { return {{"tip", std::string("tool0")}}; }
///       static std::string robotDescription() { return readFile("robot.urdf"); }
///     };
///     INVERSE_DYNAMICS_SOLVER_CONFORMANCE(MySolver, MySolverTraits);
///
/// In CMake: `inverse_dynamics_solver_add_plugin_test(my_solver_conformance_test
/// test/my_solver_conformance_test.cpp PLUGIN my_solver_plugin)`, then
/// `inverse_dynamics_solver_link_conformance_tests(my_solver_conformance_test)`.
///
/// Parts one to four, initialization_tests.hpp, contract_tests.hpp, batch_tests.hpp and
/// real_time_tests.hpp, are what callers are promised; part five, law_tests.hpp, is physics; part
/// six, capability_tests.hpp, the physics of the capabilities that the solver has; part seven,
/// first_error_tests.hpp, has a process for each error; part eight, payload_tests.hpp, is what
/// solvers with Payload and VariableGravity promise. A test that doesn't apply to a solver is
/// skipped and says why.
///
/// The plugin is loaded by name, as users do. Random states have a fixed seed, and a failure prints
/// its state as C++ to be pasted. Tolerances and their reasons stand in solver_fixture.hpp.
///
/// The tests are a library, compiled with the interface.
#pragma once

#include <gtest/gtest.h>

#include "inverse_dynamics_solver/conformance/solver_fixture.hpp"  // IWYU pragma: export

/// Runs all tests for the solver that `traits` describes, under the name `prefix`.
#define INVERSE_DYNAMICS_SOLVER_CONFORMANCE(prefix, traits)                             \
  using inverse_dynamics_solver::conformance::SolverAlone;                              \
  using inverse_dynamics_solver::conformance::SolverConformance;                        \
  INSTANTIATE_TEST_SUITE_P(                                                             \
      prefix, SolverConformance,                                                        \
      ::testing::Values(inverse_dynamics_solver::conformance::testedSolver<traits>())); \
  INSTANTIATE_TEST_SUITE_P(                                                             \
      prefix, SolverAlone,                                                              \
      ::testing::Values(inverse_dynamics_solver::conformance::testedSolver<traits>()))

// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <string>

#include "inverse_dynamics_solver/conformance_tests.hpp"

namespace {

using namespace inverse_dynamics_solver::conformance;

/// The environment variable FAULT names the fault that the tests must find:
/// conformance_tests_test.cpp.
struct Carrying : SolverTraits {
  static constexpr const char* kPlugin = "carrying_solver/CarryingSolver";
  static ParameterMap parameters() {
    const char* const fault = std::getenv("FAULT");
    return {{"fault", std::string(fault == nullptr ? "" : fault)}};
  }
};

INVERSE_DYNAMICS_SOLVER_CONFORMANCE(Carrying, Carrying);

}  // namespace

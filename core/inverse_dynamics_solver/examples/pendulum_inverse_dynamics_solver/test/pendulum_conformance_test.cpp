// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/conformance_tests.hpp"

namespace {

using namespace inverse_dynamics_solver::conformance;

struct Pendulum : SolverTraits {
  static constexpr const char* kPlugin =
      "pendulum_inverse_dynamics_solver/InverseDynamicsSolverPendulum";
  static ParameterMap parameters() { return {{"mass", 2.0}, {"length", 0.5}, {"damping", 0.1}}; }
};

INVERSE_DYNAMICS_SOLVER_CONFORMANCE(Pendulum, Pendulum);

}  // namespace

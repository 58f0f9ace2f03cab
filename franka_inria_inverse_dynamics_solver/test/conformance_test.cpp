// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/conformance_tests.hpp"

namespace {

using namespace inverse_dynamics_solver::conformance;

struct FrankaInria : SolverTraits {
  static constexpr const char* kPlugin =
      "franka_inria_inverse_dynamics_solver/InverseDynamicsSolverFrankaInria";
};

INVERSE_DYNAMICS_SOLVER_CONFORMANCE(FrankaInria, FrankaInria);

}  // namespace

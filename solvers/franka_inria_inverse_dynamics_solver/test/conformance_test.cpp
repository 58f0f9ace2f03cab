// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "chain_dynamics/model.hpp"
#include "chain_dynamics/model_file.hpp"
#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/conformance_tests.hpp"

namespace franka_inria_inverse_dynamics_solver::conformance_test {

using namespace inverse_dynamics_solver::conformance;

struct FrankaInria : SolverTraits {
  static constexpr const char* kPlugin =
      "franka_inria_inverse_dynamics_solver/InverseDynamicsSolverFrankaInria";
  static std::optional<chain_dynamics::Model> model() {
    return chain_dynamics::modelFromFile(robotsFile("models/franka_inria_identified.yaml"));
  }
};

INVERSE_DYNAMICS_SOLVER_CONFORMANCE(FrankaInria, FrankaInria);

}  // namespace franka_inria_inverse_dynamics_solver::conformance_test

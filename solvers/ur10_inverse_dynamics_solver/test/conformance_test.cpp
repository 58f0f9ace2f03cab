// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "chain_dynamics/model.hpp"
#include "chain_dynamics/model_file.hpp"
#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/conformance_tests.hpp"

namespace ur10_inverse_dynamics_solver::conformance_test {

using namespace inverse_dynamics_solver::conformance;

struct UR10 : SolverTraits {
  static constexpr const char* kPlugin = "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10";
  static std::optional<chain_dynamics::Model> model() {
    return chain_dynamics::modelFromFile(robotsFile("models/ur10_identified.yaml"));
  }
  static constexpr const char* kGravityIsNotConservative =
      "each row of the identified model has parameters of its own";
};

INVERSE_DYNAMICS_SOLVER_CONFORMANCE(UR10, UR10);

}  // namespace ur10_inverse_dynamics_solver::conformance_test

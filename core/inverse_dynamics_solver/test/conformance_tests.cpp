// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/conformance_tests.hpp"

#include <ostream>

#include "inverse_dynamics_solver/conformance/batch_tests.hpp"
#include "inverse_dynamics_solver/conformance/capability_tests.hpp"
#include "inverse_dynamics_solver/conformance/contract_tests.hpp"
#include "inverse_dynamics_solver/conformance/first_error_tests.hpp"
#include "inverse_dynamics_solver/conformance/initialization_tests.hpp"
#include "inverse_dynamics_solver/conformance/law_tests.hpp"
#include "inverse_dynamics_solver/conformance/payload_tests.hpp"
#include "inverse_dynamics_solver/conformance/real_time_tests.hpp"

namespace inverse_dynamics_solver::conformance {

std::ostream& operator<<(std::ostream& stream, const TestedSolver& solver) {
  return stream << solver.plugin;
}

}  // namespace inverse_dynamics_solver::conformance

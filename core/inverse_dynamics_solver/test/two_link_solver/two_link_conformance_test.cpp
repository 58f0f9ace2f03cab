// SPDX-License-Identifier: Apache-2.0
#include <chain_dynamics/model.hpp>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_solver/conformance_tests.hpp"
#include "two_link_arm.hpp"

namespace {

using namespace inverse_dynamics_solver::conformance;

/// The environment variable FAULT names the fault that the tests must find:
/// conformance_tests_test.cpp.
struct TwoLink : SolverTraits {
  static constexpr const char* kPlugin = "two_link_solver/TwoLinkSolver";
  static std::string robotDescription() { return "<robot/>"; }
  static std::optional<chain_dynamics::Model> model() {
    return chain_dynamics::Model(two_link_solver::chain({0.0, 0.0, -9.81}));
  }
  static ParameterMap parameters() {
    const char* const fault = std::getenv("FAULT");
    return {{"fault", std::string(fault == nullptr ? "" : fault)}};
  }
  static std::vector<std::pair<ParameterMap, std::string>> badInitializations() {
    return {{{{"fault", "error of its own class"}}, robotDescription()}};
  }
};

INVERSE_DYNAMICS_SOLVER_CONFORMANCE(TwoLink, TwoLink);

}  // namespace

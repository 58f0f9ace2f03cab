// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/conformance/two_arms.hpp"
#include "inverse_dynamics_solver/conformance_tests.hpp"

namespace pinocchio_inverse_dynamics_solver::conformance_test {

using namespace inverse_dynamics_solver::conformance;

std::string description(const std::string& robot) {
  return textOf(robotsFile("urdf/" + robot + ".urdf"));
}

struct Pinocchio : SolverTraits {
  static constexpr const char* kPlugin =
      "pinocchio_inverse_dynamics_solver/InverseDynamicsSolverPinocchio";
};

struct PinocchioOblique : Pinocchio {
  static std::string robotDescription() { return description("oblique_arm"); }
  static ParameterMap parameters() { return {{"tip", "tool"}}; }
  static std::vector<std::pair<ParameterMap, std::string>> badInitializations() {
    return {{{{"max_threads", 0}}, description("oblique_arm")}};
  }
};

struct PinocchioPanda : Pinocchio {
  static std::string robotDescription() { return description("panda"); }
};

struct PinocchioPandaWithFriction : PinocchioPanda {
  static ParameterMap parameters() { return {{"urdf_friction", true}}; }
};

struct PinocchioTwoArms : Pinocchio {
  static std::string robotDescription() { return twoArms(); }
  static ParameterMap parameters() {
    return {{"tip", std::vector<std::string>{"left_other_finger", "right_tool", "left_finger"}},
            {"urdf_friction", true}};
  }
};

INVERSE_DYNAMICS_SOLVER_CONFORMANCE(Oblique, PinocchioOblique);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(Panda, PinocchioPanda);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(PandaWithFriction, PinocchioPandaWithFriction);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(TwoArms, PinocchioTwoArms);

}  // namespace pinocchio_inverse_dynamics_solver::conformance_test

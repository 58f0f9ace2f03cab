// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <utility>
#include <vector>

#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/conformance/two_arms.hpp"
#include "inverse_dynamics_solver/conformance_tests.hpp"

namespace kdl_inverse_dynamics_solver::conformance_test {

using namespace inverse_dynamics_solver::conformance;

std::string obliqueArm() { return textOf(robotsFile("urdf/oblique_arm.urdf")); }

struct Kdl : SolverTraits {
  static constexpr const char* kPlugin = "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL";
  static std::vector<std::pair<ParameterMap, std::string>> badInitializations() {
    return {{{{"max_threads", 0}}, obliqueArm()}, {{{"max_threads", "many"}}, obliqueArm()}};
  }
};

struct KdlOblique : Kdl {
  static std::string robotDescription() { return obliqueArm(); }
  static ParameterMap parameters() { return {{"tip", "tool"}}; }
};

struct KdlUr10 : Kdl {
  static std::string robotDescription() { return textOf(robotsFile("urdf/ur10.urdf")); }
};

struct KdlPandaWithFriction : Kdl {
  static std::string robotDescription() { return textOf(robotsFile("urdf/panda.urdf")); }
  static ParameterMap parameters() { return {{"urdf_friction", true}}; }
};

struct KdlTwoArms : Kdl {
  static std::string robotDescription() { return twoArms(); }
  static ParameterMap parameters() {
    return {{"tip", std::vector<std::string>{"left_other_finger", "right_tool", "left_finger"}},
            {"urdf_friction", true}};
  }
};

INVERSE_DYNAMICS_SOLVER_CONFORMANCE(Oblique, KdlOblique);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(Ur10, KdlUr10);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(PandaWithFriction, KdlPandaWithFriction);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(TwoArms, KdlTwoArms);

}  // namespace kdl_inverse_dynamics_solver::conformance_test

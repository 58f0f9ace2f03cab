// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/conformance_tests.hpp"

namespace {

using namespace inverse_dynamics_solver::conformance;
using inverse_dynamics_solver::conformance::robotsFile;
using inverse_dynamics_solver::conformance::textOf;

struct RigidBody : SolverTraits {
  static constexpr const char* kPlugin =
      "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody";
  static std::vector<std::pair<ParameterMap, std::string>> badInitializations() {
    return {{{{"model", std::string("no_such_model")}}, ""},
            {{{"model", std::string("no_such_file.yaml")}}, ""},
            {{{"model", 1.0}}, ""}};
  }
};

struct Ur10Description : RigidBody {
  static std::string robotDescription() { return textOf(robotsFile("urdf/ur10.urdf")); }
};

struct PandaDescription : RigidBody {
  static ParameterMap parameters() {
    return {{"root", std::string("fer_link0")}, {"tip", std::string("fer_link8")}};
  }
  static std::string robotDescription() { return textOf(robotsFile("urdf/panda.urdf")); }
};

struct PandaDescriptionWithFriction : PandaDescription {
  static ParameterMap parameters() { return {{"urdf_friction", true}}; }
};

struct FeasiblePandaModel : RigidBody {
  static ParameterMap parameters() { return {{"model", std::string("franka_gaz2019_feasible")}}; }
};

struct IdentifiedUr10Model : RigidBody {
  static ParameterMap parameters() { return {{"model", std::string("ur10_identified")}}; }
  static constexpr const char* kGravityIsNotConservative =
      "each row of the identified UR10 has parameters of its own";
};

INVERSE_DYNAMICS_SOLVER_CONFORMANCE(Ur10Description, Ur10Description);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(PandaDescription, PandaDescription);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(PandaDescriptionWithFriction, PandaDescriptionWithFriction);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(FeasiblePandaModel, FeasiblePandaModel);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(IdentifiedUr10Model, IdentifiedUr10Model);

}  // namespace

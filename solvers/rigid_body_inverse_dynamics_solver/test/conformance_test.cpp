// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "chain_dynamics/model.hpp"
#include "chain_dynamics/model_file.hpp"
#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/conformance/two_arms.hpp"
#include "inverse_dynamics_solver/conformance_tests.hpp"

namespace rigid_body_inverse_dynamics_solver::conformance_test {

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

std::optional<chain_dynamics::Model> modelOf(const std::string& name) {
  return chain_dynamics::modelFromFile(robotsFile("models/" + name + ".yaml"));
}

struct TwoArms : RigidBody {
  static ParameterMap parameters() { return {{"tip", std::string("*")}}; }
  static std::string robotDescription() { return twoArms(); }
};

struct TwoArmsWithFriction : TwoArms {
  static ParameterMap parameters() {
    return {{"tip", std::vector<std::string>{"right_tool", "left_other_finger", "left_finger"}},
            {"urdf_friction", true}};
  }
};

struct PandaWithSprings : PandaDescription {
  static ParameterMap parameters() {
    ParameterMap values = PandaDescription::parameters();
    values["springs.fer_joint2.stiffness"] = 12.0;
    values["springs.fer_joint4.stiffness"] = 3.0;
    values["springs.fer_joint4.rest"] = -1.5;
    return values;
  }
};

/// Two motors turn left elbow and hand together; others move a joint alone, or two in proportion.
struct TwoArmsBehindMotors : TwoArms {
  static ParameterMap parameters() {
    return {{"tip", std::string("*")},
            {"motors", std::vector<double>{1, 0,  0,   0, 0,  0, 0,   0,  //
                                           0, -1, 0,   0, 0,  0, 0,   0,  //
                                           0, 0,  0.5, 0, 0,  0, 0,   0,  //
                                           0, 0,  0,   1, 1,  0, 0,   0,  //
                                           0, 0,  0,   1, -1, 0, 0,   0,  //
                                           0, 0,  0,   0, 0,  1, 0,   0,  //
                                           0, 0,  0,   0, 0,  0, 1,   0,  //
                                           0, 0,  0,   0, 0,  0, 0.3, 0,  //
                                           0, 0,  0,   0, 0,  0, 0,   1}},
            {"rotor_inertia.motor_4", 0.2},
            {"springs.motor_4.stiffness", 5.0},
            {"springs.lift_joint.stiffness", 40.0},
            {"springs.lift_joint.rest", 0.1}};
  }
};

struct FeasiblePandaModel : RigidBody {
  static ParameterMap parameters() { return {{"model", std::string("franka_gaz2019_feasible")}}; }
  static std::optional<chain_dynamics::Model> model() { return modelOf("franka_gaz2019_feasible"); }
};

/// A file of the process's own, removed with it.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& name, const std::string& text)
      : path_(std::filesystem::temp_directory_path() /
              ("conformance_" + std::to_string(process_) + "_" + name)) {
    std::ofstream(path_) << text;
  }
  ~TemporaryFile() {
    if (::getpid() != process_) return;  // a copy of the process
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  std::string path() const { return path_.string(); }

 private:
  pid_t process_ = ::getpid();
  std::filesystem::path path_;
};

/// The feasible Panda in schema 2, its first three joints with friction that depends on load.
std::string loadedPanda() {
  std::string text = textOf(robotsFile("models/franka_gaz2019_feasible.yaml"));
  text = text.substr(0, text.find("\nchecks:") + 1);  // of the other friction
  text.replace(text.find("schema: 1"), 9, "schema: 2");
  const std::string measured =
      "\n    torque_deviation: 0.4\n    seen: {q: [-1, 1.5], qd: [-2, 2], qdd: [-9, 8]}";
  for (std::size_t at = 0; (at = text.find("\n    friction:", at)) != std::string::npos;) {
    text.insert(at, measured);
    at += measured.size() + 1;
  }
  for (const std::string figures : {"fv: 1.5, fc: 0.6, width: 0.05, fl: 0.02",
                                    "fv: 2.5, fc: 0.9, width: 0.08, shift: 0.01, fo: 0.1, fl: 0.05",
                                    "fv: 0.5, fc: 0.4, width: 0.05, fl: 0.03, fs: 0.3, vs: 0.2"}) {
    const std::size_t begin = text.find("{law: centered_sigmoid");
    text.replace(begin, text.find('}', begin) - begin, "{law: smooth_coulomb, " + figures);
  }
  return text;
}

struct LoadedPandaModel : RigidBody {
  static ParameterMap parameters() {
    static const TemporaryFile file("loaded_panda.yaml", loadedPanda());
    return {{"model", file.path()}};
  }
  // (the other friction isn't part of the regressor)
  static std::optional<chain_dynamics::Model> model() { return modelOf("franka_gaz2019_feasible"); }
};

struct IdentifiedUr10Model : RigidBody {
  static ParameterMap parameters() { return {{"model", std::string("ur10_identified")}}; }
  static std::optional<chain_dynamics::Model> model() { return modelOf("ur10_identified"); }
  static constexpr const char* kGravityIsNotConservative =
      "each row of the identified UR10 has parameters of its own";
};

INVERSE_DYNAMICS_SOLVER_CONFORMANCE(Ur10Description, Ur10Description);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(PandaDescription, PandaDescription);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(PandaDescriptionWithFriction, PandaDescriptionWithFriction);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(TwoArms, TwoArms);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(TwoArmsWithFriction, TwoArmsWithFriction);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(PandaWithSprings, PandaWithSprings);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(TwoArmsBehindMotors, TwoArmsBehindMotors);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(FeasiblePandaModel, FeasiblePandaModel);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(LoadedPandaModel, LoadedPandaModel);
INVERSE_DYNAMICS_SOLVER_CONFORMANCE(IdentifiedUr10Model, IdentifiedUr10Model);

}  // namespace rigid_body_inverse_dynamics_solver::conformance_test

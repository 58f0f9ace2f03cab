// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <string>

#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"
#include "inverse_dynamics_solver/parameters.hpp"
#include "rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp"

namespace rigid_body_inverse_dynamics_solver::reference_test {

using inverse_dynamics_solver::InverseDynamicsSolver;
using inverse_dynamics_solver::Parameters;
using inverse_dynamics_solver::conformance::expectEntry;
using inverse_dynamics_solver::conformance::expectReferenceValues;
using inverse_dynamics_solver::conformance::numbersOf;
using inverse_dynamics_solver::conformance::referenceStates;
using inverse_dynamics_solver::conformance::robotsFile;
using inverse_dynamics_solver::conformance::textOf;

// N m, kg m^2. Other programs do the same operations in another order: rounding leaves less than
// 1e-12 of terms up to 100 N m.
constexpr double kTolerance = 1e-10;

TEST(Reference, DescriptionsGivePinocchiosValuesWhetherRootAndTipAreNamedOrNot) {
  for (const bool named : {false, true}) {
    InverseDynamicsSolverRigidBody ur10, panda;
    const auto ends = [named](const char* root, const char* tip) -> Parameters {
      return named ? Parameters({{"root", root}, {"tip", tip}}) : Parameters();
    };
    ur10.initialize(ends("base_link", "tool0"), "", textOf(robotsFile("urdf/ur10.urdf")));
    panda.initialize(ends("fer_link0", "fer_link8"), "", textOf(robotsFile("urdf/panda.urdf")));
    expectReferenceValues(ur10, "ur10_urdf.json", kTolerance);
    expectReferenceValues(panda, "panda_urdf.json", kTolerance);
  }
}

// Whole turns change nothing but the angle's last digits: 1600 turns are 1e4 rad, which a double
// states to 1e-12 rad, and up to 500 N m/rad make 5e-10 N m of that. So the values are to be those
// at the angle as it was rounded, less the turns.
void expectReferenceValuesAfterTurns(const InverseDynamicsSolver& solver, const std::string& file,
                                     int turns) {
  constexpr long double kTurn = 6.283185307179586476925286766559L;
  for (const YAML::Node& state : referenceStates(file)) {
    const Eigen::VectorXd q = numbersOf(state["q"]);
    const Eigen::VectorXd qd = numbersOf(state["qd"]);
    const Eigen::VectorXd qdd = numbersOf(state["qdd"]);
    const Eigen::VectorXd turned = q.array() + static_cast<double>(turns * kTurn);
    const Eigen::VectorXd rounded =
        (turned.cast<long double>().array() - turns * kTurn).cast<double>();
    ASSERT_LT((rounded - q).cwiseAbs().maxCoeff(), 2e-12);

    const auto expect = [&](const std::string& name, const auto& value) {
      expectEntry(state, name, value(turned) - (value(rounded) - value(q)), kTolerance,
                  file + " after " + std::to_string(turns) + " turns");
    };
    using Vector = Eigen::VectorXd;
    expect("inertia", [&](const Vector& at) { return solver.getInertiaMatrix(at); });
    expect("coriolis", [&](const Vector& at) { return solver.getCoriolisVector(at, qd); });
    expect("gravity", [&](const Vector& at) { return solver.getGravityVector(at); });
    expect("torques", [&](const Vector& at) { return solver.getTorques(at, qd, qdd); });
  }
}

TEST(Reference, ValuesHoldAtLargeAngles) {
  InverseDynamicsSolverRigidBody ur10, panda;
  ur10.initialize({}, "", textOf(robotsFile("urdf/ur10.urdf")));
  panda.initialize({}, "", textOf(robotsFile("urdf/panda.urdf")));
  for (const int turns : {1600, -1600}) {
    expectReferenceValuesAfterTurns(ur10, "ur10_urdf.json", turns);
    expectReferenceValuesAfterTurns(panda, "panda_urdf.json", turns);
  }
}

TEST(Reference, ModelFilesOfIdentifiedRobotsGiveTheValuesOfTheirSolvers) {
  InverseDynamicsSolverRigidBody ur10, panda;
  ur10.initialize({{"model", std::string("ur10_identified")}});
  panda.initialize({{"model", std::string("franka_inria_identified")}});
  expectReferenceValues(ur10, "ur10.json", kTolerance);
  expectReferenceValues(panda, "franka_inria.json", kTolerance);
}

}  // namespace rigid_body_inverse_dynamics_solver::reference_test

// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/conformance/reference_values.hpp"
#include "rigid_body_inverse_dynamics_solver/rigid_body_inverse_dynamics_solver.hpp"

namespace rigid_body_inverse_dynamics_solver {
namespace {

using inverse_dynamics_solver::conformance::expectReferenceValues;
using inverse_dynamics_solver::conformance::robotsFile;
using inverse_dynamics_solver::conformance::textOf;

// N m, kg m^2. Other programs do the same operations in another order: rounding leaves less than
// 1e-12 of terms up to 100 N m.
constexpr double kTolerance = 1e-10;

TEST(Reference, Ur10DescriptionGivesPinocchiosValues) {
  InverseDynamicsSolverRigidBody solver;
  solver.initialize({{"root", std::string("base_link")}, {"tip", std::string("tool0")}}, "",
                    textOf(robotsFile("urdf/ur10.urdf")));
  expectReferenceValues(solver, "ur10_urdf.json", kTolerance);
}

TEST(Reference, PandaDescriptionGivesPinocchiosValues) {
  InverseDynamicsSolverRigidBody solver;
  solver.initialize({{"root", std::string("fer_link0")}, {"tip", std::string("fer_link8")}}, "",
                    textOf(robotsFile("urdf/panda.urdf")));
  expectReferenceValues(solver, "panda_urdf.json", kTolerance);
}

// 1600 turns are 1e4 rad, which a double states to 1e-12 rad: up to 500 N m/rad make 5e-10 of it.
TEST(Reference, ValuesHoldAtLargeAngles) {
  constexpr double kLargeAngleTolerance = 1e-9;
  InverseDynamicsSolverRigidBody ur10, panda;
  ur10.initialize({}, "", textOf(robotsFile("urdf/ur10.urdf")));
  panda.initialize({}, "", textOf(robotsFile("urdf/panda.urdf")));
  for (const int turns : {1600, -1600}) {
    expectReferenceValues(ur10, "ur10_urdf.json", kLargeAngleTolerance, turns);
    expectReferenceValues(panda, "panda_urdf.json", kLargeAngleTolerance, turns);
  }
}

TEST(Reference, RootAndTipNeedNotBeNamed) {
  InverseDynamicsSolverRigidBody ur10, panda;
  ur10.initialize({}, "", textOf(robotsFile("urdf/ur10.urdf")));
  panda.initialize({}, "", textOf(robotsFile("urdf/panda.urdf")));
  expectReferenceValues(ur10, "ur10_urdf.json", kTolerance);
  expectReferenceValues(panda, "panda_urdf.json", kTolerance);
}

TEST(Reference, ModelFilesOfIdentifiedRobotsGiveTheValuesOfTheirSolvers) {
  InverseDynamicsSolverRigidBody ur10, panda;
  ur10.initialize({{"model", std::string("ur10_identified")}});
  panda.initialize({{"model", std::string("franka_inria_identified")}});
  expectReferenceValues(ur10, "ur10.json", kTolerance);
  expectReferenceValues(panda, "franka_inria.json", kTolerance);
}

}  // namespace
}  // namespace rigid_body_inverse_dynamics_solver

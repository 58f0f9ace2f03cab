// SPDX-License-Identifier: Apache-2.0
#include "solver_capabilities.hpp"

#include <initializer_list>
#include <inverse_dynamics_solver/coriolis_matrix.hpp>
#include <inverse_dynamics_solver/energies.hpp>
#include <inverse_dynamics_solver/external_wrench.hpp>
#include <inverse_dynamics_solver/forward_dynamics.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <inverse_dynamics_solver/regressor.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <inverse_dynamics_solver/torque_derivatives.hpp>
#include <utility>

#include "solver_call.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace ids = inverse_dynamics_solver;
using Arguments = std::initializer_list<std::pair<const char*, py::object>>;

/// Names of the installed solvers for which `has` is true.
template <class Has>
std::string solversThat(const Has& has) {
  const ids::SolverLoader loader;
  std::string names;
  for (const std::string& name : loader.availableSolvers()) {
    try {
      if (has(*loader.load(name))) names += (names.empty() ? "" : ", ") + name;
    } catch (const ids::Exception&) {  // one that can't be loaded is no advice
    }
  }
  return names;
}

/// The capability of a solver.
template <class Capability>
const Capability& capability(const char* method, const NamedSolver& of) {
  const auto as = [](const ids::InverseDynamicsSolver& solver) {
    return dynamic_cast<const Capability*>(&solver);
  };
  if (const Capability* const found = as(of.solver)) return *found;
  const std::string others = solversThat([&](const auto& solver) { return as(solver) != nullptr; });
  throw ids::Exception(ids::errorText(method, "this solver doesn't compute it",
                                      others.empty() ? "a solver that does" : "one of " + others,
                                      of.plugin, "make another Solver for it"));
}

/// A call whose inputs are checked.
SolverCall callOf(const char* method, const NamedSolver& of, Arguments arguments) {
  SolverCall call(method, of.solver);
  for (const auto& [name, values] : arguments) call.input(name, values);
  return call;
}

Eigen::Index jointsOf(const NamedSolver& of) { return of.solver.jointCount(); }

/// Calls compute() with the wrenches as the type of their frame.
template <class Compute>
void withWrenches(const SolverCall& call, const std::string& frame, const Compute& compute) {
  if (frame == "tip") {
    compute(ids::WrenchesInTip(call.wrenches()));
  } else {
    compute(ids::WrenchesInRoot(call.wrenches()));
  }
}

void requireFrame(const char* method, const std::string& frame) {
  if (frame == "root" || frame == "tip") return;
  throw ids::InvalidParameterValueException(
      ids::errorText(std::string(method) + ": argument frame", "",
                     "'root' or 'tip': whose axes the wrench is expressed in", "'" + frame + "'"));
}

}  // namespace

TwoFloats tipPose(const NamedSolver& of, const ArrayLike& q) {
  const auto& kinematics = capability<ids::Kinematics>("tip_pose", of);
  SolverCall call = callOf("tip_pose", of, {{"q", q}});
  call.matrices("R", py::none(), 3, 3);
  call.vectors("p", py::none(), 3);
  call.run([&] { kinematics.getTipPoseBatch(call.in(0), call.matricesOf(0), call.states(1)); });
  return {call.result(0), call.result(1)};
}

Floats tipJacobian(const NamedSolver& of, const ArrayLike& q, const MaybeFloats& out) {
  const auto& kinematics = capability<ids::Kinematics>("tip_jacobian", of);
  SolverCall call = callOf("tip_jacobian", of, {{"q", q}});
  call.matrices("out", out, 6, jointsOf(of));
  call.run([&] { kinematics.getTipJacobianBatch(call.in(0), call.matricesOf(0)); });
  return call.result(0);
}

Floats tipJacobianDerivative(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd,
                             const MaybeFloats& out) {
  const auto& kinematics = capability<ids::Kinematics>("tip_jacobian_derivative", of);
  SolverCall call = callOf("tip_jacobian_derivative", of, {{"q", q}, {"qd", qd}});
  call.matrices("out", out, 6, jointsOf(of));
  call.run([&] {
    kinematics.getTipJacobianDerivativeBatch(call.in(0), call.in(1), call.matricesOf(0));
  });
  return call.result(0);
}

Floats externalTorques(const NamedSolver& of, const ArrayLike& q, const ArrayLike& wrench,
                       const std::string& frame, const MaybeFloats& out) {
  const char* const method = "external_torques";
  const auto& contact = capability<ids::ExternalWrench>(method, of);
  requireFrame(method, frame);
  SolverCall call = callOf(method, of, {{"q", q}});
  call.wrench("wrench", wrench);
  call.vectors("out", out);
  call.run([&] {
    withWrenches(call, frame, [&](const auto& wrenches) {
      contact.getExternalTorquesBatch(call.in(0), wrenches, call.states(0));
    });
  });
  return call.result(0);
}

Floats torquesWithWrench(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd,
                         const ArrayLike& qdd, const ArrayLike& wrench, const std::string& frame,
                         const MaybeFloats& out) {
  const char* const method = "torques";
  const auto& contact = capability<ids::ExternalWrench>(method, of);
  requireFrame(method, frame);
  SolverCall call = callOf(method, of, {{"q", q}, {"qd", qd}, {"qdd", qdd}});
  call.wrench("wrench", wrench);
  call.vectors("out", out);
  call.run([&] {
    withWrenches(call, frame, [&](const auto& wrenches) {
      contact.getTorquesBatch(call.in(0), call.in(1), call.in(2), wrenches, call.states(0));
    });
  });
  return call.result(0);
}

Floats coriolisMatrix(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd,
                      const MaybeFloats& out) {
  const auto& coriolis = capability<ids::CoriolisMatrix>("coriolis_matrix", of);
  SolverCall call = callOf("coriolis_matrix", of, {{"q", q}, {"qd", qd}});
  call.matrices("out", out, jointsOf(of), jointsOf(of));
  call.run([&] { coriolis.getCoriolisMatrixBatch(call.in(0), call.in(1), call.matricesOf(0)); });
  return call.result(0);
}

FloatOrFloats kineticEnergy(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd) {
  const auto& energies = capability<ids::Energies>("kinetic_energy", of);
  SolverCall call = callOf("kinetic_energy", of, {{"q", q}, {"qd", qd}});
  call.numbers("out", py::none());
  call.run([&] { energies.getKineticEnergyBatch(call.in(0), call.in(1), call.numbersOf(0)); });
  return call.result(0)[py::tuple()];
}

FloatOrFloats potentialEnergy(const NamedSolver& of, const ArrayLike& q) {
  const auto& energies = capability<ids::Energies>("potential_energy", of);
  SolverCall call = callOf("potential_energy", of, {{"q", q}});
  call.numbers("out", py::none());
  call.run([&] { energies.getPotentialEnergyBatch(call.in(0), call.numbersOf(0)); });
  return call.result(0)[py::tuple()];
}

ThreeFloats torqueDerivatives(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd,
                              const ArrayLike& qdd) {
  const auto& derivatives = capability<ids::TorqueDerivatives>("torque_derivatives", of);
  SolverCall call = callOf("torque_derivatives", of, {{"q", q}, {"qd", qd}, {"qdd", qdd}});
  for (const char* name : {"dtau_dq", "dtau_dqd", "dtau_dqdd"}) {
    call.matrices(name, py::none(), jointsOf(of), jointsOf(of));
  }
  call.run([&] {
    derivatives.getTorqueDerivativesBatch(call.in(0), call.in(1), call.in(2), call.matricesOf(0),
                                          call.matricesOf(1), call.matricesOf(2));
  });
  return {call.result(0), call.result(1), call.result(2)};
}

Floats regressor(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd,
                 const ArrayLike& qdd, const MaybeFloats& out) {
  const auto& bodies = capability<ids::Regressor>("regressor", of);
  SolverCall call = callOf("regressor", of, {{"q", q}, {"qd", qd}, {"qdd", qdd}});
  call.matrices("out", out, jointsOf(of), 10 * jointsOf(of));
  call.run(
      [&] { bodies.getRegressorBatch(call.in(0), call.in(1), call.in(2), call.matricesOf(0)); });
  return call.result(0);
}

Floats accelerations(const NamedSolver& of, const ArrayLike& q, const ArrayLike& qd,
                     const ArrayLike& tau, const MaybeFloats& out) {
  const auto& forward = capability<ids::ForwardDynamics>("accelerations", of);
  SolverCall call = callOf("accelerations", of, {{"q", q}, {"qd", qd}, {"tau", tau}});
  call.vectors("out", out);
  call.run(
      [&] { forward.getAccelerationsBatch(call.in(0), call.in(1), call.in(2), call.states(0)); });
  return call.result(0);
}

}  // namespace inverse_dynamics_tools

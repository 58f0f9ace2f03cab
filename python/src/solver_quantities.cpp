// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <array>
#include <cstddef>
#include <inverse_dynamics_solver/coriolis_matrix.hpp>
#include <inverse_dynamics_solver/energies.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/external_wrench.hpp>
#include <inverse_dynamics_solver/forward_dynamics.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <inverse_dynamics_solver/regressor.hpp>
#include <inverse_dynamics_solver/torque_derivatives.hpp>
#include <string>
#include <vector>

#include "quantities.hpp"
#include "solver_class.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
namespace ids = inverse_dynamics_solver;

/// Calls compute() with the wrenches as the type of their frame.
template <class Compute>
void withWrenches(const ids::ConstStates& wrenches, const std::string& frame,
                  const Compute& compute) {
  if (frame == "tip") {
    compute(ids::WrenchesInTip(wrenches));
  } else {
    compute(ids::WrenchesInRoot(wrenches));
  }
}

/// Adds the wrench as the last argument of the call; returns the capability that computes with it.
const ids::ExternalWrench& contactOf(const Solver& solver, SolverCall& call,
                                     const py::object& wrench, const std::string& frame,
                                     const std::string& tip) {
  const auto& contact = solver.as<ids::ExternalWrench>(call.method());
  if (frame != "root" && frame != "tip") {
    throw ids::InvalidParameterValueException(ids::errorText(
        call.method() + std::string(": argument frame"), "",
        "'root' or 'tip': whose axes the wrench is expressed in", "'" + frame + "'"));
  }
  call.wrench("wrench", wrench);
  return tip.empty() ? contact : contact.externalWrenchAt(tip);
}

Floats externalTorques(const Solver& solver, const ArrayLike& q, const ArrayLike& wrench,
                       const std::string& frame, const std::string& tip, const MaybeFloats& out) {
  SolverCall call("external_torques", solver.joints());
  call.input("q", q);
  const auto& contact = contactOf(solver, call, wrench, frame, tip);
  call.result("out", out, {solver.get().jointCount()});
  call.run([&] {
    withWrenches(call.in(1), frame, [&](const auto& wrenches) {
      contact.getExternalTorquesBatch(call.in(0), wrenches, call.states(0));
    });
  });
  return call.array(0);
}

Floats torques(const Solver& solver, const ArrayLike& q, const ArrayLike& qd, const ArrayLike& qdd,
               const MaybeArrayLike& wrench, const std::string& frame, const std::string& tip,
               const MaybeFloats& out) {
  if (wrench.is_none() && frame != "root") {
    throw ids::InvalidParameterValueException(
        ids::errorText("torques: argument frame", "without effect", "a wrench whose axes it names",
                       "'" + frame + "' and no wrench", "give wrench=, or leave frame= out"));
  }
  if (wrench.is_none() && !tip.empty()) {
    throw ids::InvalidParameterValueException(
        ids::errorText("torques: argument tip", "without effect", "a wrench that it exerts",
                       "'" + tip + "' and no wrench", "give wrench=, or leave tip= out"));
  }
  SolverCall call("torques", solver.joints());
  call.input("q", q);
  call.input("qd", qd);
  call.input("qdd", qdd);
  const auto* const contact =
      wrench.is_none() ? nullptr : &contactOf(solver, call, wrench, frame, tip);
  call.result("out", out, {solver.get().jointCount()});
  const auto in = [&call](std::size_t i) { return call.in(i); };
  call.run([&] {
    if (contact == nullptr) {
      return solver.get().getTorquesBatch(in(0), in(1), in(2), call.states(0));
    }
    withWrenches(in(3), frame, [&](const auto& wrenches) {
      contact->getTorquesBatch(in(0), in(1), in(2), wrenches, call.states(0));
    });
  });
  return call.array(0);
}

Floats tipJacobianDerivative(const Solver& solver, const ArrayLike& q, const ArrayLike& qd,
                             const std::string& tip, const MaybeFloats& out) {
  SolverCall call("tip_jacobian_derivative", solver.joints());
  call.input("q", q);
  call.input("qd", qd);
  const auto& first = solver.as<ids::Kinematics>(call.method());
  const auto& kinematics = tip.empty() ? first : first.kinematicsOf(tip);
  call.result("out", out, {6, solver.get().jointCount()});
  call.run(
      [&] { kinematics.getTipJacobianDerivativeBatch(call.in(0), call.in(1), call.matrices(0)); });
  return call.array(0);
}

Floats frictionVector(const Solver& solver, const ArrayLike& qd, const MaybeArrayLike& q,
                      const MaybeFloats& out) {
  SolverCall call("friction_vector", solver.joints());
  call.input("qd", qd);
  if (!q.is_none()) call.input("q", q);
  call.result("out", out, {solver.get().jointCount()});
  call.run([&] {
    const ids::ConstStates unknown(call.in(0).data, 0, call.count(), 1, 0);
    solver.get().getFrictionVectorBatch(q.is_none() ? unknown : call.in(1), call.in(0),
                                        call.states(0));
  });
  return call.array(0);
}

/// The arrays of a tuple (H, c, g), or None for each.
std::array<py::object, 3> threeOf(const py::object& out) {
  if (out.is_none()) return {py::none(), py::none(), py::none()};
  if (!py::isinstance<py::tuple>(out) || py::len(out) != 3) {
    throw ids::InvalidParameterValueException(
        ids::errorText("dynamic_components: argument out", "", "a tuple (H, c, g) of arrays",
                       py::str(py::type::of(out).attr("__name__"))));
  }
  return {out[py::int_(0)], out[py::int_(1)], out[py::int_(2)]};
}

ThreeFloats dynamicComponents(const Solver& solver, const ArrayLike& q, const ArrayLike& qd,
                              const py::object& out) {
  const std::array<py::object, 3> outs = threeOf(out);
  const auto n = solver.get().jointCount();
  SolverCall call("dynamic_components", solver.joints());
  call.input("q", q);
  call.input("qd", qd);
  call.result("out[0]", outs[0], {n, n});
  call.result("out[1]", outs[1], {n});
  call.result("out[2]", outs[2], {n});
  call.run([&] {
    solver.get().getDynamicComponentsBatch(call.in(0), call.in(1), call.matrices(0), call.states(1),
                                           call.states(2));
  });
  return {call.array(0), call.array(1), call.array(2)};
}

inline constexpr Quantity kKineticEnergy{"kinetic_energy",
                                         std::array{"q", "qd"},
                                         std::array{kScalar},
                                         {"1/2 qd^T H qd [J], where H is symmetric.", "() or (N,)",
                                          "arm.kinetic_energy(q, qd).shape\n(100,)"}};
inline constexpr Quantity kPotentialEnergy{
    "potential_energy",
    std::array{"q"},
    std::array{kScalar},
    {"Of gravity [J], where H is symmetric; zero where all masses are at the root's origin.",
     "() or (N,)", "arm.potential_energy(q).shape\n(100,)"}};

/// Methods with further arguments.
void bindCalls(py::class_<Solver>& solver) {
  const py::kw_only keywords;
  const py::arg_v frame = "frame"_a = "root", tip = "tip"_a = "", out = "out"_a = py::none();
  const auto doc = [](const ResultText& text, const std::vector<std::string>& arguments) {
    return documented(text, arguments, Solver::kExample);
  };
  solver
      .def("torques", &torques, "q"_a, "qd"_a, "qdd"_a, keywords, "wrench"_a = py::none(), frame,
           tip, out,
           doc({"Joint torques tau = H(q) qdd + C(q, qd) qd + f(q, qd) + g(q); with a wrench\n"
                "+ J(q)^T wrench, as in external_torques().",
                "(n,) or (N, n)", "arm.torques(q, qd, qdd).shape\n(100, 6)"},
               {"q", "qd", "qdd", "wrench", "frame", "tip", "out"})
               .c_str())
      .def("external_torques", &externalTorques, "q"_a, "wrench"_a, frame, keywords, tip, out,
           doc({"J(q)^T wrench: what the joints add so that the tip exerts the wrench on its\n"
                "surroundings.",
                "(n,) or (N, n)", "arm.external_torques(q, [0, 0, -20, 0, 0, 0]).shape\n(100, 6)"},
               {"q", "wrench", "frame", "tip", "out"})
               .c_str())
      .def("tip_jacobian_derivative", &tipJacobianDerivative, "q"_a, "qd"_a, keywords, tip, out,
           doc({kTipJacobianDerivative.text.formula, kTipJacobianDerivative.text.shape,
                kTipJacobianDerivative.text.example},
               {"q", "qd", "tip", "out"})
               .c_str())
      .def("friction_vector", &frictionVector, "qd"_a, keywords, "q"_a = py::none(), out,
           doc({"Friction torques f(q, qd); zero if the solver has no friction model or was made\n"
                "without. q is needed where friction_depends_on_position.",
                "(n,) or (N, n)", "bool(arm.friction_vector(qd).any())\nFalse"},
               {"qd", "q", "out"})
               .c_str())
      .def("dynamic_components", &dynamicComponents, "q"_a, "qd"_a, keywords, out,
           doc({"H(q), C(q, qd) qd and g(q), faster than by three calls; out: a tuple of three.",
                "(n, n), (n,), (n,), or (N, n, n), (N, n), (N, n)",
                "H, c, g = arm.dynamic_components(q, qd)\n"
                "np.allclose(np.einsum(\"kij,kj->ki\", H, qdd) + c + g, arm.torques(q, qd, qdd))\n"
                "True"},
               {"q", "qd", "out"})
               .c_str());
}

}  // namespace

void bindQuantities(py::class_<Solver>& solver) {
  using S = const Solver&;
  using Part = const PartOfCall&;
  Quantities<Solver>(solver)
      .add(kInertiaMatrix,
           [](S s, Part p) { s.get().getInertiaMatrixBatch(p.in(0), p.matrices(0)); })
      .add(kCoriolisVector,
           [](S s, Part p) { s.get().getCoriolisVectorBatch(p.in(0), p.in(1), p.states(0)); })
      .add(kGravityVector, [](S s, Part p) { s.get().getGravityVectorBatch(p.in(0), p.states(0)); })
      .add(kTipPose,
           [](S s, Part p) {
             s.as<ids::Kinematics>(p).getTipPoseBatch(p.in(0), p.matrices(0), p.states(1));
           })
      .add(kCoriolisMatrix,
           [](S s, Part p) {
             s.as<ids::CoriolisMatrix>(p).getCoriolisMatrixBatch(p.in(0), p.in(1), p.matrices(0));
           })
      .add<FloatOrFloats>(kKineticEnergy,
                          [](S s, Part p) {
                            s.as<ids::Energies>(p).getKineticEnergyBatch(p.in(0), p.in(1),
                                                                         p.states(0));
                          })
      .add<FloatOrFloats>(
          kPotentialEnergy,
          [](S s, Part p) { s.as<ids::Energies>(p).getPotentialEnergyBatch(p.in(0), p.states(0)); })
      .add(kTorqueDerivatives,
           [](S s, Part p) {
             s.as<ids::TorqueDerivatives>(p).getTorqueDerivativesBatch(
                 p.in(0), p.in(1), p.in(2), p.matrices(0), p.matrices(1), p.matrices(2));
           })
      .add(kRegressor,
           [](S s, Part p) {
             s.as<ids::Regressor>(p).getRegressorBatch(p.in(0), p.in(1), p.in(2), p.matrices(0));
           })
      .add(kAccelerations,
           [](S s, Part p) {
             s.as<ids::ForwardDynamics>(p).getAccelerationsBatch(p.in(0), p.in(1), p.in(2),
                                                                 p.states(0));
           })
      .addJacobian(
          [](S s, Part p) { s.as<ids::Kinematics>(p).getTipJacobianBatch(p.in(0), p.matrices(0)); })
      .addPose([](S s, Part p) {
        s.as<ids::Kinematics>(p).getTipPoseBatch(p.in(0), p.matrices(0), p.states(1));
      });
  bindCalls(solver);
}

}  // namespace inverse_dynamics_tools

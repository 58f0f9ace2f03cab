// SPDX-License-Identifier: Apache-2.0
#include <chain_dynamics/friction_state.hpp>
#include <inverse_dynamics_solver/friction_memory.hpp>

#include "annotations.hpp"
#include "arrays.hpp"
#include "solver_class.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;

/// A state of a solver with n joints.
struct State {
  chain_dynamics::FrictionState state;
  py::ssize_t joints;
};

Eigen::Map<const Eigen::VectorXd> vectorOf(const State& of, const Array& array, const char* name) {
  requireShape(name, array, {of.joints});
  return {array.data(), of.joints};
}

Array torques(const State& of, const Array& qd) {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(of.joints);
  of.state.addTo(vectorOf(of, qd, "qd"), f);
  return arrayOf(f);
}

Array along(State& of, const Array& q, const Array& qd) {
  const py::ssize_t count = q.ndim() == 2 ? q.shape(0) : 0;
  requireShape("q", q, {count, of.joints});
  requireShape("qd", qd, {count, of.joints});
  Array result = like(q);
  Map f = columns(result);
  f.setZero();
  of.state.addAlong(states(q, "q"), states(qd, "qd"), f);
  return result;
}

TwoFloats rangeAlong(State& of, const Array& q, const Array& qd) {
  const py::ssize_t count = q.ndim() == 2 ? q.shape(0) : 0;
  requireShape("q", q, {count, of.joints});
  requireShape("qd", qd, {count, of.joints});
  Array both[] = {like(q), like(q)};
  Map least = columns(both[0]), most = columns(both[1]);
  least.setZero(), most.setZero();
  for (py::ssize_t k = 0; k < count; ++k) {
    of.state.move(states(q, "q").col(k));
    of.state.addRange(states(qd, "qd").col(k), least.col(k), most.col(k));
  }
  return {Floats(both[0]), Floats(both[1])};
}

Array unknown(const State& of) {
  Eigen::VectorXd half_width = Eigen::VectorXd::Zero(of.joints);
  of.state.addUnknown(half_width);
  return arrayOf(half_width);
}

}  // namespace

void bindFrictionState(py::module_& module, py::class_<Solver>& solver) {
  py::class_<State>(
      module, "FrictionState",
      "What friction remembers of a motion: friction_state.hpp. Threads: each its own.")
      .def_property_readonly(
          "remembers", [](const State& of) { return of.state.remembers(); },
          "Whether friction remembers anything; else all torques here are zero.")
      .def(
          "reset", [](State& of) { of.state.reset(); }, "Forgets the motion so far.")
      .def(
          "move", [](State& of, const Array& q) { of.state.move(vectorOf(of, q, "q")); }, "q"_a,
          "Goes on to the position q (n,) [rad; prismatic m], in the order of time.")
      .def("torques", &torques, "qd"_a,
           "(n,) N m (prismatic N) to be added to friction_vector() or torques() at qd (n,).")
      .def("along", &along, "q"_a, "qd"_a,
           "(N, n) N m (prismatic N) to be added to friction or torques of N states (N, n) in the\n"
           "order of time: move() and torques() of each.")
      .def("range_along", &rangeAlong, "q"_a, "qd"_a,
           "The least and the greatest that along() would give, (N, n) each, whatever the motion "
           "before\n"
           "the first state was.")
      .def_property_readonly("unknown", &unknown,
                             "(n,) N m (prismatic N): half the width of what isn't known.");
  solver.def(
      "friction_state",
      [](const Solver& of) {
        return State{inverse_dynamics_solver::frictionState(of.get()),
                     static_cast<py::ssize_t>(of.joints().size())};
      },
      R"(What friction remembers of a motion.

Friction and torques of a solver are the limit without memory; a state adds what friction remembers, if it does.

Returns
-------
FrictionState
    It knows nothing of the motion so far.)");
}

}  // namespace inverse_dynamics_tools

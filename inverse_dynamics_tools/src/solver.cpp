// SPDX-License-Identifier: Apache-2.0
#include "solver.hpp"

#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/motor_currents.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace ids = inverse_dynamics_solver;

/// What a solver was made from: enough to make it again elsewhere (pickle).
struct Origin {
  std::string plugin, urdf, root, tip;
  std::optional<std::array<double, 3>> gravity;
  bool friction = true;
  std::string attached;
  std::optional<std::string> model;
  std::map<std::string, ids::ParameterValue> parameters;
};

std::map<std::string, ids::ParameterValue> parametersOf(const Origin& origin) {
  auto all = origin.parameters;
  all["friction"] = origin.friction;
  // What isn't given is left to the solver: it may have a default of its own.
  if (!origin.root.empty()) all["root"] = origin.root;
  if (!origin.tip.empty()) all["tip"] = origin.tip;
  if (!origin.attached.empty()) all["attached"] = origin.attached;
  if (origin.model) all["model"] = *origin.model;
  if (origin.gravity) {
    all["gravity"] = std::vector<double>(origin.gravity->begin(), origin.gravity->end());
  }
  return all;
}

class Solver {
 public:
  explicit Solver(Origin origin) : origin_(std::move(origin)) {
    const py::gil_scoped_release release;
    solver_ = ids::SolverLoader().load(origin_.plugin);
    solver_->initialize(parametersOf(origin_), "", origin_.urdf);
  }

  const Origin& origin() const { return origin_; }
  const ids::InverseDynamicsSolver& get() const { return *solver_; }
  std::shared_ptr<const ids::InverseDynamicsSolver> shared() const { return solver_; }

  Array torques(const Array& q, const Array& qd, const Array& qdd) const {
    const ConstMap q_in = states(q, "q"), qd_in = states(qd, "qd"), qdd_in = states(qdd, "qdd");
    return vectors(q, [&](Map& out) { get().getTorquesBatch(q_in, qd_in, qdd_in, out); });
  }
  Array coriolisVector(const Array& q, const Array& qd) const {
    const ConstMap q_in = states(q, "q"), qd_in = states(qd, "qd");
    return vectors(q, [&](Map& out) { get().getCoriolisVectorBatch(q_in, qd_in, out); });
  }
  Array gravityVector(const Array& q) const {
    const ConstMap q_in = states(q, "q");
    return vectors(q, [&](Map& out) { get().getGravityVectorBatch(q_in, out); });
  }
  Array frictionVector(const Array& qd) const {
    const ConstMap qd_in = states(qd, "qd");
    return vectors(qd, [&](Map& out) { get().getFrictionVectorBatch(qd_in, out); });
  }
  py::array inertiaMatrix(const Array& q) const {
    const ConstMap q_in = states(q, "q");
    return matrices(q, [&](Map& out) { get().getInertiaMatrixBatch(q_in, out); });
  }
  py::tuple dynamicComponents(const Array& q, const Array& qd) const {
    const ConstMap q_in = states(q, "q"), qd_in = states(qd, "qd");
    Array c = like(q), g = like(q);
    Map c_out = columns(c), g_out = columns(g);
    const py::array H = matrices(
        q, [&](Map& H_out) { get().getDynamicComponentsBatch(q_in, qd_in, H_out, c_out, g_out); });
    return py::make_tuple(H, c, g);
  }

  /// Drive gains of a model identified in currents; None of any other.
  py::object driveGains() const {
    const auto* motors = dynamic_cast<const ids::MotorCurrents*>(solver_.get());
    if (motors == nullptr) return py::none();
    const Eigen::VectorXd gains = motors->getDriveGainsMatrix().diagonal();
    return Array(gains.size(), gains.data());
  }

 private:
  /// New array of the shape of `like_this`, written by `compute` without the GIL.
  template <class Compute>
  static Array vectors(const Array& like_this, Compute compute) {
    Array result = like(like_this);
    Map out = columns(result);
    {
      const py::gil_scoped_release release;
      compute(out);
    }
    return result;
  }

  /// New array (n, n) or (N, n, n), written by `compute` without the GIL as an n x (n N) matrix.
  /// H[k, i, j] is at row i, column k n + j of it: strides say so, nothing is turned round.
  template <class Compute>
  static py::array matrices(const Array& q, Compute compute) {
    const py::ssize_t n = q.shape(q.ndim() - 1), size = sizeof(double);
    std::vector<py::ssize_t> shape = {n, n}, strides = {size, n * size};
    if (q.ndim() == 2) {
      shape.insert(shape.begin(), q.shape(0));
      strides.insert(strides.begin(), n * n * size);
    }
    py::array_t<double> result(shape, strides);
    Map out(result.mutable_data(), n, n * (q.ndim() == 2 ? q.shape(0) : 1));
    {
      const py::gil_scoped_release release;
      compute(out);
    }
    return std::move(result);
  }

  Origin origin_;
  std::shared_ptr<ids::InverseDynamicsSolver> solver_;
};

/// A Python value as a parameter. pybind11 would take the first alternative it can convert to.
ids::ParameterValue parameterOf(const std::string& name, const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>();
  if (py::isinstance<py::int_>(value)) return value.cast<std::int64_t>();
  if (py::isinstance<py::float_>(value)) return value.cast<double>();
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (py::isinstance<py::sequence>(value)) {
    const auto all = [&](auto is) {
      for (const py::handle entry : value)
        if (!is(entry)) return false;
      return true;
    };
    if (all([](py::handle e) { return py::isinstance<py::str>(e); })) {
      return value.cast<std::vector<std::string>>();
    }
    if (all([](py::handle e) { return py::isinstance<py::bool_>(e); })) {
      return value.cast<std::vector<bool>>();
    }
    if (all([](py::handle e) { return py::isinstance<py::int_>(e); })) {
      return value.cast<std::vector<std::int64_t>>();
    }
    if (all([](py::handle e) {
          return py::isinstance<py::float_>(e) || py::isinstance<py::int_>(e);
        })) {
      return value.cast<std::vector<double>>();
    }
  }
  throw py::type_error("parameter '" + name +
                       "': expected bool, int, float, str or a list of one of them, got " +
                       std::string(py::str(py::type::of(value).attr("__name__"))));
}

std::unique_ptr<Solver> makeSolver(const std::string& plugin, const std::string& urdf,
                                   const std::string& root, const std::string& tip,
                                   const std::optional<std::array<double, 3>>& gravity,
                                   bool friction, const std::string& attached,
                                   const std::optional<std::string>& model,
                                   const py::dict& parameters) {
  Origin origin{plugin, urdf, root, tip, gravity, friction, attached, model, {}};
  for (const auto& [key, value] : parameters) {
    const auto name = key.cast<std::string>();
    origin.parameters[name] = parameterOf(name, value);
  }
  return std::make_unique<Solver>(std::move(origin));
}

/// How pickle makes the solver again: its class and the arguments.
py::tuple reduced(const py::object& self) {
  const Origin& o = self.cast<const Solver&>().origin();
  py::dict parameters;
  for (const auto& [name, value] : o.parameters) parameters[py::str(name)] = py::cast(value);
  return py::make_tuple(py::type::of(self),
                        py::make_tuple(o.plugin, o.urdf, o.root, o.tip, o.gravity, o.friction,
                                       o.attached, o.model, parameters));
}

}  // namespace

std::shared_ptr<const ids::InverseDynamicsSolver> solverOf(const py::handle& object) {
  return object.cast<const Solver&>().shared();
}

void bindSolver(py::module_& module) {
  module.def(
      "available_solvers", [] { return ids::SolverLoader().availableSolvers(); },
      "Names of the installed solver plugins, sorted; none if no workspace is sourced.");

  py::class_<Solver>(module, "Solver",
                     "An inverse dynamics solver, made by name and ready to compute.\n\n"
                     "Arrays are (n,), one state, or (N, n), one state a row; results have the\n"
                     "same shape. rad, rad/s, rad/s^2, N m (prismatic m, m/s, m/s^2, N); joints\n"
                     "in the order of joint_names. Threads: safe; the GIL is released.")
      .def(py::init(&makeSolver), py::arg("plugin"), py::arg("urdf") = "", py::arg("root") = "",
           py::arg("tip") = "", py::arg("gravity") = py::none(), py::arg("friction") = true,
           py::arg("attached") = "", py::arg("model") = py::none(),
           py::arg("parameters") = py::dict(),
           "plugin: package/Class, one of available_solvers(). urdf: text. root, tip: links;\n"
           "empty: the first and the last. gravity: 3 numbers, m/s^2, in the frame of the root\n"
           "link. friction: whether the solver adds its friction model. attached: 'lump' or\n"
           "'ignore' what hangs on the chain. model: file or name of a model. parameters: others\n"
           "of the solver, by name. What isn't given is left to the solver.\n\n"
           "Raises SolverError: see inverse_dynamics.errors.")
      .def_property_readonly("plugin", [](const Solver& s) { return s.origin().plugin; })
      .def_property_readonly(
          "joint_names", [](const Solver& s) { return py::tuple(py::cast(s.get().jointNames())); },
          "Names of the joints, from root to tip: the order of all arrays.")
      .def_property_readonly(
          "warnings", [](const Solver& s) { return py::tuple(py::cast(s.get().warnings())); },
          "What is odd about the robot but doesn't prevent computing, a sentence each.")
      .def_property_readonly(
          "inertia_is_physical", [](const Solver& s) { return s.get().inertiaIsPhysical(); },
          "Whether H is symmetric and positive definite by construction.")
      .def_property_readonly("drive_gains", &Solver::driveGains,
                             "(n,) N m/A (prismatic N/A) of a model identified in motor\n"
                             "currents; None of any other.")
      .def("torques", &Solver::torques, py::arg("q"), py::arg("qd"), py::arg("qdd"),
           "tau = H(q) qdd + C(q, qd) qd + f(qd) + g(q).")
      .def("inertia_matrix", &Solver::inertiaMatrix, py::arg("q"), "H(q), (n, n) or (N, n, n).")
      .def("coriolis_vector", &Solver::coriolisVector, py::arg("q"), py::arg("qd"), "C(q, qd) qd.")
      .def("gravity_vector", &Solver::gravityVector, py::arg("q"),
           "g(q): what holds the robot still.")
      .def("friction_vector", &Solver::frictionVector, py::arg("qd"),
           "f(qd); zero if the solver has no friction model or was made without.")
      .def("dynamic_components", &Solver::dynamicComponents, py::arg("q"), py::arg("qd"),
           "H(q), C(q, qd) qd, g(q).")
      .def("__reduce__", &reduced);
}

}  // namespace inverse_dynamics_tools

// SPDX-License-Identifier: Apache-2.0
#include "solver.hpp"

#include <pybind11/stl.h>

#include <array>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/load_friction.hpp>
#include <inverse_dynamics_solver/motor_currents.hpp>
#include <inverse_dynamics_solver/plausibility.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <inverse_dynamics_solver/torque_deviation.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "description.hpp"
#include "initialized.hpp"
#include "solver_call.hpp"
#include "solver_capabilities.hpp"
#include "solver_origin.hpp"
#include "solver_payload.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace ids = inverse_dynamics_solver;

/// What a function returns that may wait for other threads, which may need the interpreter.
template <class Read>
auto withoutInterpreter(const Read& read) {
  const py::gil_scoped_release release;
  return read();
}

/// A UserWarning, if there is a text.
void warn(const std::string& text) {
  if (!text.empty() && PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) {
    throw py::error_already_set();
  }
}

class Solver {
 public:
  explicit Solver(Origin origin) : origin_(std::move(origin)) {
    const py::gil_scoped_release release;
    solver_ = ids::SolverLoader().load(origin_.plugin);
    solver_->initialize(ids::Parameters(parametersOf(origin_)).strict(), "", origin_.urdf);
  }

  const Origin& origin() const { return origin_; }
  const ids::InverseDynamicsSolver& get() const { return *solver_; }
  NamedSolver named() const { return {*solver_, origin_.plugin}; }
  std::shared_ptr<const ids::InverseDynamicsSolver> shared() const { return solver_; }

  Floats torques(const ArrayLike& q, const ArrayLike& qd, const ArrayLike& qdd,
                 const MaybeArrayLike& wrench, const std::string& frame,
                 const MaybeFloats& out) const {
    if (!wrench.is_none()) return torquesWithWrench(named(), q, qd, qdd, wrench, frame, out);
    if (frame != "root") {
      throw ids::InvalidParameterValueException(ids::errorText(
          "torques: argument frame", "without effect", "a wrench whose axes it names",
          "'" + frame + "' and no wrench", "give wrench=, or leave frame= out"));
    }
    return vectors("torques", {{"q", q}, {"qd", qd}, {"qdd", qdd}}, out, [&](auto& call) {
      get().getTorquesBatch(call.in(0), call.in(1), call.in(2), call.states(0));
    });
  }
  Floats coriolisVector(const ArrayLike& q, const ArrayLike& qd, const MaybeFloats& out) const {
    return vectors("coriolis_vector", {{"q", q}, {"qd", qd}}, out, [&](auto& call) {
      get().getCoriolisVectorBatch(call.in(0), call.in(1), call.states(0));
    });
  }
  Floats gravityVector(const ArrayLike& q, const MaybeFloats& out) const {
    return vectors("gravity_vector", {{"q", q}}, out,
                   [&](auto& call) { get().getGravityVectorBatch(call.in(0), call.states(0)); });
  }
  Floats frictionVector(const ArrayLike& qd, const MaybeArrayLike& q,
                        const MaybeFloats& out) const {
    Arguments arguments = {{"qd", qd}};
    if (!q.is_none()) arguments.emplace_back("q", q);
    return vectors("friction_vector", arguments, out, [&](auto& call) {
      const ids::ConstStates unknown(call.in(0).data, 0, call.count(), 1, 0);
      get().getFrictionVectorBatch(q.is_none() ? unknown : call.in(1), call.in(0), call.states(0));
    });
  }
  Floats inertiaMatrix(const ArrayLike& q, const MaybeFloats& out) const {
    SolverCall call("inertia_matrix", get());
    call.input("q", q);
    call.matrices("out", out, get().jointCount(), get().jointCount());
    call.run([&] { get().getInertiaMatrixBatch(call.in(0), call.matricesOf(0)); });
    return call.result(0);
  }
  ThreeFloats dynamicComponents(const ArrayLike& q, const ArrayLike& qd,
                                const py::object& out) const {
    const char* const method = "dynamic_components";
    const std::array<py::object, 3> outs = threeOf(method, out);
    SolverCall call(method, get());
    call.input("q", q);
    call.input("qd", qd);
    call.matrices("out[0]", outs[0], get().jointCount(), get().jointCount());
    call.vectors("out[1]", outs[1]);
    call.vectors("out[2]", outs[2]);
    call.run([&] {
      get().getDynamicComponentsBatch(call.in(0), call.in(1), call.matricesOf(0), call.states(1),
                                      call.states(2));
    });
    return {call.result(0), call.result(1), call.result(2)};
  }

  void setPayload(const std::string& name, double mass, const MaybeArrayLike& center_of_mass,
                  const MaybeArrayLike& inertia, const MaybeArrayLike& frame) {
    auto& payload = capability<ids::Payload>("set_payload");
    const ids::RigidBody body = bodyOf(mass, center_of_mass, inertia, frame);
    withoutInterpreter([&] { payload.setPayload(name, body); });
    warn(ids::doubtOf(body));
  }
  bool removePayload(const std::string& name) {
    auto& payload = capability<ids::Payload>("remove_payload");
    const py::gil_scoped_release release;
    return payload.removePayload(name);
  }
  void clearPayloads() {
    auto& payload = capability<ids::Payload>("clear_payloads");
    const py::gil_scoped_release release;
    payload.clearPayloads();
  }
  bool isChangeable() const {
    return dynamic_cast<const ids::Payload*>(solver_.get()) != nullptr &&
           dynamic_cast<const ids::VariableGravity*>(solver_.get()) != nullptr;
  }
  // What is set waits for a change, which waits for batches: without the interpreter's lock.
  ids::Payloads payloads() {
    auto& payload = capability<ids::Payload>("payloads");
    return withoutInterpreter([&] { return payload.payloads(); });
  }

  void setGravity(const ArrayLike& gravity) {
    auto& mount = capability<ids::VariableGravity>("set_gravity");
    const Eigen::Vector3d numbers = vectorOf("set_gravity: argument gravity", gravity);
    withoutInterpreter([&] { mount.setGravity(numbers); });
    warn(ids::doubtOf(numbers));
  }
  void setBaseAcceleration(const ArrayLike& acceleration) {
    auto& mount = capability<ids::VariableGravity>("set_base_acceleration");
    const Eigen::Vector3d numbers =
        vectorOf("set_base_acceleration: argument acceleration", acceleration);
    const py::gil_scoped_release release;
    mount.setBaseAcceleration(numbers);
  }
  Floats gravity() {
    auto& mount = capability<ids::VariableGravity>("gravity");
    return arrayOf(withoutInterpreter([&] { return mount.gravity(); }));
  }
  Floats baseAcceleration() {
    auto& mount = capability<ids::VariableGravity>("base_acceleration");
    return arrayOf(withoutInterpreter([&] { return mount.baseAcceleration(); }));
  }

  /// Drive gains of a model identified in currents; None of any other.
  MaybeFloats driveGains() const {
    const auto* motors = dynamic_cast<const ids::MotorCurrents*>(solver_.get());
    if (motors == nullptr) return py::none();
    const Eigen::VectorXd gains = motors->getDriveGainsMatrix().diagonal();
    return py::array_t<double>(gains.size(), gains.data());
  }

  bool frictionDependsOnPosition() const { return ids::frictionDependsOnPosition(*solver_); }

  /// Half the width of the band that holds 95 % of the torques; None where it is unknown.
  MaybeFloats torqueDeviation() const {
    const auto* band = dynamic_cast<const ids::TorqueDeviation*>(solver_.get());
    if (band == nullptr || !band->hasTorqueDeviation()) return py::none();
    const Eigen::VectorXd deviation = band->getTorqueDeviation();
    return py::array_t<double>(deviation.size(), deviation.data());
  }

  /// n: "revolute", "continuous" or "prismatic".
  NameTuple jointTypes() const {
    const auto name = [](chain_dynamics::JointType type) {
      return type == chain_dynamics::JointType::kPrismatic    ? "prismatic"
             : type == chain_dynamics::JointType::kContinuous ? "continuous"
                                                              : "revolute";
    };
    std::vector<std::string> names;
    for (const auto type : get().jointTypes()) names.emplace_back(name(type));
    return tupleOf(names);
  }

  /// (3, n, 2): q, qd, qdd; joint; least and greatest. None where it is unknown.
  MaybeFloats seenRanges() const {
    const auto* band = dynamic_cast<const ids::TorqueDeviation*>(solver_.get());
    if (band == nullptr || band->seenRanges().empty()) return py::none();
    const auto& ranges = band->seenRanges();
    py::array_t<double> result(
        {py::ssize_t{3}, static_cast<py::ssize_t>(ranges.size()), py::ssize_t{2}});
    for (std::size_t j = 0; j < ranges.size(); ++j) {
      const chain_dynamics::Interval of_joint[] = {ranges[j].q, ranges[j].qd, ranges[j].qdd};
      for (int k = 0; k < 3; ++k) {
        result.mutable_at(k, j, 0) = of_joint[k].lower;
        result.mutable_at(k, j, 1) = of_joint[k].upper;
      }
    }
    return py::object(std::move(result));  // GCC 14 calls a plain move redundant, others need one
  }

 private:
  using Arguments = std::vector<std::pair<const char*, py::object>>;

  template <class Capability>
  Capability& capability(const char* method) {
    return capabilityOf<Capability>(*solver_, method, origin_.plugin);
  }

  template <class Compute>
  Floats vectors(const char* method, const Arguments& arguments, const MaybeFloats& out,
                 Compute compute) const {
    SolverCall call(method, get());
    for (const auto& [name, values] : arguments) call.input(name, values);
    call.vectors("out", out);
    call.run([&] { compute(call); });
    return call.result(0);
  }

  /// The arrays of a tuple (H, c, g), or None for each.
  static std::array<py::object, 3> threeOf(const char* method, const py::object& out) {
    if (out.is_none()) return {py::none(), py::none(), py::none()};
    if (!py::isinstance<py::tuple>(out) || py::len(out) != 3) {
      throw ids::InvalidParameterValueException(
          ids::errorText(std::string(method) + ": argument out", "", "a tuple (H, c, g) of arrays",
                         py::str(py::type::of(out).attr("__name__"))));
    }
    return {out[py::int_(0)], out[py::int_(1)], out[py::int_(2)]};
  }

  Origin origin_;
  std::shared_ptr<ids::InverseDynamicsSolver> solver_;
};

}  // namespace
}  // namespace inverse_dynamics_tools

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_tools::Solver)

namespace inverse_dynamics_tools {
namespace {

std::unique_ptr<Solver> makeSolver(const std::string& plugin, const Description& urdf,
                                   const std::string& root, const std::string& tip,
                                   const std::optional<std::array<double, 3>>& gravity,
                                   bool friction, const std::string& attached,
                                   const std::optional<std::string>& model,
                                   const ParameterDict& parameters) {
  Origin origin{plugin, urdf.text, root, tip, gravity, friction, attached, model, {}};
  for (const auto& [key, value] : py::dict(parameters)) {
    addParameter(key.cast<std::string>(), value, origin.parameters);
  }
  return std::make_unique<Solver>(std::move(origin));
}

/// How pickle and copy make the solver again: of the same arguments, with what was set since.
py::tuple reduced(const py::object& self) {
  auto& solver = self.cast<Solver&>();
  const py::tuple arguments = argumentsOf(solver.origin());
  if (!solver.isChangeable()) return py::make_tuple(py::type::of(self), arguments);
  return py::make_tuple(
      py::module_::import("inverse_dynamics.base.restored").attr("restored_solver"),
      py::make_tuple(py::type::of(self), arguments, solver.payloads(), solver.gravity(),
                     solver.baseAcceleration()));
}

/// A function of a solver as a method.
template <class Result, class... Values>
auto of(Result (*function)(const NamedSolver&, Values...)) {
  return [function](const Solver& solver, Values... values) {
    return function(solver.named(), values...);
  };
}

void bindCapabilities(py::class_<Solver>& solver) {
  const py::arg q("q"), qd("qd"), qdd("qdd"), tau("tau"), wrench("wrench");
  const py::arg_v frame = py::arg("frame") = "root", out = py::arg("out") = py::none();
  const py::kw_only keywords;
  solver
      .def("tip_pose", of(&tipPose), q,
           "Pose of the tip in the root frame: R, (3, 3) or (N, 3, 3), and p, (3,) or (N, 3).")
      .def("tip_jacobian", of(&tipJacobian), q, keywords, out,
           "J(q), (6, n) or (N, 6, n): [v, w] = J qd is the velocity of the tip's origin, linear\n"
           "first, in the axes of the root frame.")
      .def("tip_jacobian_derivative", of(&tipJacobianDerivative), q, qd, keywords, out,
           "dJ/dt where q moves with qd, in the shape of J.")
      .def("external_torques", of(&externalTorques), q, wrench, frame, keywords, out,
           "J(q)^T wrench: what the joints add so that the tip exerts the wrench on its\n"
           "surroundings. wrench: (6,) or (N, 6), force [N] and torque [N m] about the tip's\n"
           "origin, in the axes of frame, 'root' or 'tip'.")
      .def("coriolis_matrix", of(&coriolisMatrix), q, qd, keywords, out,
           "C(q, qd) of Christoffel's symbols, (n, n) or (N, n, n).")
      .def("kinetic_energy", of(&kineticEnergy), q, qd,
           "1/2 qd^T H qd [J], a number or (N,); where H is symmetric.")
      .def("potential_energy", of(&potentialEnergy), q,
           "Of gravity [J], a number or (N,); zero where all masses are at the root's origin.\n"
           "Where H is symmetric.")
      .def("torque_derivatives", of(&torqueDerivatives), q, qd, qdd,
           "dtau/dq, dtau/dqd and dtau/dqdd = H, (n, n) or (N, n, n) each, friction included.")
      .def("regressor", of(&regressor), q, qd, qdd, keywords, out,
           "Y, (n, 10 n) or (N, n, 10 n): torques of rigid bodies are Y p.")
      .def("accelerations", of(&accelerations), q, qd, tau, keywords, out,
           "qdd under these torques, friction subtracted.");
}

std::string represented(const Solver& solver) {
  const std::vector<std::string>& joints = solver.get().jointNames();
  const std::string number = std::to_string(joints.size());
  return "<Solver " + solver.origin().plugin + ": " +
         (joints.size() == 1 ? "joint " + joints[0]
                             : number + " joints, " + joints.front() + " to " + joints.back()) +
         ">";
}

}  // namespace

std::shared_ptr<const ids::InverseDynamicsSolver> solverOf(const py::handle& object) {
  if (!py::isinstance<Solver>(object)) {
    throw py::type_error(ids::errorText("argument solver", "", "a Solver",
                                        py::str(py::type::handle_of(object).attr("__name__"))));
  }
  return object.cast<const Solver&>().shared();
}

void bindSolver(py::module_& module) {
  module.def(
      "available_solvers", [] { return ids::SolverLoader().availableSolvers(); },
      "Names of the installed solver plugins, sorted; none if no workspace is sourced.");

  py::class_<Solver> solver(
      module, "Solver",
      "An inverse dynamics solver, made by name and ready to compute.\n\n"
      "Arrays are (n,), one state, or (N, n), one state per row; results have the\n"
      "same shape. rad, rad/s, rad/s^2, N m (prismatic m, m/s, m/s^2, N); joints\n"
      "in the order of joint_names. out: an array of doubles that takes the result.\n"
      "Any layout, without copies. Threads: safe; the GIL is released. Pickled, it is\n"
      "made again.");
  solver
      .def(
          py::init(&makeSolver), py::arg("plugin"), py::arg("urdf") = "", py::arg("root") = "",
          py::arg("tip") = "", py::arg("gravity") = py::none(), py::arg("friction") = true,
          py::arg("attached") = "", py::arg("model") = py::none(),
          py::arg("parameters") = py::dict(),
          "plugin: package/Class, one of available_solvers(). urdf: its text, or the path\n"
          "of a .urdf or .xacro file. root, tip: links; empty: the first and the last. gravity:\n"
          "3 numbers, m/s^2, in the frame of the root link. friction: whether the solver adds its\n"
          "friction model. attached: 'lump' or 'ignore' the links that are attached to the chain.\n"
          "model: file or name of a model. parameters: other parameters of the solver, by name;\n"
          "batch_threads: number of threads that may share a large batch. Arguments that are not\n"
          "given have the solver's defaults.\n\n"
          "Raises SolverError: see inverse_dynamics.errors.")
      .def_property_readonly("plugin", [](const Solver& s) { return s.origin().plugin; })
      .def_property_readonly(
          "joint_names", [](const Solver& s) { return tupleOf(s.get().jointNames()); },
          "Names of the joints, from root to tip: the order of all arrays.")
      .def_property_readonly("joint_types", &Solver::jointTypes,
                             "revolute, continuous or prismatic, of each joint. Positions of a\n"
                             "continuous joint that differ by whole turns are the same.")
      .def_property_readonly(
          "warnings", [](const Solver& s) { return tupleOf(s.get().warnings()); },
          "Warnings about the robot that don't prevent computing, one sentence each.")
      .def_property_readonly(
          "inertia_is_physical", [](const Solver& s) { return s.get().inertiaIsPhysical(); },
          "Whether H is symmetric and positive definite by construction.")
      .def_property_readonly("drive_gains", &Solver::driveGains,
                             "(n,) N m/A (prismatic N/A) of a model identified in motor\n"
                             "currents; None of any other.")
      .def_property_readonly("friction_depends_on_position", &Solver::frictionDependsOnPosition,
                             "Whether friction grows with the gravity torques: then\n"
                             "friction_vector() needs q.")
      .def_property_readonly(
          "torque_deviation", &Solver::torqueDeviation,
          "(n,) N m (prismatic N): half the width of the band that holds 95 %\n"
          "of the differences between measured and computed torques of data\n"
          "that weren't used to identify; None where the model doesn't state it.")
      .def_property_readonly("seen", &Solver::seenRanges,
                             "(3, n, 2): least and greatest q, qd, qdd of the data of\n"
                             "identification; None where the model doesn't state it.")
      .def("torques", &Solver::torques, py::arg("q"), py::arg("qd"), py::arg("qdd"), py::kw_only(),
           py::arg("wrench") = py::none(), py::arg("frame") = "root", py::arg("out") = py::none(),
           "tau = H(q) qdd + C(q, qd) qd + f(q, qd) + g(q); with a wrench + J(q)^T wrench, as in\n"
           "external_torques(); frame='tip' without a wrench is an error.")
      .def("inertia_matrix", &Solver::inertiaMatrix, py::arg("q"), py::kw_only(),
           py::arg("out") = py::none(), "H(q), (n, n) or (N, n, n).")
      .def("coriolis_vector", &Solver::coriolisVector, py::arg("q"), py::arg("qd"), py::kw_only(),
           py::arg("out") = py::none(), "C(q, qd) qd.")
      .def("gravity_vector", &Solver::gravityVector, py::arg("q"), py::kw_only(),
           py::arg("out") = py::none(), "g(q): what holds the robot still.")
      .def("friction_vector", &Solver::frictionVector, py::arg("qd"), py::kw_only(),
           py::arg("q") = py::none(), py::arg("out") = py::none(),
           "f(q, qd); zero if the solver has no friction model or was made without. q is needed\n"
           "where friction_depends_on_position.")
      .def("dynamic_components", &Solver::dynamicComponents, py::arg("q"), py::arg("qd"),
           py::kw_only(), py::arg("out") = py::none(),
           "H(q), C(q, qd) qd, g(q); out: a tuple of three arrays.")
      .def("set_payload", &Solver::setPayload, py::arg("name"), py::arg("mass"),
           py::arg("center_of_mass") = py::none(), py::arg("inertia") = py::none(),
           py::arg("frame") = py::none(),
           "Adds a rigid body to the tip, or replaces the one of that name, also while other\n"
           "threads compute. mass: kg. center_of_mass: (3,) m, in the body's frame. inertia: (3, "
           "3)\n"
           "or ixx ixy ixz iyy iyz izz, kg m^2, about the center of mass, in the axes of the\n"
           "body's frame; none: a point mass. frame: (4, 4) pose of that frame in the tip frame.\n"
           "A UserWarning for a body that is implausible: 5 m away, for one.")
      .def("remove_payload", &Solver::removePayload, py::arg("name"),
           "Takes a body away; False if there is none of that name.")
      .def("clear_payloads", &Solver::clearPayloads, "Takes all bodies away.")
      .def_property_readonly("payloads", &Solver::payloads,
                             "The bodies: name to the arguments of set_payload().")
      .def("set_gravity", &Solver::setGravity, py::arg("gravity"),
           "Sets the gravitational acceleration: (3,) m/s^2, in the axes of the root link.\n"
           "A UserWarning where it is implausible: 981, for one.")
      .def("set_base_acceleration", &Solver::setBaseAcceleration, py::arg("acceleration"),
           "How the root link accelerates, (3,) m/s^2 in its axes. Not for a base that rotates.")
      .def_property_readonly("gravity", &Solver::gravity, "(3,) m/s^2.")
      .def_property_readonly("base_acceleration", &Solver::baseAcceleration, "(3,) m/s^2.")
      .def("__repr__", &represented)
      .def("__reduce__", &reduced);
  bindCapabilities(solver);
}

}  // namespace inverse_dynamics_tools

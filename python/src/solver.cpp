// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <array>
#include <chain_dynamics/chain.hpp>
#include <chain_dynamics/model.hpp>
#include <chain_dynamics/model_file.hpp>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <inverse_dynamics_evaluation/effort.hpp>
#include <inverse_dynamics_evaluation/run_configuration.hpp>
#include <inverse_dynamics_solver/coriolis_matrix.hpp>
#include <inverse_dynamics_solver/energies.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/external_wrench.hpp>
#include <inverse_dynamics_solver/forward_dynamics.hpp>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <inverse_dynamics_solver/load_friction.hpp>
#include <inverse_dynamics_solver/motor_currents.hpp>
#include <inverse_dynamics_solver/parameters.hpp>
#include <inverse_dynamics_solver/payload.hpp>
#include <inverse_dynamics_solver/plausibility.hpp>
#include <inverse_dynamics_solver/regressor.hpp>
#include <inverse_dynamics_solver/solver_loader.hpp>
#include <inverse_dynamics_solver/torque_derivatives.hpp>
#include <inverse_dynamics_solver/torque_deviation.hpp>
#include <inverse_dynamics_solver/variable_gravity.hpp>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bindings.hpp"
#include "description.hpp"
#include "parameters.hpp"
#include "quantities.hpp"
#include "solver_payload.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
namespace ids = inverse_dynamics_solver;
using Robot = inverse_dynamics_evaluation::RunConfiguration;
using SolverName = std::variant<Robot, PathText>;

/// The arguments that made a solver: enough to make it again elsewhere (pickle).
struct Origin {
  std::string plugin, urdf;
  ParameterValues parameters;
  Robot robot;  // that has these arguments
};

/// Names of the installed solvers for which `has` is true.
template <class Has>
std::string solversThat(const Has& has) {
  const ids::SolverLoader loader;
  std::string names;
  for (const std::string& name : loader.availableSolvers()) {
    try {
      if (has(*loader.load(name))) names += (names.empty() ? "" : ", ") + name;
    } catch (const ids::Exception&) {  // don't recommend a solver that can't be loaded
    }
  }
  return names;
}

/// A UserWarning, if there is a text.
void warn(const std::string& text) {
  if (!text.empty() && PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) {
    throw py::error_already_set();
  }
}

/// The chain whose links and joints may be given as frames of Jacobians.
FramesOf framesOf(const ParameterValues& parameters, std::vector<std::string> joints) {
  const std::string locked = "locked_joints.";
  FramesOf of{"", std::move(joints), {}};
  for (const auto& [name, value] : parameters) {
    const auto* const position = std::get_if<double>(&value);
    if (name == "root") of.root = std::get<std::string>(value);
    if (position && name.rfind(locked, 0) == 0) of.locked[name.substr(locked.size())] = *position;
  }
  return of;
}

class Solver {
 public:
  static constexpr const char* kExample = "Solver(urdf=load_robot(\"ur10_simulated\").urdf)";

  explicit Solver(Origin origin) : origin_(std::move(origin)) {
    const py::gil_scoped_release release;
    solver_ = ids::SolverLoader().load(origin_.plugin);
    solver_->initialize(ids::Parameters(origin_.parameters).strict(), "", origin_.urdf);
    frames_ = std::make_unique<Frames>(origin_.urdf, framesOf(origin_.parameters, joints()));
  }

  const Origin& origin() const { return origin_; }
  const ids::InverseDynamicsSolver& get() const { return *solver_; }
  std::shared_ptr<const ids::InverseDynamicsSolver> shared() const { return solver_; }
  const std::vector<std::string>& joints() const { return solver_->jointNames(); }
  const Frames& frames() const { return *frames_; }

  /// A capability; null if this solver lacks it.
  template <class Capability>
  Capability* find() const {
    return dynamic_cast<Capability*>(solver_.get());
  }

  /// @throws Exception  this solver lacks it; names those that have it. `method` begins the text.
  template <class Capability>
  Capability& as(const std::string& method) const {
    if (auto* const found = find<Capability>()) return *found;
    const std::string others = solversThat(
        [](const auto& solver) { return dynamic_cast<const Capability*>(&solver) != nullptr; });
    throw ids::Exception(ids::errorText(method, "this solver doesn't compute it",
                                        others.empty() ? "a solver that does" : "one of " + others,
                                        origin_.plugin, "make another Solver for it"));
  }

  template <class Capability>
  Capability& as(const PartOfCall& part) const {
    return as<Capability>(part.call.method());
  }

  template <class OfPart>
  void compute(const SolverCall& call, const OfPart& of_part) const {
    call.run([&] { of_part(PartOfCall{call, 0, call.count()}); });
  }

 private:
  Origin origin_;
  std::shared_ptr<ids::InverseDynamicsSolver> solver_;
  std::unique_ptr<const Frames> frames_;
};

// ---------------------------------------------------------------- torques

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
                                     const py::object& wrench, const std::string& frame) {
  const auto& contact = solver.as<ids::ExternalWrench>(call.method());
  if (frame != "root" && frame != "tip") {
    throw ids::InvalidParameterValueException(ids::errorText(
        call.method() + std::string(": argument frame"), "",
        "'root' or 'tip': whose axes the wrench is expressed in", "'" + frame + "'"));
  }
  call.wrench("wrench", wrench);
  return contact;
}

Floats externalTorques(const Solver& solver, const ArrayLike& q, const ArrayLike& wrench,
                       const std::string& frame, const MaybeFloats& out) {
  SolverCall call("external_torques", solver.joints());
  call.input("q", q);
  const auto& contact = contactOf(solver, call, wrench, frame);
  call.result("out", out, {solver.get().jointCount()});
  call.run([&] {
    withWrenches(call.in(1), frame, [&](const auto& wrenches) {
      contact.getExternalTorquesBatch(call.in(0), wrenches, call.states(0));
    });
  });
  return call.array(0);
}

Floats torques(const Solver& solver, const ArrayLike& q, const ArrayLike& qd, const ArrayLike& qdd,
               const MaybeArrayLike& wrench, const std::string& frame, const MaybeFloats& out) {
  if (wrench.is_none() && frame != "root") {
    throw ids::InvalidParameterValueException(
        ids::errorText("torques: argument frame", "without effect", "a wrench whose axes it names",
                       "'" + frame + "' and no wrench", "give wrench=, or leave frame= out"));
  }
  SolverCall call("torques", solver.joints());
  call.input("q", q);
  call.input("qd", qd);
  call.input("qdd", qdd);
  const auto* const contact = wrench.is_none() ? nullptr : &contactOf(solver, call, wrench, frame);
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

// ---------------------------------------------------------------- capabilities

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

/// Quantities that depend on states only.
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
      .add(kTipJacobianDerivative,
           [](S s, Part p) {
             s.as<ids::Kinematics>(p).getTipJacobianDerivativeBatch(p.in(0), p.in(1),
                                                                    p.matrices(0));
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
}

/// Methods with further arguments.
void bindCalls(py::class_<Solver>& solver) {
  const py::kw_only keywords;
  const py::arg_v frame = "frame"_a = "root", out = "out"_a = py::none();
  const auto doc = [](const ResultText& text, const std::vector<std::string>& arguments) {
    return documented(text, arguments, Solver::kExample);
  };
  solver
      .def("torques", &torques, "q"_a, "qd"_a, "qdd"_a, keywords, "wrench"_a = py::none(), frame,
           out,
           doc({"Joint torques tau = H(q) qdd + C(q, qd) qd + f(q, qd) + g(q); with a wrench\n"
                "+ J(q)^T wrench, as in external_torques().",
                "(n,) or (N, n)", "arm.torques(q, qd, qdd).shape\n(100, 6)"},
               {"q", "qd", "qdd", "wrench", "frame", "out"})
               .c_str())
      .def("external_torques", &externalTorques, "q"_a, "wrench"_a, frame, keywords, out,
           doc({"J(q)^T wrench: what the joints add so that the tip exerts the wrench on its\n"
                "surroundings.",
                "(n,) or (N, n)", "arm.external_torques(q, [0, 0, -20, 0, 0, 0]).shape\n(100, 6)"},
               {"q", "wrench", "frame", "out"})
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

// ---------------------------------------------------------------- properties

MaybeFloats arrayOrNone(const Eigen::VectorXd& vector) {
  if (vector.size() == 0) return py::none();
  return arrayOf(vector);
}

MaybeFloats driveGains(const Solver& solver) {
  const auto* motors = solver.find<ids::MotorCurrents>();
  return arrayOrNone(motors ? motors->getDriveGainsMatrix().diagonal() : Eigen::VectorXd());
}

MaybeFloats torqueDeviation(const Solver& solver) {
  const auto* band = solver.find<ids::TorqueDeviation>();
  const bool known = band != nullptr && band->hasTorqueDeviation();
  return arrayOrNone(known ? band->getTorqueDeviation() : Eigen::VectorXd());
}

NameTuple jointTypes(const Solver& solver) {
  const auto name = [](chain_dynamics::JointType type) {
    return type == chain_dynamics::JointType::kPrismatic    ? "prismatic"
           : type == chain_dynamics::JointType::kContinuous ? "continuous"
                                                            : "revolute";
  };
  std::vector<std::string> names;
  for (const auto type : solver.get().jointTypes()) names.emplace_back(name(type));
  return tupleOf(names);
}

MaybeFloats seenRanges(const Solver& solver) {
  const auto* band = solver.find<ids::TorqueDeviation>();
  if (band == nullptr || band->seenRanges().empty()) return py::none();
  const auto& ranges = band->seenRanges();
  py::array_t<double> result(Shape{3, static_cast<py::ssize_t>(ranges.size()), 2});
  for (std::size_t j = 0; j < ranges.size(); ++j) {
    const chain_dynamics::Interval of_joint[] = {ranges[j].q, ranges[j].qd, ranges[j].qdd};
    for (int k = 0; k < 3; ++k) {
      result.mutable_at(k, j, 0) = of_joint[k].lower;
      result.mutable_at(k, j, 1) = of_joint[k].upper;
    }
  }
  return py::object(std::move(result));  // GCC 14 calls a plain move redundant, others need one
}

/// A text among the parameters; empty: none.
std::string textParameter(const Solver& solver, const std::string& name) {
  const auto& parameters = solver.origin().parameters;
  const auto found = parameters.find(name);
  const auto* const text =
      found == parameters.end() ? nullptr : std::get_if<std::string>(&found->second);
  return text == nullptr ? "" : *text;
}

/// Of the description, a RobotDescription of Python.
py::object describedBy(const Solver& solver) {
  return py::module_::import("inverse_dynamics._core")
      .attr("RobotDescription")(solver.origin().urdf);
}

std::string rootOf(const Solver& solver) {
  std::string stated = textParameter(solver, "root");
  if (!stated.empty() || solver.origin().urdf.empty()) return stated;
  return describedBy(solver).attr("root").cast<std::string>();
}

std::string tipOf(const Solver& solver) {
  std::string stated = textParameter(solver, "tip");
  if (!stated.empty() || solver.origin().urdf.empty()) return stated;
  return describedBy(solver).attr("tip")(solver.joints().back()).cast<std::string>();
}

/// (n,) each, by name; infinite where none is stated.
ParameterDict limitsOf(const Solver& solver) {
  py::list stated;
  const std::string model = textParameter(solver, "model");
  if (!solver.origin().urdf.empty()) {
    const py::object chain =
        describedBy(solver).attr("chain")(tupleOf(solver.joints()), textParameter(solver, "root"));
    for (const auto& joint : chain) stated.append(joint.attr("limits"));
  } else if (std::filesystem::is_regular_file(model)) {
    const chain_dynamics::Model read = chain_dynamics::modelFromFile(model);
    for (const auto& joint : read.chain.joints()) {
      const auto& limits = joint.limits;
      py::dict of_joint("lower"_a = limits.lower, "upper"_a = limits.upper);
      for (const auto& [name, limit] :
           {std::pair("velocity", limits.velocity), std::pair("effort", limits.effort),
            std::pair("acceleration", limits.acceleration),
            std::pair("deceleration", limits.deceleration), std::pair("jerk", limits.jerk)}) {
        if (limit > 0 && std::isfinite(limit)) of_joint[name] = limit;  // zero states none
      }
      stated.append(of_joint);
    }
  }
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const auto n = static_cast<Eigen::Index>(solver.joints().size());
  std::map<std::string, Eigen::VectorXd> found;
  for (const char* const name : {"lower", "upper", "velocity", "effort"}) {
    found[name].setConstant(n, name == std::string("lower") ? -kNone : kNone);
  }
  for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(stated.size()); ++j) {
    for (const auto& [name, value] : py::dict(stated[static_cast<std::size_t>(j)])) {
      const auto [of, is_new] = found.try_emplace(name.cast<std::string>());
      if (is_new) of->second.setConstant(n, kNone);
      of->second[j] = value.cast<double>();
    }
  }
  py::dict limits;
  for (const auto& [name, values] : found) limits[name.c_str()] = arrayOf(values);
  return ParameterDict(limits);
}

void bindProperties(py::class_<Solver>& solver) {
  solver
      .def_property_readonly(
          "plugin", [](const Solver& s) { return s.origin().plugin; }, "package/Class.")
      .def_property_readonly(
          "robot", [](const Solver& s) { return s.origin().robot; },
          "The run configuration that the solver was made of, with all arguments.")
      .def_property_readonly(
          "urdf", [](const Solver& s) { return s.origin().urdf; },
          "Text of the robot description; empty: none was given.")
      .def_property_readonly("root", &rootOf,
                             "Link that the chain begins at; empty: no description says it.")
      .def_property_readonly("tip", &tipOf,
                             "Link that the chain ends at; empty: no description says it.")
      .def_property_readonly(
          "limits", &limitsOf,
          "Of the joints, by name, (n,) each: lower, upper (rad, m), velocity\n"
          "(rad/s, m/s), effort (N m, N) and what else the description or the model\n"
          "file states. Infinite where nothing is stated.")
      .def_property_readonly(
          "joint_names", [](const Solver& s) { return tupleOf(s.joints()); },
          "Names of the joints, from root to tip: the order of all arrays.")
      .def_property_readonly("joint_types", &jointTypes,
                             "revolute, continuous or prismatic, of each joint. Positions of a\n"
                             "continuous joint that differ by whole turns are the same.")
      .def_property_readonly(
          "warnings", [](const Solver& s) { return tupleOf(s.get().warnings()); },
          "Warnings about the robot that don't prevent computing, one sentence each.")
      .def_property_readonly(
          "inertia_is_physical", [](const Solver& s) { return s.get().inertiaIsPhysical(); },
          "Whether H is symmetric and positive definite by construction.")
      .def_property_readonly("drive_gains", &driveGains,
                             "(n,) N m/A (prismatic N/A) of a model identified in motor\n"
                             "currents; None of any other.")
      .def_property_readonly(
          "friction_depends_on_position",
          [](const Solver& s) { return ids::frictionDependsOnPosition(s.get()); },
          "Whether friction grows with the gravity torques: then friction_vector() needs q.")
      .def_property_readonly(
          "torque_deviation", &torqueDeviation,
          "(n,) N m (prismatic N): half the width of the band that holds 95 %\n"
          "of the differences between measured and computed torques of data\n"
          "that weren't used to identify; None where the model doesn't state it.")
      .def_property_readonly("seen", &seenRanges,
                             "(3, n, 2): least and greatest q, qd, qdd of the data of\n"
                             "identification; None where the model doesn't state it.");
}

// ---------------------------------------------------------------- bodies and gravity

// A change waits for batches, so setters release the interpreter's lock.
ids::Payloads payloads(const Solver& solver) {
  auto& payload = solver.as<ids::Payload>("payloads");
  return unlocked([&] { return payload.payloads(); });
}

Floats gravity(const Solver& solver) {
  auto& mount = solver.as<ids::VariableGravity>("gravity");
  return arrayOf(unlocked([&] { return mount.gravity(); }));
}

Floats baseAcceleration(const Solver& solver) {
  auto& mount = solver.as<ids::VariableGravity>("base_acceleration");
  return arrayOf(unlocked([&] { return mount.baseAcceleration(); }));
}

void setPayload(const Solver& solver, const std::string& name, double mass,
                const MaybeArrayLike& center_of_mass, const MaybeArrayLike& inertia,
                const MaybeArrayLike& frame) {
  auto& payload = solver.as<ids::Payload>("set_payload");
  const ids::RigidBody body = bodyOf(mass, center_of_mass, inertia, frame);
  unlocked([&] { payload.setPayload(name, body); });
  warn(ids::doubtOf(body));
}

void setGravity(const Solver& solver, const ArrayLike& gravity) {
  auto& mount = solver.as<ids::VariableGravity>("set_gravity");
  const Eigen::Vector3d numbers = vectorOf("set_gravity: argument gravity", gravity);
  unlocked([&] { mount.setGravity(numbers); });
  warn(ids::doubtOf(numbers));
}

void setBaseAcceleration(const Solver& solver, const ArrayLike& acceleration) {
  auto& mount = solver.as<ids::VariableGravity>("set_base_acceleration");
  const Eigen::Vector3d numbers =
      vectorOf("set_base_acceleration: argument acceleration", acceleration);
  unlocked([&] { mount.setBaseAcceleration(numbers); });
}

void bindChanges(py::class_<Solver>& solver) {
  solver
      .def(
          "set_payload", &setPayload, "name"_a, "mass"_a, "center_of_mass"_a = py::none(),
          "inertia"_a = py::none(), "frame"_a = py::none(),
          R"(Adds a rigid body to the tip, or replaces the one of that name, also while other threads compute.

Parameters
----------
name : str
mass : float
    kg.
center_of_mass : array_like, (3,), optional
    m, in the body's frame; by default its origin.
inertia : array_like, (3, 3) or ixx ixy ixz iyy iyz izz, optional
    kg m^2, about the center of mass, in the axes of the body's frame; by default a point mass.
frame : array_like, (4, 4), optional
    Pose of the body's frame in the tip frame; by default the same.

Warns
-----
UserWarning
    A body that is implausible: 5 m away, for one.

Examples
--------
>>> from inverse_dynamics import Solver
>>> arm = Solver("ur10_real")
>>> arm.set_payload("gripper", 1.5, center_of_mass=[0, 0, 0.06])
>>> sorted(arm.payloads)
['gripper'])")
      .def(
          "remove_payload",
          [](const Solver& s, const std::string& name) {
            auto& payload = s.as<ids::Payload>("remove_payload");
            return unlocked([&] { return payload.removePayload(name); });
          },
          "name"_a, R"(Takes a body away.

Parameters
----------
name : str
    As set_payload() had it.

Returns
-------
bool
    False if there is none of that name.)")
      .def(
          "clear_payloads",
          [](const Solver& s) {
            auto& payload = s.as<ids::Payload>("clear_payloads");
            unlocked([&] { payload.clearPayloads(); });
          },
          "Takes all bodies away.")
      .def_property_readonly("payloads", &payloads,
                             "The bodies: name to the arguments of set_payload().")
      .def("set_gravity", &setGravity, "gravity"_a,
           R"(Sets the gravitational acceleration.

Parameters
----------
gravity : array_like, (3,)
    m/s^2, in the axes of the root link.

Warns
-----
UserWarning
    An implausible one: 981, for one.)")
      .def("set_base_acceleration", &setBaseAcceleration, "acceleration"_a,
           R"(Sets how the root link accelerates. Not for a base that rotates.

Parameters
----------
acceleration : array_like, (3,)
    m/s^2, in the axes of the root link.)")
      .def_property_readonly("gravity", &gravity, "(3,) m/s^2.")
      .def_property_readonly("base_acceleration", &baseAcceleration, "(3,) m/s^2.");
}

// ---------------------------------------------------------------- making

constexpr const char* kUsualPlugin =
    "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody";

/// The robot of a Robot, a name of robot_names(), the file of a run configuration, `package/Class`, or
/// a package without its ending. Nothing, with a description: the usual plugin.
Robot robotOf(const SolverName& named, bool described) {
  if (const auto* const robot = std::get_if<Robot>(&named)) return *robot;
  const std::string& text = std::get<PathText>(named).bytes;
  Robot robot;
  robot.name = "robot";
  robot.effort = inverse_dynamics_evaluation::kAutomatic;
  robot.plugin = text.empty() && described ? kUsualPlugin : text;
  if (robot.plugin.empty()) {
    throw ids::InvalidParameterValueException(
        ids::errorText("Solver", "", "a robot, a plugin or urdf=", "none",
                       "`ids robots` lists the names of both"));
  }
  const std::string ending = std::filesystem::path(text).extension();
  const bool is_file = ending == ".yaml" || ending == ".yml";
  if (!is_file && robot.plugin.find('/') != std::string::npos) return robot;
  for (const std::string& plugin : ids::SolverLoader().availableSolvers()) {
    if (is_file || plugin.rfind(text + "_inverse_dynamics_solver/", 0) != 0) continue;
    robot.plugin = plugin;
    return robot;
  }
  return inverse_dynamics_evaluation::readRunConfiguration(text);
}

/// The robot with parameters of a solver in the fields that it has for them.
Robot stating(Robot robot, const ParameterValues& parameters) {
  robot.parameters.clear();
  for (const auto& [name, value] : parameters) {
    const auto* const text = std::get_if<std::string>(&value);
    const auto* const truth = std::get_if<bool>(&value);
    const auto* const numbers = std::get_if<std::vector<double>>(&value);
    if (name == "friction" && truth) {
      robot.friction = *truth;
    } else if (name == "gravity" && numbers && numbers->size() == 3) {
      robot.gravity = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
    } else if (text && (name == "root" || name == "tip" || name == "model")) {
      (name == "root" ? robot.root : name == "tip" ? robot.tip : robot.model) = *text;
    } else {
      robot.parameters[name] = value;
    }
  }
  return robot;
}

std::unique_ptr<Solver> makeSolver(const SolverName& named, const Description& urdf,
                                   const std::string& root, const std::string& tip,
                                   const std::optional<std::array<double, 3>>& gravity,
                                   const std::optional<bool>& friction, const std::string& attached,
                                   const std::optional<std::string>& model,
                                   const ParameterDict& parameters) {
  Robot robot = robotOf(named, !urdf.text.empty());
  const bool described = urdf.text.empty() && !robot.urdf.empty();
  Origin origin{robot.plugin,
                described ? readDescription(textOf(robot.urdf)) : urdf.text,
                parametersOf(parameters),
                {}};
  const auto give = [&](const std::string& name, const ids::ParameterValue& value) {
    if (origin.parameters.emplace(name, value).second) return;
    throw ids::InvalidParameterValueException(
        ids::errorText("Solver", "", "each parameter once",
                       "argument " + name + " and parameters['" + name + "']", "leave out one"));
  };
  if (friction) give("friction", *friction);
  if (!root.empty()) give("root", root);
  if (!tip.empty()) give("tip", tip);
  if (!attached.empty()) give("attached", attached);
  if (model) give("model", *model);
  if (gravity) give("gravity", std::vector<double>(gravity->begin(), gravity->end()));
  // what the robot states and no argument replaces
  if (!urdf.text.empty()) replaceDescription(robot, urdf.path);
  const auto own = inverse_dynamics_evaluation::solverParameters(robot);
  origin.parameters.insert(own.begin(), own.end());
  origin.robot = stating(std::move(robot), origin.parameters);
  return std::make_unique<Solver>(std::move(origin));
}

/// State for pickle and copy: what made the solver, and what was set since.
py::tuple stateOf(const Solver& solver) {
  py::dict since;
  if (solver.find<ids::Payload>() && solver.find<ids::VariableGravity>()) {
    since["payloads"] = payloads(solver);
    since["gravity"] = gravity(solver);
    since["base_acceleration"] = baseAcceleration(solver);
  }
  const Origin& origin = solver.origin();
  return py::make_tuple(origin.plugin, origin.urdf, dictOf(origin.parameters), origin.robot, since);
}

std::unique_ptr<Solver> restored(const py::tuple& state) {
  auto solver =
      std::make_unique<Solver>(Origin{state[0].cast<std::string>(), state[1].cast<std::string>(),
                                      parametersOf(state[2]), state[3].cast<Robot>()});
  const py::dict since = state[4];
  if (since.empty()) return solver;
  auto& payload = solver->as<ids::Payload>("payloads");
  payload.clearPayloads();
  for (const auto& [name, body] : since["payloads"].cast<ids::Payloads>()) {
    payload.setPayload(name, body);
  }
  auto& mount = solver->as<ids::VariableGravity>("gravity");
  mount.setGravity(vectorOf("gravity", since["gravity"]));
  mount.setBaseAcceleration(vectorOf("base_acceleration", since["base_acceleration"]));
  return solver;
}

std::string represented(const Solver& solver) {
  const std::vector<std::string>& joints = solver.joints();
  const std::string joints_in_words =
      joints.size() == 1
          ? "joint " + joints[0]
          : std::to_string(joints.size()) + " joints, " + joints.front() + " to " + joints.back();
  return "<Solver " + solver.origin().plugin + ": " + joints_in_words + ">";
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
      R"(Names of the installed solver plugins, sorted; none if no workspace is sourced.

Returns
-------
list of str

Examples
--------
>>> from inverse_dynamics import available_solvers
>>> "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL" in available_solvers()
True)");

  py::class_<Solver> solver(module, "Solver",
                            R"(An inverse dynamics solver, made by name and ready to compute.

Arrays are (n,), one state, or (N, n), one state per row, joints in the order of joint_names; results have
the same shape. (n,) among (N, n) is one state for all. Columns of a DataFrame that are named like the joints are
taken by name. Any layout, without copies. Threads: safe; the GIL is released. Pickled, it is made again.

Parameters
----------
plugin : Robot, str or path, optional
    A Robot, a name of robot_names() or the file of a run configuration; or a plugin: one of
    available_solvers(), or its package without the ending, such as "kdl". By default rigid bodies.
    What follows replaces what the robot states; what isn't given has the solver's default.
urdf : str or path, optional
    Text of the description, or path of a .urdf or .xacro file.
root, tip : str, optional
    Links between which the chain is; by default the first and the last.
gravity : sequence of 3 floats, optional
    m/s^2, in the axes of the root link.
friction : bool, optional
    Whether the solver adds its friction model.
attached : {"lump", "ignore"}, optional
    Whether links that are attached to the chain count.
model : str, optional
    File or name of a model.
parameters : dict, optional
    Others of the solver, by name; batch_threads: number of threads that may share a large batch.

Raises
------
SolverError
    See inverse_dynamics.errors.

Examples
--------
>>> from inverse_dynamics import Solver, load_robot
>>> arm = Solver("kdl", urdf=load_robot("ur10_simulated").urdf, gravity=[0, 0, -1.62])
>>> arm
<Solver kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL: 6 joints, shoulder_pan_joint to wrist_3_joint>
>>> arm.torques([0.5] * 6, [0] * 6, [0] * 6).shape
(6,))");
  solver
      .def(py::init(&makeSolver), "plugin"_a = "", "urdf"_a = "", "root"_a = "", "tip"_a = "",
           "gravity"_a = py::none(), py::kw_only(), "friction"_a = py::none(), "attached"_a = "",
           "model"_a = py::none(), "parameters"_a = py::dict())
      .def("__repr__", &represented)
      .def(py::pickle(&stateOf, &restored));
  bindProperties(solver);
  bindQuantities(solver);
  bindCalls(solver);
  bindChanges(solver);
}

}  // namespace inverse_dynamics_tools

// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <inverse_dynamics_control/inverse_dynamics_control.hpp>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "annotations.hpp"
#include "bindings.hpp"
#include "fields.hpp"
#include "vectors.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace inverse_dynamics_control;
using Vector = Eigen::VectorXd;
using Result = std::pair<Vector, Status>;

JointState stateOf(const Vector& q, const Vector& qd) {
  JointState state(0);
  state.q = q;
  state.qd = qd;
  return state;
}

Reference referenceOf(const Vector& q, const Vector& qd, const Vector& qdd) {
  Reference reference(0);
  reference.q = q;
  reference.qd = qd;
  reference.qdd = qdd;
  return reference;
}

// Docstrings of updates, in parts.
const std::string kUpdate = "Torques of one cycle.\n\nParameters\n----------\n";
const std::string kState =
    "q, qd : array_like, (n,)\n    Measured, rad, rad/s (prismatic m, m/s).\n";
const std::string kPositions = "q_reference : array_like, (n,)\n    rad (prismatic m).\n";
const std::string kVelocities = "qd_reference : array_like, (n,)\n    rad/s (prismatic m/s).\n";
const std::string kAccelerations =
    "qdd_reference : array_like, (n,)\n    rad/s^2 (prismatic m/s^2).\n";
const std::string kPeriod = "period : float\n    s since the cycle before.\n";
const std::string kTorques =
    "\nReturns\n-------\ntuple of ndarray, (n,), and Status\n    tau, N m (prismatic N): the safe "
    "torque where the status is a refusal.";
constexpr const char* kSetGains = R"(Takes other gains, from the next update on.

Parameters
----------
gains : Gains or PdGains
    (n,) each, as the law was made with.

Raises
------
ValueError
    Wrong sizes, negative or infinite numbers: nothing has changed.)";

/// An update of a law with these arguments: its torques, and how it ended.
template <class Law, class... Arguments>
Result updated(Law& law, const Arguments&... arguments) {
  Vector tau(law.jointCount());
  const Status status = law.update(arguments..., tau);
  return {tau, status};
}

Result hold(ControlLaw& law, const Vector& q, const Vector& qd, double period) {
  Vector tau(law.jointCount());
  const Status status = law.hold(stateOf(q, qd), period, tau);
  return {tau, status};
}

Result computedTorque(ComputedTorque& law, const Vector& q, const Vector& qd,
                      const Vector& q_reference, const Vector& qd_reference,
                      const Vector& qdd_reference, double period) {
  return updated(law, stateOf(q, qd), referenceOf(q_reference, qd_reference, qdd_reference),
                 period);
}

Result gravityCompensation(GravityCompensation& law, const Vector& q, const Vector& qd,
                           double period, const std::optional<Vector>& qd_reference) {
  return qd_reference ? updated(law, stateOf(q, qd), *qd_reference, period)
                      : updated(law, stateOf(q, qd), period);
}

Result pdGravityCompensation(PdGravityCompensation& law, const Vector& q, const Vector& qd,
                             const Vector& q_reference, const Vector& qd_reference, double period) {
  return updated(law, stateOf(q, qd), referenceOf(q_reference, qd_reference, Vector()), period);
}

Result feedForward(FeedForward& law, const Vector& q, const Vector& qd, const Vector& q_reference,
                   const Vector& qd_reference, const Vector& qdd_reference, const Vector& effort,
                   double period) {
  return updated(law, stateOf(q, qd), referenceOf(q_reference, qd_reference, qdd_reference), effort,
                 period);
}

// The error of a constructor for the same gains, where they aren't accepted.
template <class Law, class AnyGains>
void setGains(Law& law, const AnyGains& gains) {
  if (law.setGains(gains)) return;
  throw py::value_error("set_gains: expected " + std::to_string(law.jointCount()) +
                        " finite numbers that aren't negative for each of Kp and Kd; the gains "
                        "are as they were");
}

void bindLawEnums(py::module_& module) {
  py::enum_<Status>(module, "Status", "How an update ended: see inverse_dynamics_control.")
      .value("OK", Status::kOk)
      .value("SATURATED", Status::kSaturated)
      .value("RATE_LIMITED", Status::kRateLimited)
      .value("NO_PERIOD", Status::kNoPeriod)
      .value("REFERENCE_NOT_FINITE", Status::kReferenceNotFinite)
      .value("STATE_NOT_FINITE", Status::kStateNotFinite)
      .value("TORQUE_NOT_FINITE", Status::kTorqueNotFinite)
      .value("SOLVER_FAILED", Status::kSolverFailed)
      .value("WRONG_SIZE", Status::kWrongSize)
      .def_property_readonly(
          "text", [](Status status) { return text(status); }, "What happened, in words.")
      .def_property_readonly("is_refusal", &isRefusal, "Whether the torque is the safe torque.");
  py::enum_<FrictionSource>(module, "FrictionSource", "Whose velocity decides about friction.")
      .value("NONE", FrictionSource::kNone)
      .value("REFERENCE_VELOCITY", FrictionSource::kReferenceVelocity)
      .value("MEASURED_VELOCITY", FrictionSource::kMeasuredVelocity);
  py::enum_<ModelState>(module, "ModelState", "Where a feed-forward takes H, C and g.")
      .value("REFERENCE", ModelState::kReference)
      .value("MEASURED", ModelState::kMeasured);
}

/// A field of LawOptions.limits.
auto limitField(const char* name, OwnedVector OutputLimits::*member, const char* doc) {
  return Field<LawOptions, Vector, Vector>(
      name, [member](const LawOptions& o) -> Vector { return o.limits.*member; },
      [member](LawOptions& o, const Vector& values) { o.limits.*member = values; }, doc);
}

/// Shares: a number, or one of each joint.
using OneOrEach = std::variant<double, Vector>;

OneOrEach of(const Shares& shares) {
  if (shares.values().size() == 1) return shares.values()[0];
  return Vector(shares.values());
}

Shares sharesOf(const OneOrEach& given) {
  return std::visit([](const auto& values) { return Shares(values); }, given);
}

auto shareField(const char* name, Shares Compensated::*member, const char* doc) {
  return Field<Compensated, OneOrEach, OneOrEach>(
      name, [member](const Compensated& c) { return of(c.*member); },
      [member](Compensated& c, const OneOrEach& given) { c.*member = sharesOf(given); }, doc);
}

auto viscousField() {
  using Given = std::optional<OneOrEach>;
  return Field<Compensated, Given, Given>(
      "viscous", [](const Compensated& c) { return c.viscous ? Given(of(*c.viscous)) : Given(); },
      [](Compensated& c, const Given& given) {
        c.viscous = given ? std::optional(sharesOf(*given)) : std::nullopt;
      },
      "of viscous friction; None: as friction");
}

void bindLawOptions(py::module_& module) {
  using C = Compensated;
  bindOptions<0>(module, "Compensated",
                 "What the robot adds by itself: shares, 0 to 1, of all joints or (n,).", "",
                 shareField("gravity", &C::gravity, "of the gravity torques"),
                 shareField("coriolis", &C::coriolis, "of the Coriolis torques"),
                 shareField("friction", &C::friction, "of friction"), viscousField());
  using F = FrictionOptions;
  bindOptions<0>(module, "FrictionOptions", "How friction is compensated; speeds in rad/s.", "",
                 Field{"source", &F::source, "whose velocity decides"},
                 Field{"dead_band", &F::dead_band, "rad/s, below which there is none"},
                 Field{"blend", &F::blend, "rad/s, over which it sets in"},
                 Field{"scale", &F::scale, "share of it that is compensated"});
  using O = LawOptions;
  bindOptions(module, "LawOptions", "Options of every law; arrays (n,).", "",
              limitField("effort_limit", &OutputLimits::effort, "N m"),
              Field{"damping", &O::damping, "N m s/rad; of the safe torque; each joint alone"},
              Field{"damping_rate", &O::damping_rate, "1/s; the same, times H(q)"},
              limitField("rate_limit", &OutputLimits::rate, "N m/s; empty: none"),
              Field{"compensated", &O::compensated, "what the robot adds by itself"},
              Field{"friction", &O::friction, "how friction is compensated"});
  bindOptions<2>(module, "PdGains", "Gains of a PD law.", "",
                 Field{"Kp", &PdGains::Kp, "(n,) N m/rad (prismatic N/m)"},
                 Field{"Kd", &PdGains::Kd, "(n,) N m s/rad (prismatic N s/m)"});
  bindOptions<2>(module, "Gains", "Gains of computed torque.", "",
                 Field{"Kp", &Gains::Kp, "(n,) 1/s^2"}, Field{"Kd", &Gains::Kd, "(n,) 1/s"})
      .def_static(
          "of", [](const Vector& w, const Vector& z) { return Gains::of(w, z); },
          "natural_frequency"_a, "damping_ratio"_a, R"(Kp = w^2 and Kd = 2 z w.

Parameters
----------
natural_frequency : array_like, (n,)
    w, rad/s.
damping_ratio : array_like, (n,)
    z, 1.

Returns
-------
Gains)");
}

void bindLaws(py::module_& module) {
  py::class_<ControlLaw>(module, "ControlLaw", "What all laws share.")
      .def(
          "start",
          [](ControlLaw& law, const std::optional<Vector>& effort) {
            effort ? law.start(*effort) : law.start();
          },
          "effort"_a = py::none(), R"(Begins a loop.

Parameters
----------
effort : array_like, (n,), optional
    N m (prismatic N) that acts now: rate limits begin there.)")
      .def(
          "hold", &hold, "q"_a, "qd"_a, "period"_a,
          ("The safe torque g(q) - D qd.\n\nParameters\n----------\n" + kState + kPeriod + kTorques)
              .c_str())
      .def_property_readonly(
          "saturated", [](const ControlLaw& law) { return law.saturated(); },
          "(n,) Whether the last torque was cut to its effort limit.")
      .def_property_readonly(
          "rate_limited", [](const ControlLaw& law) { return law.rateLimited(); },
          "(n,) Whether the last torque was held back by its rate limit.");
  py::class_<ComputedTorque, ControlLaw>(
      module, "ComputedTorque", "tau = H(q) (qdd_ref + Kp e + Kd ed) + C(q, qd) qd + g(q) + f.")
      .def(ofSolver<ComputedTorque, Gains, LawOptions>(), "solver"_a, "gains"_a, "options"_a)
      .def("update", &computedTorque, "q"_a, "qd"_a, "q_reference"_a, "qd_reference"_a,
           "qdd_reference"_a, py::kw_only(), "period"_a,
           (kUpdate + kState + kPositions + kVelocities + kAccelerations + kPeriod + kTorques)
               .c_str())
      .def("set_gains", &setGains<ComputedTorque, Gains>, "gains"_a, kSetGains);
  py::class_<PdGravityCompensation, ControlLaw>(module, "PdGravityCompensation",
                                                "tau = g(q) + Kp e + Kd ed + f.")
      .def(ofSolver<PdGravityCompensation, PdGains, LawOptions>(), "solver"_a, "gains"_a,
           "options"_a)
      .def("update", &pdGravityCompensation, "q"_a, "qd"_a, "q_reference"_a, "qd_reference"_a,
           "period"_a, (kUpdate + kState + kPositions + kVelocities + kPeriod + kTorques).c_str())
      .def("set_gains", &setGains<PdGravityCompensation, PdGains>, "gains"_a, kSetGains);
  py::class_<GravityCompensation, ControlLaw>(module, "GravityCompensation",
                                              "tau = g(q) - D qd + f.")
      .def(ofSolver<GravityCompensation, LawOptions>(), "solver"_a, "options"_a)
      .def("update", &gravityCompensation, "q"_a, "qd"_a, "period"_a, "qd_reference"_a = py::none(),
           (kUpdate + kState + kPeriod + kVelocities +
            "    Optional: friction is compensated by it where options say so.\n" + kTorques)
               .c_str());
  py::class_<FeedForward, ControlLaw>(module, "FeedForward",
                                      "tau = effort + H qdd_ref + C qd + g + f.")
      .def(py::init([](const SolverObject& solver, const LawOptions& options, ModelState at) {
             return FeedForward(solverOf(solver), at, options);
           }),
           "solver"_a, "options"_a, "at"_a = ModelState::kReference)
      .def(
          "update", &feedForward, "q"_a, "qd"_a, "q_reference"_a, "qd_reference"_a,
          "qdd_reference"_a, py::kw_only(), "effort"_a, "period"_a,
          (kUpdate + kState + kPositions + kVelocities + kAccelerations +
           "effort : array_like, (n,)\n    N m (prismatic N) that the feed-forward is added to.\n" +
           kPeriod + kTorques)
              .c_str());
}

void bindSafeStop(py::module_& module) {
  py::class_<SafeStop>(module, "SafeStop", "Ramps references to a standstill.")
      .def(py::init<const Vector&, const std::vector<std::string>&>(), "deceleration"_a,
           "joint_names"_a)
      .def(
          "begin",
          [](SafeStop& stop, const Vector& q, const Vector& qd) { return stop.begin(q, qd); },
          "q"_a, "qd"_a, R"(Begins a ramp at a motion.

Parameters
----------
q, qd : array_like, (n,)
    rad, rad/s (prismatic m, m/s).

Returns
-------
Status)")
      .def(
          "advance",
          [](SafeStop& stop, double period) -> std::tuple<Vector, Vector, Vector> {
            Reference reference(stop.jointCount());
            if (isRefusal(stop.advance(period, reference))) {
              throw py::value_error("SafeStop.advance: call begin() first, with a finite motion");
            }
            return {reference.q, reference.qd, reference.qdd};
          },
          "period"_a, R"(The reference one period later.

Parameters
----------
period : float
    s.

Returns
-------
tuple of three ndarray, (n,) each
    q, qd, qdd: rad, rad/s, rad/s^2 (prismatic m, m/s, m/s^2).)")
      .def_property_readonly("finished", &SafeStop::finished, "Whether the ramp has ended.")
      .def_property_readonly("duration", &SafeStop::duration, "Of the ramp, s.");
}

}  // namespace

void bindControl(py::module_& module) {
  bindLawEnums(module);
  bindLawOptions(module);
  bindLaws(module);
  bindSafeStop(module);
}

}  // namespace inverse_dynamics_tools

// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <inverse_dynamics_control/inverse_dynamics_control.hpp>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/external_wrench.hpp>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "annotations.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "fields.hpp"
#include "vectors.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace inverse_dynamics_control;
using Vector = Eigen::VectorXd;
using Mask = py::array_t<bool, py::array::c_style | py::array::forcecast>;
using Unseen = py::array_t<Eigen::Index>;

/// A velocity that isn't given would be taken for zero.
void requireVelocities(const ExternalTorqueEstimator& estimator, const char* method, bool given) {
  if (given || estimator.velocitySource() != VelocitySource::kMeasured) return;
  throw inverse_dynamics_solver::InvalidParameterValueException(inverse_dynamics_solver::errorText(
      method, "argument qd", "velocities, as the estimator takes measured ones", "none",
      "give qd, or make the estimator with velocity=VelocitySource.POSITIONS"));
}

JointState stateOf(const Vector& q, const std::optional<Vector>& qd) {
  JointState state(0);
  state.q = q;
  if (qd) state.qd = *qd;
  return state;
}

std::pair<Vector, EstimateStatus> update(ExternalTorqueEstimator& estimator, const Vector& q,
                                         const Vector& effort, double period,
                                         const std::optional<Vector>& qd) {
  requireVelocities(estimator, "update", qd.has_value());
  const EstimateStatus status = estimator.update(stateOf(q, qd), effort, period);
  return {estimator.torques(), status};
}

/// Row k of an array (N, n).
Eigen::Map<const Vector> row(const Array& array, py::ssize_t k) {
  return {array.data() + k * array.shape(1), array.shape(1)};
}

/// From the sample before; zero at the first one.
double periodAt(const double* time, py::ssize_t k) { return k == 0 ? 0.0 : time[k] - time[k - 1]; }

/// All samples, one after the other, without the GIL.
std::tuple<Array, Mask> runEstimator(ExternalTorqueEstimator& estimator, const Array& time,
                                     const Array& q, const Array& effort,
                                     const std::optional<Array>& qd) {
  requireVelocities(estimator, "run", qd.has_value());
  const py::ssize_t count = time.size(), n = estimator.jointCount();
  requireShape("time", time, {count});
  requireShape("q", q, {count, n});
  requireShape("effort", effort, {count, n});
  if (qd) requireShape("qd", *qd, {count, n});
  Array torques({count, n});
  Mask valid(count);
  Map out = columns(torques);
  bool* const ok = valid.mutable_data();
  unlocked([&] {
    JointState state(n);
    for (py::ssize_t k = 0; k < count; ++k) {
      state.q = row(q, k);
      if (qd) state.qd = row(*qd, k);
      const double period = periodAt(time.data(), k);
      ok[k] = estimator.update(state, row(effort, k), period) == EstimateStatus::kOk;
      out.col(k) = estimator.torques();
    }
  });
  return {torques, valid};
}

/// Invalid estimates are skipped: they count neither as torques nor as time without contact.
Mask runDetector(ContactDetector& detector, const Array& time, const Array& torques,
                 const std::optional<Mask>& valid) {
  const py::ssize_t count = time.size();
  requireShape("time", time, {count});
  requireShape("torques", torques, {count, torques.ndim() == 2 ? torques.shape(1) : 0});
  if (valid) requireShape("valid", *valid, {count});
  const bool* const looked_at = valid ? valid->data() : nullptr;
  Mask contact(count);
  bool* const out = contact.mutable_data();
  unlocked([&] {
    for (py::ssize_t k = 0; k < count; ++k) {
      out[k] = looked_at != nullptr && !looked_at[k]
                   ? detector.contact()
                   : detector.update(row(torques, k), periodAt(time.data(), k));
    }
  });
  return contact;
}

Vector numbersOf(const WrenchInRoot& wrench) {
  Vector numbers(6);
  numbers << wrench.force, wrench.torque;
  return numbers;
}

std::tuple<Array, Unseen> runTipWrench(TipWrench& tip, const Array& q, const Array& torques) {
  const py::ssize_t count = q.ndim() == 0 ? 0 : q.shape(0), n = tip.jointCount();
  requireShape("q", q, {count, n});
  requireShape("torques", torques, {count, n});
  Array wrenches({count, py::ssize_t{6}});
  Unseen unseen(count);
  Map out = columns(wrenches);
  Eigen::Index* const number = unseen.mutable_data();
  unlocked([&] {
    for (py::ssize_t k = 0; k < count; ++k) {
      tip.update(row(q, k), row(torques, k));
      out.col(k) = numbersOf(tip.wrench());
      number[k] = tip.unseen();
    }
  });
  return {wrenches, unseen};
}

void bindEstimateEnums(py::module_& module) {
  py::enum_<EstimateStatus>(module, "EstimateStatus",
                            "How an update ended; unless it is OK, the torques are zero.")
      .value("OK", EstimateStatus::kOk)
      .value("STARTING", EstimateStatus::kStarting)
      .value("GAP", EstimateStatus::kGap)
      .value("STATE_NOT_FINITE", EstimateStatus::kStateNotFinite)
      .value("EFFORT_NOT_FINITE", EstimateStatus::kEffortNotFinite)
      .value("MODEL_NOT_FINITE", EstimateStatus::kModelNotFinite)
      .value("SOLVER_FAILED", EstimateStatus::kSolverFailed)
      .value("WRONG_SIZE", EstimateStatus::kWrongSize)
      .def_property_readonly(
          "text", [](EstimateStatus status) { return text(status); }, "What happened, in words.");
  py::enum_<VelocitySource>(module, "VelocitySource", "Where velocities come from.")
      .value("POSITIONS", VelocitySource::kPositions)
      .value("MEASURED", VelocitySource::kMeasured);
}

void bindEstimators(py::module_& module) {
  using O = EstimatorOptions;
  bindOptions(module, "EstimatorOptions", "Options of both estimators.", "",
              Field{"gain", &O::gain, "(n,) 1/s"},
              Field{"velocity", &O::velocity, "where velocities come from"},
              Field{"tracking", &O::tracking, "rad/s, of velocities from positions"},
              Field{"compensated", &O::compensated, "what the robot adds by itself"},
              Field{"friction_band", &O::friction_band,
                    "(n,) N m, what the friction model may be wrong by; empty: nothing"},
              Field{"longest_period", &O::longest_period, "s; samples further apart are a gap"});
  py::class_<ExternalTorqueEstimator>(module, "ExternalTorqueEstimator",
                                      "External torques of each joint, N m.")
      .def("update", &update, "q"_a, "effort"_a, "period"_a, "qd"_a = py::none(),
           R"(External torques after one more sample.

Parameters
----------
q, qd : array_like, (n,)
    rad, rad/s (prismatic m, m/s); qd only where velocities are measured.
effort : array_like, (n,)
    Measured torques, N m (prismatic N): the mean since the sample before.
period : float
    s since the sample before; 0: the first one.

Returns
-------
tuple of ndarray, (n,), and EstimateStatus
    N m (prismatic N), zero unless the status is OK.)")
      .def("run", &runEstimator, "time"_a, "q"_a, "effort"_a, "qd"_a = py::none(),
           R"(update() of N samples, one after another.

Parameters
----------
time : array_like, (N,)
    s.
q, effort, qd : array_like, (N, n)
    As update() takes them.

Returns
-------
tuple of ndarray, (N, n), and ndarray of bool, (N,)
    Torques, N m (prismatic N); whether they are estimates.)")
      .def("reset", &ExternalTorqueEstimator::reset,
           "Begins again: the next sample is the first one.")
      .def_property_readonly("torques", &ExternalTorqueEstimator::torques, "(n,) N m.");
  py::class_<MomentumObserver, ExternalTorqueEstimator>(module, "MomentumObserver",
                                                        "From the generalised momentum H(q) qd.")
      .def(ofSolver<MomentumObserver, EstimatorOptions>(), "solver"_a, "options"_a);
  py::class_<AccelerationResidual, ExternalTorqueEstimator>(
      module, "AccelerationResidual", "Measured minus computed torques, low-passed.")
      .def(ofSolver<AccelerationResidual, EstimatorOptions>(), "solver"_a, "options"_a);
}

void bindThresholds(py::module_& module) {
  using T = ContactThresholds;
  bindRecord(module, "ContactThresholds", "Thresholds (n,), and how they came about.",
             Field{"torques", &T::torques, "(n,) N m (prismatic N), of absolute values"},
             Field{"noise", &T::noise, "(n,) N m, root mean square of the external torques"},
             Field{"correlation_time", &T::correlation_time, "(n,) s"},
             Field{"peaks", &T::peaks, "(n,) number of peaks above the level"},
             Field{"level", &T::level, "(n,) N m"},
             Field{"scale", &T::scale, "(n,) N m, of the generalised Pareto distribution"},
             Field{"shape", &T::shape, "(n,) of that distribution"},
             Field{"false_alarms_per_hour", &T::false_alarms_per_hour, "of all joints together"});
  module.def(
      "contact_thresholds",
      [](const Array& quiet, double period, double false_alarms_per_hour,
         const std::vector<std::string>& joint_names) {
        requireShape(
            "quiet", quiet,
            {quiet.ndim() == 0 ? 0 : quiet.shape(0), static_cast<py::ssize_t>(joint_names.size())});
        const ConstMap columns = states(quiet, "quiet");
        const py::gil_scoped_release release;
        return contactThresholds(columns, period, false_alarms_per_hour, joint_names);
      },
      "quiet"_a, "period"_a, "false_alarms_per_hour"_a, "joint_names"_a,
      R"(Thresholds that external torques without contact exceed at a stated rate.

Parameters
----------
quiet : array_like, (N, n)
    External torques without contact, N m (prismatic N), all of them estimates.
period : float
    s between samples.
false_alarms_per_hour : float
    Of all joints together.
joint_names : sequence of n str

Returns
-------
ContactThresholds)");
}

void bindDetector(py::module_& module) {
  const ReleaseOptions usual;
  py::class_<ContactDetector>(module, "ContactDetector", "Compares external torques.")
      .def(py::init([](const Vector& thresholds, const std::vector<std::string>& joint_names,
                       double release_share, double release_time) {
             return ContactDetector(thresholds, {release_share, release_time}, joint_names);
           }),
           "thresholds"_a, "joint_names"_a, py::kw_only(), "release_share"_a = usual.share,
           "release_time"_a = usual.time)
      .def(
          "update",
          [](ContactDetector& detector, const Vector& torques, double period) {
            return detector.update(torques, period);
          },
          "torques"_a, "period"_a,
          R"(Whether something touches the robot.

Parameters
----------
torques : array_like, (n,)
    External torques, N m (prismatic N).
period : float
    s since the sample before.

Returns
-------
bool)")
      .def("run", &runDetector, "time"_a, "torques"_a, "valid"_a = py::none(),
           R"(update() of N samples, one after another.

Parameters
----------
time : array_like, (N,)
    s.
torques : array_like, (N, n)
    External torques, N m (prismatic N).
valid : array_like of bool, (N,), optional
    Samples to look at; at the others a contact stays as it is. By default all.

Returns
-------
ndarray of bool, (N,))")
      .def("reset", &ContactDetector::reset, "Begins again, without a contact.")
      .def_property_readonly("contact", &ContactDetector::contact,
                             "Whether something touches the robot.")
      .def_property_readonly("joint", &ContactDetector::joint,
                             "Which joint's torque began the contact; -1: none.")
      .def_property_readonly("excess", &ContactDetector::excess,
                             "Greatest torque by threshold of the last update.");
}

void bindTipWrench(py::module_& module) {
  py::enum_<WrenchStatus>(module, "WrenchStatus", "Unless it is OK, the wrench is zero.")
      .value("OK", WrenchStatus::kOk)
      .value("NOT_FINITE", WrenchStatus::kNotFinite)
      .value("SOLVER_FAILED", WrenchStatus::kSolverFailed)
      .value("WRONG_SIZE", WrenchStatus::kWrongSize)
      .def_property_readonly(
          "text", [](WrenchStatus status) { return text(status); }, "What happened, in words.");
  py::class_<TipWrench>(module, "TipWrench", "Wrench at the tip from external torques.")
      .def(py::init(
               [](const SolverObject& solver, const Vector& noise, double force, double torque) {
                 WrenchOptions options;
                 options.noise = noise;
                 options.force = force;
                 options.torque = torque;
                 return std::make_unique<TipWrench>(solverOf(solver), options);
               }),
           "solver"_a, "noise"_a, py::kw_only(), "force"_a = WrenchOptions().force,
           "torque"_a = WrenchOptions().torque, "noise: (n,) N m; force: N; torque: N m.")
      .def(
          "update",
          [](TipWrench& tip, const Vector& q, const Vector& torques) {
            const WrenchStatus status = tip.update(q, torques);
            return std::pair{numbersOf(tip.wrench()), status};
          },
          "q"_a, "torques"_a, R"(The wrench at the tip of one sample.

Parameters
----------
q : array_like, (n,)
    rad (prismatic m).
torques : array_like, (n,)
    External torques, N m (prismatic N).

Returns
-------
tuple of ndarray, (6,), and WrenchStatus
    Force [N] and torque [N m] about the tip, in the root's axes; zero unless the status is OK.)")
      .def("run", &runTipWrench, "q"_a, "torques"_a, R"(update() of N samples.

Parameters
----------
q, torques : array_like, (N, n)
    As update() takes them.

Returns
-------
tuple of ndarray, (N, 6), and ndarray of int, (N,)
    Forces [N] and torques [N m]; how many directions can't be seen.)")
      .def_property_readonly(
          "signal_to_noise", [](const TipWrench& tip) -> Vector { return tip.signalToNoise(); },
          "(6,) the greatest first.")
      .def_property_readonly(
          "directions", [](const TipWrench& tip) -> Eigen::MatrixXd { return tip.directions(); },
          "(6, 6) whose columns they belong to: N, N m.")
      .def_property_readonly("unseen", &TipWrench::unseen,
                             "How many of them, the last ones, are below the noise.");
}

}  // namespace

void bindContact(py::module_& module) {
  bindEstimateEnums(module);
  bindEstimators(module);
  bindThresholds(module);
  bindDetector(module);
  bindTipWrench(module);
}

}  // namespace inverse_dynamics_tools

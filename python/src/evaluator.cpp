// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <cstddef>
#include <cstdint>
#include <inverse_dynamics_evaluation/accelerations.hpp>
#include <inverse_dynamics_evaluation/effort.hpp>
#include <inverse_dynamics_evaluation/error.hpp>
#include <inverse_dynamics_evaluation/evaluator.hpp>
#include <inverse_dynamics_evaluation/metrics.hpp>
#include <inverse_dynamics_evaluation/recording.hpp>
#include <inverse_dynamics_evaluation/sample_table.hpp>
#include <inverse_dynamics_evaluation/samples.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "annotations.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "description.hpp"
#include "fields.hpp"
#include "recordings.hpp"

INVERSE_DYNAMICS_TOOLS_OBJECT(JointErrors, "tuple[inverse_dynamics._core.JointError, ...]")

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
namespace evaluation = inverse_dynamics_evaluation;
using evaluation::Effort;
using evaluation::EffortVerdict;
using evaluation::JointMetrics;
using Evaluated = evaluation::Evaluation;
using Names = std::vector<std::string>;
using MaskArray = py::array_t<bool, py::array::c_style>;

// ---------------------------------------------------------------- results

/// Errors of a joint, and how texts name it.
struct JointError : JointMetrics {
  std::string joint, unit;
};

JointErrors jointErrors(const Names& joints, const Names& units,
                        const std::vector<JointMetrics>& metrics) {
  py::list errors;
  for (std::size_t j = 0; j < metrics.size(); ++j) {
    errors.append(JointError{metrics[j], joints.at(j), units.at(j)});
  }
  return py::tuple(errors);
}

JointErrors errorsOf(const Names& joints, const Names& units, const Array& computed,
                     const Array& measured, const std::optional<MaskArray>& kept) {
  const ConstMap computed_in = states(computed, "computed"),
                 measured_in = states(measured, "measured");
  return jointErrors(joints, units, unlocked([&] {
                       if (!kept) return evaluation::metrics(computed_in, measured_in);
                       using Rows = Eigen::Array<bool, Eigen::Dynamic, 1>;
                       const evaluation::Mask counts =
                           Eigen::Map<const Rows>(kept->data(), kept->size());
                       return evaluation::metrics(computed_in, measured_in, counts);
                     }));
}

void bindErrors(py::module_& module) {
  const auto number = [](const char* name, double JointMetrics::*member, const char* doc) {
    return inherited<JointError>(name, member, doc);
  };
  bindRecord(
      module, "JointError",
      "How far the computed torques of one joint are from the measured ones: see\n"
      "docs/notation.md.\n\n"
      "NaN where a number is undefined (nrmse and r2 of a joint whose measured torque never\n"
      "changes).",
      Field{"joint", &JointError::joint, "its name"}, Field{"unit", &JointError::unit, "N m or N"},
      number("mae", &JointError::mae, "mean absolute error"),
      number("rmse", &JointError::rmse, "root mean square error"),
      number("nrmse", &JointError::nrmse, "share of the measured range: 0.01 is 1 %"),
      number("bias", &JointError::bias, "mean error: positive where too much is computed"),
      number("r2", &JointError::r2, "coefficient of determination"),
      number("max_abs", &JointError::max_abs, "greatest absolute error"));
  module.def("joint_errors", &errorsOf, "joint_names"_a, "units"_a, "computed"_a, "measured"_a,
             "kept"_a = py::none(),
             "Errors of each joint: of all samples, or of those where kept (N,) is true.\n\n"
             "computed, measured: (N, n).");
}

/// How accelerations were estimated, without findings about the samples: outlives the table.
struct Accelerations {
  std::string method;
  std::optional<double> cutoff;
  bool chosen = false;
  std::optional<int> order;
  std::string time_base = evaluation::name(evaluation::TimeBase::kStamps);
  bool by_efforts = false;
};

Accelerations howOf(const Evaluated& evaluated) {
  const auto& filter = evaluated.accelerations.filter;
  Accelerations how;
  how.method = evaluation::name(evaluated.accelerations.method);
  if (evaluated.accelerations.method != evaluation::AccelerationMethod::kLowPass) return how;
  how.cutoff = filter.cutoff;
  how.chosen = filter.chosen;
  how.by_efforts = filter.choice.gain > 0;
  how.order = filter.order;
  how.time_base = evaluation::name(filter.time_base);
  return how;
}

void bindHow(py::module_& module) {
  using A = Accelerations;
  bindRecord<1>(
      module, "Accelerations", "How accelerations were estimated.",
      Field{"method", &A::method, "low-pass, given or backward-difference"},
      Field{"cutoff", &A::cutoff, "Hz; gain one half there"},
      Field{"chosen", &A::chosen, "whether the cut-off was chosen from the data"},
      Field{"order", &A::order, "of the Butterworth filter that runs both ways"},
      Field{"time_base", &A::time_base, "when samples were taken: stamps, regular, regular_fresh"},
      Field{"by_efforts", &A::by_efforts,
            "whether efforts chose the cut-off, not positions and velocities alone"})
      .def_property_readonly(
          "summary",
          [](const A& a) {
            return evaluation::accelerationSummary(evaluation::accelerationMethod(a.method),
                                                   a.cutoff.value_or(0.0), a.chosen);
          },
          "In words, as titles and tables show it.");
}

void bindEffort(py::module_& module) {
  using V = EffortVerdict;
  bindRecord<2>(module, "Verdict", "What the data say efforts mean.",
                Field{"best", &V::best, "the meaning that fits best"},
                Field{"sure", &V::sure, "whether no other meaning or mistake fits as well"},
                Field{"summary", &V::summary, "errors of the meanings, in words"},
                Field{"reason", &V::reason, "why it isn't sure, in words"});
  bindRecord(module, "Effort", "What recorded efforts mean, and how that is known.",
             Field{"meaning", &Effort::meaning, "one of EFFORT_MEANINGS"},
             Field{"stated_by", &Effort::stated_by, "in words"},
             Field{"drive_gains", &Effort::drive_gains, "N m/A (prismatic N/A), of currents"},
             Field{"verdict", &Effort::verdict, "of the data, if they were asked"})
      .def_property_readonly("summary", &Effort::summary, "In words, as tables show it.")
      .def(
          "torques",
          [](const Effort& effort, const Array& recorded) {
            const ConstMap efforts = states(recorded, "effort");
            return rowsOf(effort.torques(efforts));
          },
          "effort"_a,
          "Measured torques (N, n) [N m] of recorded efforts; without gravity if these are.");
  py::class_<evaluation::EffortOptions>(module, "EffortOptions",
                                        "What is stated of efforts, and by whom: effort_options().")
      .def_readonly("drive_gains", &evaluation::EffortOptions::drive_gains, "(n,) N m/A, or none");
}

void bindEvaluated(py::module_& module) {
  using E = const Evaluated&;
  py::class_<Evaluated>(
      module, "Evaluated",
      "A motion, its torques and errors: what read_motion() gives, and two functions fill in.")
      .def_property_readonly("accelerations", &howOf, "How they were estimated.")
      .def_property_readonly(
          "period", [](E e) { return e.accelerations.samples.period; }, "s, between samples.")
      .def_property_readonly(
          "jitter", [](E e) { return e.accelerations.samples.jitter; }, "s, of the period.")
      .def_property_readonly(
          "effort", [](E e) { return e.effort; }, "`auto` until it is compared.")
      .def_property_readonly(
          "table", [](E e) { return e.table; }, "The samples, and what was found.")
      .def(
          "errors",
          [](E e, const Names& units) { return jointErrors(e.joint_names, units, e.errors); },
          "units"_a, "Of all samples.")
      .def(
          "errors_of_kept",
          [](E e, const Names& units) {
            return jointErrors(e.joint_names, units, e.errors_of_kept);
          },
          "units"_a, "Of those that were kept.")
      .def_readonly("notes", &Evaluated::notes, "What was left out or assumed, in words.");
}

// ---------------------------------------------------------------- evaluating

/// Samples of a JointLog of joint_log.py.
struct Log {
  explicit Log(const py::handle& log)
      : header_stamps(log.attr("header_stamps").cast<Integers>()),
        receive_stamps(log.attr("receive_stamps").cast<Integers>()),
        clock(log.attr("clock").cast<std::string>()),
        q(log.attr("q").cast<Array>()),
        qd(log.attr("qd").cast<Array>()),
        effort(log.attr("effort").cast<Array>()) {
    if (!log.attr("qdd").is_none()) qdd = log.attr("qdd").cast<Array>();
  }

  evaluation::RecordedColumns view() const {
    using Stamps = Eigen::Map<const Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>>;
    const ConstMap none(nullptr, 0, 0);
    return {Stamps(header_stamps.data(), header_stamps.size()),
            Stamps(receive_stamps.data(), receive_stamps.size()),
            clock == "receive" ? evaluation::Clock::kReceive : evaluation::Clock::kHeader,
            states(q, "q"),
            states(qd, "qd"),
            states(effort, "effort"),
            qdd ? states(*qdd, "qdd") : none};
  }

  Integers header_stamps, receive_stamps;
  std::string clock;
  Array q, qd, effort;
  std::optional<Array> qdd;
};

/// EvaluationOptions and RecordingOptions.
struct Options : evaluation::EvaluationOptions {
  Options() { source.joints_option = "--joints"; }

  evaluation::RecordingOptions source;
};

void bindEvaluationOptions(py::module_& module) {
  using O = Options;
  using Window = std::pair<double, double>;
  bindOptions<0>(
      module, "EvaluationOptions", "How evaluate() is to work.", "",
      Field<O, Names, Names>(
          "joints", [](const O& o) { return o.source.joints; },
          [](O& o, const Names& joints) { o.source.joints = joints; },
          "in the recording, in the order of the chain"),
      Field<O, std::string, std::string>(
          "clock", [](const O& o) { return evaluation::name(o.source.clock); },
          [](O& o, const std::string& clock) { o.source.clock = clockOf(clock); },
          "header, receive or auto"),
      Field<O, Window, Window>(
          "window", [](const O& o) { return Window(o.source.window.from, o.source.window.to); },
          [](O& o, const Window& window) {
            o.source.window = {window.first, window.second};
          },
          "s since the first sample; what lies outside is left out"),
      Field<O, FilePath, PathText>(
          "scratch", [](const O& o) { return textOf(o.source.scratch); },
          [](O& o, const PathText& directory) { o.source.scratch = directory.bytes; },
          "directory for unnamed files of the samples; empty: memory"),
      Field<O, std::string, std::string>(
          "method", [](const O& o) { return evaluation::name(o.method); },
          [](O& o, const std::string& name) { o.method = evaluation::accelerationMethod(name); },
          "auto, low-pass, given or backward-difference"),
      inherited<O>("cutoff", &O::cutoff, "Hz; 0: chosen from the data"),
      Field<O, Names, Names>(
          "without_rules", [](const O&) { return Names(); },
          [](O& o, const Names& names) { o.rules = evaluation::rulesWithout(names); },
          "rules not to be acted upon"),
      inherited<O>("effort", &O::effort, "what is stated of efforts"),
      inherited<O>("recording", &O::recording, "for errors' texts"),
      inherited<O>("topic", &O::topic, "of the recording"),
      inherited<O>("units", &O::units, "N m or N, of each joint"),
      inherited<O>("notes", &O::notes, "of reading"));
}

Evaluated readMotion(const SolverObject& solver, const py::object& motion, const Options& given,
                     const py::function& progress) {
  const auto shared = solverOf(solver);
  evaluation::EvaluationOptions options = given;
  options.progress = telling(progress);
  if (py::isinstance<evaluation::Recording>(motion)) {
    const auto& recording = motion.cast<const evaluation::Recording&>();
    const py::gil_scoped_release release;
    return evaluation::readMotion(*recording.jointStates(options.topic, given.source), given.source,
                                  *shared, options);
  }
  const Log log(motion);
  if (log.effort.size() == 0) {
    throw evaluation::EvaluationError(options.recording, "effort", "one row per sample", "none",
                                      "torques without efforts: trajectory_torques()");
  }
  const evaluation::RecordedColumns view = log.view();
  const py::gil_scoped_release release;
  return evaluation::readMotion(view, *shared, options);
}

// The samples are shared with what was given, which stays usable for another evaluation.
Evaluated computeTorques(Evaluated motion, const SolverObject& solver, const Options& given,
                         const py::function& progress) {
  const auto shared = solverOf(solver);
  evaluation::EvaluationOptions options = given;
  options.progress = telling(progress);
  const py::gil_scoped_release release;
  evaluation::computeTorques(motion, *shared, options);
  return motion;
}

Evaluated compareTorques(Evaluated motion, const SolverObject& solver, const Options& given,
                         const py::function& progress, const SolverObject& subtracted,
                         const std::optional<EffortVerdict>& verdict) {
  const auto shared = solverOf(solver), robots = solverOf(subtracted);
  evaluation::EvaluationOptions options = given;
  options.subtracted = robots.get();
  options.progress = telling(progress);
  const py::gil_scoped_release release;
  evaluation::compareTorques(motion, *shared, options, verdict.value_or(EffortVerdict()));
  return motion;
}

void checkOptions(const std::string& method, const std::optional<double>& cutoff,
                  const Names& without_rules, const std::optional<std::string>& effort_is) {
  evaluation::EvaluationOptions options;
  options.method = evaluation::accelerationMethod(method);
  options.rules = evaluation::rulesWithout(without_rules);
  options.cutoff = cutoff.value_or(0.0);
  options.effort.option = effort_is;
  options.effort.drive_gains = {1.0};  // whether there are any is up to the robot
  evaluation::checkOptions(options);
}

}  // namespace

void bindEvaluator(py::module_& module) {
  bindErrors(module);
  bindHow(module);
  bindEffort(module);
  bindEvaluated(module);
  bindEvaluationOptions(module);
  module.def(
      "read_motion", &readMotion, "solver"_a, "motion"_a, "options"_a, "progress"_a,
      "Samples of recorded joint states, their faults and accelerations.\n\n"
      "motion: a JointLog, or a Recording, whose topic is read. progress: called with the share\n"
      "that is done.");
  module.def("compute_torques", &computeTorques, "motion"_a, "solver"_a, "options"_a, "progress"_a,
             "Torques of what read_motion() gave, with gravity.");
  module.def("compare_torques", &compareTorques, "motion"_a, "solver"_a, "options"_a, "progress"_a,
             "subtracted"_a, "verdict"_a = py::none(),
             "Measured torques and errors of what compute_torques() computed.\n\n"
             "subtracted: a solver, whose gravity efforts without gravity lack. verdict: what the "
             "data say\n"
             "of efforts that are `auto`.");
  module.def("check_options", &checkOptions, "method"_a, "cutoff"_a, "without_rules"_a,
             "effort_is"_a, "Raise EvaluationError for what no recording can be evaluated with.");
  module.def(
      "check_torques",
      [](const std::string& where, const Names& joint_names, const Names& units,
         const Array& computed) {
        evaluation::requirePossibleTorques(where, joint_names, units, states(computed, "computed"),
                                           0);
      },
      "where"_a, "joint_names"_a, "units"_a, "computed"_a,
      "Raise EvaluationError for (N, n) computed torques that no robot has, infinite ones too.");
}

}  // namespace inverse_dynamics_tools

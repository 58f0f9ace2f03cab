// SPDX-License-Identifier: Apache-2.0
#include "evaluator.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <inverse_dynamics_evaluation/effort.hpp>
#include <inverse_dynamics_evaluation/evaluator.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "annotations.hpp"
#include "arrays.hpp"
#include "description.hpp"
#include "initialized.hpp"
#include "recordings.hpp"
#include "run_configuration.hpp"
#include "solver.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace evaluation = inverse_dynamics_evaluation;
using Eigen::Index;
using evaluation::EffortVerdict;
using Names = std::vector<std::string>;

using Evaluated = evaluation::Evaluation;

}  // namespace
}  // namespace inverse_dynamics_tools

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::EffortVerdict)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::Evaluation)

namespace inverse_dynamics_tools {
namespace {

std::string effortSummary(const std::string& meaning, const std::string& stated_by,
                          const std::vector<double>& drive_gains,
                          const std::optional<EffortVerdict>& verdict) {
  return evaluation::Effort{meaning, stated_by, drive_gains, verdict}.summary();
}

/// What JointLog of joint_log.py holds of the samples.
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

/// EvaluationOptions and RecordingOptions, by keyword.
struct Options : evaluation::EvaluationOptions {
  evaluation::RecordingOptions source;
};

evaluation::Evaluation evaluate(const SolverObject& solver, const py::object& motion,
                                const Options& given, const py::function& ask,
                                const py::function& progress) {
  const auto shared = solverOf(solver);
  evaluation::EvaluationOptions options = given;
  options.progress = [&](double share) {
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    progress(share);
  };
  options.ask = [&](const Evaluated& found) {
    const py::gil_scoped_acquire acquire;
    return ask(py::cast(found)).cast<EffortVerdict>();
  };
  if (py::isinstance<evaluation::Recording>(motion)) {
    const auto& recording = motion.cast<const evaluation::Recording&>();
    const py::gil_scoped_release release;
    return evaluation::evaluate(*recording.jointStates(options.topic), given.source, *shared,
                                options);
  }
  const Log log(motion);
  if (log.effort.size() == 0) {
    throw evaluation::EvaluationError(options.recording, "effort", "one row per sample", "none",
                                      "torques without efforts: trajectory_torques()");
  }
  const evaluation::RecordedColumns view = log.view();
  const py::gil_scoped_release release;
  return evaluation::evaluate(view, *shared, options);
}

void bindReading(py::class_<Options>& options) {
  options
      .def_property(
          "joints", [](const Options& o) { return o.source.joints; },
          [](Options& o, const Names& joints) { o.source.joints = joints; },
          "in the recording, in the order of the chain")
      .def_property(
          "clock", [](const Options& o) { return evaluation::name(o.source.clock); },
          [](Options& o, const std::string& clock) { o.source.clock = clockOf(clock); })
      .def_property(
          "window",
          [](const Options& o) { return std::pair(o.source.window.from, o.source.window.to); },
          [](Options& o, const std::pair<double, double>& window) {
            o.source.window = {window.first, window.second};
          },
          "s since the first sample; what lies outside is left out")
      .def_property(
          "scratch", [](const Options& o) { return py::bytes(o.source.scratch); },
          [](Options& o, const PathText& directory) { o.source.scratch = directory.bytes; },
          "directory for unnamed files of the samples; empty: memory");
}

void bindOptions(py::module_& module) {
  py::class_<Options> options(
      module, "EvaluationOptions",
      "How evaluate() is to work, by keyword: EvaluationOptions and, for a\n"
      "recording, RecordingOptions of inverse_dynamics_evaluation.");
  options
      .def(py::init([](const py::kwargs& given) {
        auto made = std::make_unique<Options>();
        made->source.joints_option = "--joints";
        const py::object self = py::cast(made.get(), py::return_value_policy::reference);
        for (const auto& [name, value] : given) py::setattr(self, name, value);
        return made;
      }))
      .def_property(
          "method", [](const Options& o) { return evaluation::name(o.method); },
          [](Options& o, const std::string& name) {
            o.method = evaluation::accelerationMethod(name);
          },
          "auto, low-pass, given or backward-difference")
      .def_readwrite("cutoff", &Options::cutoff, "Hz; 0: chosen from the data")
      .def_property(
          "without_rules", nullptr,
          [](Options& o, const Names& names) { o.rules = evaluation::rulesWithout(names); },
          "rules not to be acted upon")
      .def_readwrite("effort", &Options::effort)
      .def_readwrite("recording", &Options::recording, "for errors' texts")
      .def_readwrite("topic", &Options::topic, "of the recording")
      .def_readwrite("units", &Options::units)
      .def_readwrite("notes", &Options::notes, "of reading");
  bindReading(options);
}

void bindEffort(py::module_& module) {
  py::class_<EffortVerdict>(module, "EffortVerdict", "What the data say efforts mean.")
      .def(py::init([](std::string best, bool sure, std::string summary, std::string reason) {
             return EffortVerdict{std::move(best), sure, std::move(summary), std::move(reason)};
           }),
           py::arg("best"), py::arg("sure"), py::arg("summary"), py::arg("reason"))
      .def_readonly("best", &EffortVerdict::best)
      .def_readonly("sure", &EffortVerdict::sure)
      .def_readonly("summary", &EffortVerdict::summary)
      .def_readonly("reason", &EffortVerdict::reason);
  py::class_<evaluation::EffortOptions>(module, "EffortOptions",
                                        "What is stated of efforts, and by whom: effort_options().")
      .def_readonly("drive_gains", &evaluation::EffortOptions::drive_gains, "(n,) N m/A, or none");
  module.def("effort_summary", &effortSummary, py::arg("meaning"), py::arg("stated_by"),
             py::arg("drive_gains"), py::arg("verdict"), "What efforts mean, in words.");
}

}  // namespace

void bindEvaluator(py::module_& module) {
  bindEffort(module);
  bindOptions(module);
  py::class_<Evaluated>(module, "Evaluated", "What came of evaluate().")
      .def_property_readonly(
          "method", [](const Evaluated& e) { return evaluation::name(e.accelerations.method); })
      .def_property_readonly(
          "filter", [](const Evaluated& e) { return e.accelerations.filter; },
          "What the low-pass did, if there was one.")
      .def_property_readonly("period",
                             [](const Evaluated& e) { return e.accelerations.samples.period; })
      .def_property_readonly("jitter",
                             [](const Evaluated& e) { return e.accelerations.samples.jitter; })
      .def_property_readonly("table", [](const Evaluated& e) { return e.table; })
      .def_property_readonly("meaning", [](const Evaluated& e) { return e.effort.meaning; })
      .def_property_readonly("stated_by", [](const Evaluated& e) { return e.effort.stated_by; })
      .def_property_readonly("drive_gains", [](const Evaluated& e) { return e.effort.drive_gains; })
      .def_property_readonly("verdict", [](const Evaluated& e) { return e.effort.verdict; })
      .def_property_readonly("errors", [](const Evaluated& e) { return e.errors; })
      .def_property_readonly("errors_of_kept", [](const Evaluated& e) { return e.errors_of_kept; })
      .def_property_readonly("reading_seconds",
                             [](const Evaluated& e) { return e.reading_seconds; })
      .def_property_readonly("acceleration_seconds",
                             [](const Evaluated& e) { return e.acceleration_seconds; })
      .def_property_readonly("torque_seconds", [](const Evaluated& e) { return e.torque_seconds; })
      .def_property_readonly("notes", [](const Evaluated& e) { return e.notes; });
  module.def(
      "evaluate", &evaluate, py::arg("solver"), py::arg("motion"), py::arg("options"),
      py::arg("ask"), py::arg("progress"),
      "Computed torques of recorded joint states and their errors.\n\n"
      "motion: a JointLog, or a Recording, whose topic is read. ask: called with what is known\n"
      "before efforts are, if they are `auto`; returns an EffortVerdict. progress: called with\n"
      "the share that is done.");
  module.def(
      "check_options",
      [](const std::string& method, const std::optional<double>& cutoff, const Names& without_rules,
         const std::optional<std::string>& effort_is) {
        evaluation::EvaluationOptions options;
        options.method = evaluation::accelerationMethod(method);
        options.rules = evaluation::rulesWithout(without_rules);
        options.cutoff = cutoff.value_or(0.0);
        options.effort.option = effort_is;
        options.effort.drive_gains = {1.0};  // whether there are any is up to the robot
        evaluation::checkOptions(options);
      },
      py::arg("method"), py::arg("cutoff"), py::arg("without_rules"), py::arg("effort_is"),
      "Raise EvaluationError for what no recording can be evaluated with.");
  module.def(
      "acceleration_summary",
      [](const std::string& method, const std::optional<double>& cutoff, bool chosen) {
        return evaluation::accelerationSummary(evaluation::accelerationMethod(method),
                                               cutoff.value_or(0.0), chosen);
      },
      py::arg("method"), py::arg("cutoff"), py::arg("chosen"),
      "How accelerations came about, in words.");
  module.def(
      "check_torques",
      [](const std::string& where, const Names& joint_names, const Names& units,
         const Array& computed) {
        evaluation::requirePossibleTorques(where, joint_names, units, states(computed, "computed"),
                                           0);
      },
      py::arg("where"), py::arg("joint_names"), py::arg("units"), py::arg("computed"),
      "Raise EvaluationError for (N, n) computed torques that no robot has, infinite ones too.");
}

}  // namespace inverse_dynamics_tools

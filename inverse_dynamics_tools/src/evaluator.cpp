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

#include "arrays.hpp"
#include "initialized.hpp"
#include "solver.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace evaluation = inverse_dynamics_evaluation;
using Eigen::Index;
using evaluation::EffortCandidate;
using evaluation::EffortVerdict;
using Names = std::vector<std::string>;

/// An evaluation with its series.
struct Evaluated {
  evaluation::Evaluation evaluation;
  py::array qdd, computed;  // (N, n)
};

}  // namespace
}  // namespace inverse_dynamics_tools

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::EffortCandidate)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::EffortVerdict)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::EffortOptions)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_tools::Evaluated)

namespace inverse_dynamics_tools {
namespace {

using Booleans = Eigen::Array<bool, Eigen::Dynamic, 1>;
using MaskArray = py::array_t<bool, py::array::c_style>;

EffortVerdict compareMeanings(const Array& computed, const Array& gravity, const Array& effort,
                              const std::vector<double>& drive_gains,
                              const std::optional<MaskArray>& mask) {
  const ConstMap computed_in = states(computed, "computed"),
                 gravity_in = states(gravity, "gravity"), effort_in = states(effort, "effort");
  const evaluation::Mask counts =
      mask ? evaluation::Mask(Eigen::Map<const Booleans>(mask->data(), mask->size()))
           : evaluation::Mask(Booleans::Constant(computed_in.cols(), true));
  const py::gil_scoped_release release;
  return evaluation::compareMeanings(computed_in, gravity_in, effort_in, drive_gains, counts);
}

std::string effortSummary(const std::string& meaning, const std::string& stated_by,
                          const std::vector<double>& drive_gains,
                          const std::optional<EffortVerdict>& verdict) {
  return evaluation::Effort{meaning, stated_by, drive_gains, verdict}.summary();
}

/// What JointLog of joint_log.py holds of the samples.
struct Log {
  explicit Log(const py::handle& log)
      : stamps(log.attr("stamps").cast<Integers>()),
        clock(log.attr("clock").cast<std::string>()),
        q(log.attr("q").cast<Array>()),
        qd(log.attr("qd").cast<Array>()),
        effort(log.attr("effort").cast<Array>()) {
    if (!log.attr("qdd").is_none()) qdd = log.attr("qdd").cast<Array>();
  }

  evaluation::JointLogView view() const {
    const Eigen::Map<const Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>> read(stamps.data(),
                                                                                stamps.size());
    const ConstMap none(nullptr, 0, 0);
    return {read,
            clock == "receive" ? evaluation::Clock::kReceive : evaluation::Clock::kHeader,
            states(q, "q"),
            states(qd, "qd"),
            states(effort, "effort"),
            qdd ? states(*qdd, "qdd") : none};
  }

  Integers stamps;
  std::string clock;
  Array q, qd, effort;
  std::optional<Array> qdd;
};

Evaluated evaluate(const py::object& solver, const py::object& log, const std::string& method,
                   const std::optional<double>& cutoff, const Names& without_rules,
                   const evaluation::EffortOptions& effort, const std::string& recording,
                   const std::string& topic, const Names& units, const Names& notes) {
  const auto shared = solverOf(solver);
  const Log samples(log);
  evaluation::EvaluationOptions options;
  options.method = evaluation::accelerationMethod(method);
  options.rules = evaluation::rulesWithout(without_rules);
  options.cutoff = cutoff.value_or(0.0);
  options.effort = effort;
  options.recording = recording;
  options.topic = topic;
  options.units = units;
  options.notes = notes;
  Evaluated result;
  Array computed = like(samples.q);
  Map into = columns(computed);
  {
    const py::gil_scoped_release release;
    result.evaluation = evaluation::evaluate(
        samples.view(), *shared, options, [&](const evaluation::EvaluatedSamples& next) {
          into.middleCols(next.first, next.computed.cols()) = next.computed;
        });
  }
  result.computed = std::move(computed);
  result.qdd = rowsOf(std::move(result.evaluation.accelerations.qdd));
  return result;
}

void bindEffort(py::module_& module) {
  py::class_<EffortCandidate>(module, "EffortCandidate",
                              "A meaning of efforts, and how far it is from the recorded ones.")
      .def(py::init([](std::string meaning, double error, double margin, Index worse_in) {
             return EffortCandidate{std::move(meaning), error, margin, worse_in};
           }),
           py::arg("meaning"), py::arg("error"), py::arg("margin"), py::arg("worse_in"))
      .def_readonly("meaning", &EffortCandidate::meaning)
      .def_readonly("error", &EffortCandidate::error)
      .def_readonly("margin", &EffortCandidate::margin)
      .def_readonly("worse_in", &EffortCandidate::worse_in);
  py::class_<EffortVerdict>(module, "EffortVerdict",
                            "Candidates, the best first, and whether it is sure: see\n"
                            "inverse_dynamics_evaluation/effort_verdict.hpp.")
      .def(py::init([](std::vector<EffortCandidate> candidates, bool sure, Index stretches,
                       std::string reason) {
             if (candidates.empty()) throw py::value_error("candidates: expected one or more");
             return EffortVerdict{std::move(candidates), sure, stretches, std::move(reason)};
           }),
           py::arg("candidates"), py::arg("sure"), py::arg("stretches"), py::arg("reason") = "")
      .def_readonly("candidates", &EffortVerdict::candidates)
      .def_readonly("sure", &EffortVerdict::sure)
      .def_readonly("stretches", &EffortVerdict::stretches)
      .def_readonly("reason", &EffortVerdict::reason)
      .def_property_readonly("rivals", &EffortVerdict::rivals)
      .def_property_readonly("summary", &EffortVerdict::summary);
  py::class_<evaluation::EffortOptions>(
      module, "EffortOptions", "What is stated of efforts, and by whom: effort_options().");
  module.def("compare_meanings", &compareMeanings, py::arg("computed"), py::arg("gravity"),
             py::arg("effort"), py::arg("drive_gains") = std::vector<double>(),
             py::arg("mask") = py::none(),
             "Which meaning of recorded efforts fits the data. computed, gravity, effort: (N, n);\n"
             "drive_gains: (n,) or none; mask: (N,) samples that count.");
  module.def("effort_summary", &effortSummary, py::arg("meaning"), py::arg("stated_by"),
             py::arg("drive_gains"), py::arg("verdict"), "What efforts mean, in words.");
}

}  // namespace

void bindEvaluator(py::module_& module) {
  bindEffort(module);
  py::class_<Evaluated>(module, "Evaluated", "What came of evaluate().")
      .def_property_readonly(
          "method",
          [](const Evaluated& e) { return evaluation::name(e.evaluation.accelerations.method); })
      .def_property_readonly(
          "filter", [](const Evaluated& e) { return e.evaluation.accelerations.filter; },
          "What the low-pass did, if there was one.")
      .def_property_readonly("samples",
                             [](const Evaluated& e) { return e.evaluation.accelerations.samples; })
      .def_readonly("qdd", &Evaluated::qdd, "(N, n) rad/s^2 (prismatic m/s^2).")
      .def_readonly("computed", &Evaluated::computed,
                    "(N, n) N m (prismatic N); without gravity where the efforts are.")
      .def_property_readonly("meaning",
                             [](const Evaluated& e) { return e.evaluation.effort.meaning; })
      .def_property_readonly("stated_by",
                             [](const Evaluated& e) { return e.evaluation.effort.stated_by; })
      .def_property_readonly("drive_gains",
                             [](const Evaluated& e) { return e.evaluation.effort.drive_gains; })
      .def_property_readonly("verdict",
                             [](const Evaluated& e) { return e.evaluation.effort.verdict; })
      .def_property_readonly("errors", [](const Evaluated& e) { return e.evaluation.errors; })
      .def_property_readonly("errors_of_kept",
                             [](const Evaluated& e) { return e.evaluation.errors_of_kept; })
      .def_property_readonly("acceleration_seconds",
                             [](const Evaluated& e) { return e.evaluation.acceleration_seconds; })
      .def_property_readonly("torque_seconds",
                             [](const Evaluated& e) { return e.evaluation.torque_seconds; })
      .def_property_readonly("notes", [](const Evaluated& e) { return e.evaluation.notes; });
  module.def(
      "evaluate", &evaluate, py::arg("solver"), py::arg("log"), py::kw_only(), py::arg("method"),
      py::arg("cutoff"), py::arg("without_rules"), py::arg("effort"), py::arg("recording"),
      py::arg("topic"), py::arg("units"), py::arg("notes"),
      "Computed torques of recorded joint states, a JointLog, and their errors.\n\n"
      "method: auto, low-pass, given or backward-difference. cutoff: Hz; None: chosen from the\n"
      "data. recording, topic: for errors' texts.");
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

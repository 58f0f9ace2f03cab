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
#include "joint_log.hpp"
#include "joint_states.hpp"
#include "run_configuration.hpp"
#include "solver.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace evaluation = inverse_dynamics_evaluation;
using Eigen::Index;
using evaluation::EffortCandidate;
using evaluation::EffortVerdict;
using Names = std::vector<std::string>;

using Evaluated = evaluation::Evaluation;

}  // namespace
}  // namespace inverse_dynamics_tools

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::EffortCandidate)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::EffortVerdict)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::Evaluation)

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
      : header_stamps(log.attr("header_stamps").cast<Integers>()),
        receive_stamps(log.attr("receive_stamps").cast<Integers>()),
        clock(log.attr("clock").cast<std::string>()),
        q(log.attr("q").cast<Array>()),
        qd(log.attr("qd").cast<Array>()),
        effort(log.attr("effort").cast<Array>()) {
    if (!log.attr("qdd").is_none()) qdd = log.attr("qdd").cast<Array>();
  }

  evaluation::JointLogView view() const {
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

/// A copy (N, n), or (N,) of a vector, of samples that are columns.
template <class Columns>
py::array copyOf(const Columns& columns) {
  using Scalar = typename Columns::Scalar;
  const Eigen::Map<const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>, 0,
                   Eigen::OuterStride<>>
      view(columns.data(), columns.rows(), columns.cols(),
           Eigen::OuterStride<>(columns.outerStride()));
  std::vector<py::ssize_t> shape = {columns.cols(), columns.rows()};
  if (Columns::ColsAtCompileTime == 1) shape = {columns.rows()};
  py::array_t<Scalar> array(shape);
  Eigen::Map<Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>>(
      array.mutable_data(), columns.rows(), columns.cols()) = view;
  return array;
}

/// The samples by the names that files of results have for them.
py::dict seriesOf(const evaluation::EvaluatedSamples& samples) {
  py::dict series;
  series["time"] = copyOf(samples.time);
  series["header_stamps"] = copyOf(samples.header_stamps);
  series["receive_stamps"] = copyOf(samples.receive_stamps);
  series["q"] = copyOf(samples.q);
  series["qd"] = copyOf(samples.qd);
  series["qdd"] = copyOf(samples.qdd);
  series["effort"] = copyOf(samples.effort);
  series["measured"] = copyOf(samples.measured);
  series["computed"] = copyOf(samples.computed);
  series["repeated"] = copyOf(samples.repeated);
  series["non_increasing"] = copyOf(samples.non_increasing);
  series["start_transient"] = copyOf(samples.start_transient);
  series["isolated"] = copyOf(samples.isolated);
  series["kept"] = copyOf(samples.kept);
  return series;
}

/// @param motion  a JointLog, or JointStates of a recording; joints, clock, start and end are for the
///                latter.
evaluation::Evaluation evaluate(const SolverObject& solver, const py::object& motion,
                                const Names& joints, const std::string& clock, double start,
                                double end, const std::string& method,
                                const std::optional<double>& cutoff, const Names& without_rules,
                                const evaluation::EffortOptions& effort,
                                const std::string& recording, const std::string& topic,
                                const Names& units, const Names& notes, const PathText& scratch,
                                const py::function& take, const py::function& progress) {
  const auto shared = solverOf(solver);
  evaluation::EvaluationOptions options;
  options.method = evaluation::accelerationMethod(method);
  options.rules = evaluation::rulesWithout(without_rules);
  options.cutoff = cutoff.value_or(0.0);
  options.effort = effort;
  options.recording = recording;
  options.topic = topic;
  options.units = units;
  options.notes = notes;
  options.progress = [&](double share) {
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    progress(share);
  };
  const auto give = [&](const evaluation::EvaluatedSamples& next) {
    const py::gil_scoped_acquire acquire;
    take(next.all, next.frame_id, seriesOf(next));
  };
  if (py::isinstance<JointStates>(motion)) {
    auto& states = motion.cast<JointStates&>();
    const InUse reader(states);
    const evaluation::RecordingOptions which = {
        joints, clockOf(clock), {true, "--joints"}, scratch.bytes, {start, end}};
    const py::gil_scoped_release release;
    return evaluation::evaluate(*states.source, which, *shared, options, give);
  }
  const Log log(motion);
  if (log.effort.size() == 0) {
    throw evaluation::EvaluationError(recording, "effort", "one row per sample", "none",
                                      "torques without efforts: trajectory_torques()");
  }
  const evaluation::JointLogView view = log.view();
  const py::gil_scoped_release release;
  return evaluation::evaluate(view, *shared, options, give);
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
  const py::class_<evaluation::EffortOptions> effort_options(
      module, "EffortOptions", "What is stated of efforts, and by whom: effort_options().");
  module.def("compare_meanings", &compareMeanings, py::arg("computed"), py::arg("gravity"),
             py::arg("effort"), py::arg("drive_gains") = std::vector<double>(),
             py::arg("mask") = py::none(),
             "Which meaning of recorded efforts fits the data. computed, gravity, effort: (N, n);\n"
             "drive_gains: (n,) or none; mask: (N,) marks the valid samples.");
  module.def("effort_summary", &effortSummary, py::arg("meaning"), py::arg("stated_by"),
             py::arg("drive_gains"), py::arg("verdict"), "What efforts mean, in words.");
}

}  // namespace

void bindEvaluator(py::module_& module) {
  bindEffort(module);
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
      .def_property_readonly(
          "recording", [](const Evaluated& e) { return e.recording; },
          "Names, clock and notes of a recording that was read.")
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
      "evaluate", &evaluate, py::arg("solver"), py::arg("motion"), py::kw_only(), py::arg("joints"),
      py::arg("clock"), py::arg("start"), py::arg("end"), py::arg("method"), py::arg("cutoff"),
      py::arg("without_rules"), py::arg("effort"), py::arg("recording"), py::arg("topic"),
      py::arg("units"), py::arg("notes"), py::arg("scratch"), py::arg("take"), py::arg("progress"),
      "Computed torques of recorded joint states and their errors, in bounded memory.\n\n"
      "motion: a JointLog, or JointStates, of which joints, clock, and what lies between start "
      "and\n"
      "end, s since the first sample, are taken. method: auto, low-pass, given or\n"
      "backward-difference. cutoff: Hz; None: chosen from the data.\n"
      "recording, topic: for errors' texts. scratch: a directory for a file of samples, or \"\".\n"
      "take: called with how many samples there are, the frame of a recording that was read, and\n"
      "the arrays of the next ones by name, some thousand at a time. progress: called with the\n"
      "share that is done.");
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

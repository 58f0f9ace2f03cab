// SPDX-License-Identifier: Apache-2.0
#include "accelerations.hpp"

#include <pybind11/stl.h>

#include <inverse_dynamics_evaluation/accelerations.hpp>
#include <inverse_dynamics_evaluation/samples.hpp>
#include <string>
#include <tuple>
#include <utility>

#include "arrays.hpp"
#include "initialized.hpp"
#include "vectors.hpp"

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::SampleRules)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::SampleReport)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::CutoffChoice)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::FilterChoice)

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace evaluation = inverse_dynamics_evaluation;
using evaluation::CutoffChoice;
using evaluation::FilterChoice;
using evaluation::SampleReport;
using evaluation::SampleRules;

using ConstVector = Eigen::Map<const Eigen::VectorXd>;

ConstVector viewOf(const Array& array) { return {array.data(), array.size()}; }

Array backwardDifference(const Array& time, const Array& qd) {
  const ConstMap qd_in = states(qd, "qd");
  chain_dynamics::OwnedMatrix qdd;
  {
    const py::gil_scoped_release release;
    qdd = evaluation::backwardDifference(viewOf(time), qd_in);
  }
  return rowsOf(std::move(qdd));
}

std::tuple<Array, FilterChoice, SampleReport> lowPassAccelerations(const Array& time,
                                                                   const Array& q, const Array& qd,
                                                                   const Array& effort,
                                                                   double cutoff,
                                                                   const SampleRules& rules) {
  const ConstMap q_in = states(q, "q"), qd_in = states(qd, "qd"),
                 effort_in = states(effort, "effort");
  evaluation::LowPassOptions options;
  options.cutoff = cutoff;
  options.rules = rules;
  evaluation::AccelerationEstimate estimate;
  {
    const py::gil_scoped_release release;
    estimate = evaluation::lowPassAccelerations(viewOf(time), q_in, qd_in, effort_in, options);
  }
  return {rowsOf(std::move(estimate.qdd)), std::move(estimate.filter), std::move(estimate.samples)};
}

SampleReport examineSamples(const Array& time, const Array& q, const Array& qd, const Array& effort,
                            const SampleRules& rules) {
  const ConstMap q_in = states(q, "q"), qd_in = states(qd, "qd"),
                 effort_in = states(effort, "effort");
  const py::gil_scoped_release release;
  return evaluation::examineSamples(viewOf(time), q_in, qd_in, effort_in, rules);
}

Array lowPass(const Array& samples, double sampling_frequency, double cutoff, int order,
              Eigen::Index padding) {
  const ConstMap in = states(samples, "samples");
  chain_dynamics::OwnedMatrix result;
  {
    const py::gil_scoped_release release;
    result = evaluation::lowPass(in, sampling_frequency, cutoff, order, padding);
  }
  return rowsOf(std::move(result));
}

void bindSampleReport(py::module_& module) {
  py::class_<SampleRules>(module, "SampleRules",
                          "Which rules on faults of samples are acted upon: see\n"
                          "inverse_dynamics_evaluation/samples.hpp.")
      .def(py::init([](bool repeated, bool non_increasing, bool time_base, bool start_transient) {
             SampleRules rules;
             rules.repeated = repeated;
             rules.non_increasing = non_increasing;
             rules.time_base = time_base;
             rules.start_transient = start_transient;
             return rules;
           }),
           py::kw_only(), py::arg("repeated") = true, py::arg("non_increasing") = true,
           py::arg("time_base") = true, py::arg("start_transient") = true);
  py::class_<SampleReport>(module, "SampleReport", "What was found in N samples.")
      .def_readonly("repeated", &SampleReport::repeated)
      .def_readonly("non_increasing", &SampleReport::non_increasing)
      .def_readonly("start_transient", &SampleReport::start_transient)
      .def_readonly("isolated", &SampleReport::isolated)
      .def_readonly("used", &SampleReport::used)
      .def_readonly("kept", &SampleReport::kept)
      .def_property_readonly("time_base",
                             [](const SampleReport& r) { return evaluation::name(r.time_base); })
      .def_readonly("time", &SampleReport::time)
      .def_readonly("pieces", &SampleReport::pieces)
      .def_readonly("period", &SampleReport::period)
      .def_readonly("stamped_period", &SampleReport::stamped_period)
      .def_readonly("jitter", &SampleReport::jitter);
  module.def("examine_samples", &examineSamples, py::arg("time"), py::arg("q"), py::arg("qd"),
             py::arg("effort"), py::arg("rules") = SampleRules(),
             "What is wrong with recorded joint states, and when they were really taken.\n\n"
             "time: (N,) s. q, qd, effort: (N, n).");
}

}  // namespace

void bindAccelerations(py::module_& module) {
  bindSampleReport(module);

  py::class_<CutoffChoice>(module, "CutoffChoice", "How a cut-off was chosen [Hz].")
      .def_readonly("cutoff", &CutoffChoice::cutoff)
      .def_readonly("lowest", &CutoffChoice::lowest)
      .def_readonly("highest", &CutoffChoice::highest)
      .def_readonly("moving", &CutoffChoice::moving);
  py::class_<FilterChoice>(module, "FilterChoice", "What a filter did.")
      .def_readonly("method", &FilterChoice::method)
      .def_readonly("cutoff", &FilterChoice::cutoff)
      .def_readonly("chosen", &FilterChoice::chosen)
      .def_readonly("choice", &FilterChoice::choice)
      .def_readonly("order", &FilterChoice::order)
      .def_readonly("sampling_frequency", &FilterChoice::sampling_frequency)
      .def_property_readonly("time_base",
                             [](const FilterChoice& c) { return evaluation::name(c.time_base); })
      .def_readonly("pieces", &FilterChoice::pieces);

  module.def("backward_difference", &backwardDifference, py::arg("time"), py::arg("qd"),
             "(qd[k] - qd[k-1]) / (t[k] - t[k-1]); the first sample zero. time: (N,); qd: (N, n).");
  module.def("low_pass_accelerations", &lowPassAccelerations, py::arg("time"), py::arg("q"),
             py::arg("qd"), py::arg("effort"), py::arg("cutoff") = 0.0,
             py::arg("rules") = SampleRules(),
             "Accelerations by a zero-phase low-pass of the velocities, then their derivative.\n\n"
             "time: (N,) s. q, qd, effort: (N, n). cutoff: Hz; 0: chosen from the data. Returns\n"
             "(qdd, FilterChoice, SampleReport).");
  module.def("low_pass", &lowPass, py::arg("samples"), py::arg("sampling_frequency"),
             py::arg("cutoff"), py::arg("order") = 2, py::arg("padding") = -1,
             "Zero-phase Butterworth low-pass of equidistant samples (N, n).");
  module.def("low_pass_gain", &evaluation::lowPassGain, py::arg("frequency"), py::arg("cutoff"),
             py::arg("sampling_frequency"), py::arg("order") = 2,
             "Gain of low_pass() at a frequency.");
}

}  // namespace inverse_dynamics_tools

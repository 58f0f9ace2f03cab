// SPDX-License-Identifier: Apache-2.0
#include <inverse_dynamics_evaluation/accelerations.hpp>
#include <inverse_dynamics_evaluation/sample_table.hpp>
#include <inverse_dynamics_evaluation/samples.hpp>
#include <memory>
#include <tuple>

#include "arrays.hpp"
#include "bindings.hpp"

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using namespace py::literals;
namespace evaluation = inverse_dynamics_evaluation;

Eigen::Map<const Eigen::VectorXd> vectorIn(const Array& array) {
  return {array.data(), array.size()};
}

Array backwardDifference(const Array& time, const Array& qd) {
  const ConstMap qd_in = states(qd, "qd");
  return rowsOf(unlocked([&] { return evaluation::backwardDifference(vectorIn(time), qd_in); }));
}

std::tuple<Array, Array, double, double> lowPassAccelerations(const Array& time, const Array& q,
                                                              const Array& qd, const Array& effort,
                                                              double cutoff) {
  const ConstMap q_in = states(q, "q"), qd_in = states(qd, "qd"),
                 effort_in = states(effort, "effort");
  evaluation::LowPassOptions options;
  options.cutoff = cutoff;
  options.rules.start_transient = false;
  std::unique_ptr<evaluation::SampleTable> table;
  const auto filter = unlocked([&] {
    table = evaluation::tableOf(vectorIn(time), q_in, qd_in, effort_in);
    return evaluation::findAccelerations(*table, evaluation::AccelerationMethod::kLowPass, options)
        .filter;
  });
  return {rowsOf(table->qdd), arrayOf(table->instant), filter.cutoff, filter.sampling_frequency};
}

Array sampleInstants(const Array& time, const Array& q, const Array& qd, const Array& effort) {
  const ConstMap q_in = states(q, "q"), qd_in = states(qd, "qd"),
                 effort_in = states(effort, "effort");
  return arrayOf(unlocked([&] {
    const auto table = evaluation::tableOf(vectorIn(time), q_in, qd_in, effort_in);
    evaluation::examineSamples(*table);
    return Eigen::VectorXd(table->instant);
  }));
}

Array lowPass(const Array& samples, double sampling_frequency, double cutoff, int order,
              Eigen::Index padding) {
  const ConstMap in = states(samples, "samples");
  return rowsOf(unlocked(
      [&] { return evaluation::lowPass(in, sampling_frequency, cutoff, order, padding); }));
}

}  // namespace

void bindAccelerations(py::module_& module) {
  module.def("backward_difference", &backwardDifference, "time"_a, "qd"_a,
             "(qd[k] - qd[k-1]) / (t[k] - t[k-1]); the first sample zero. time: (N,); qd: (N, n).");
  module.def(
      "low_pass_accelerations", &lowPassAccelerations, "time"_a, "q"_a, "qd"_a, "effort"_a,
      "cutoff"_a = 0.0,
      "Accelerations by a zero-phase low-pass of the velocities, then their derivative; and\n"
      "when the samples were taken.\n\n"
      "time: (N,) s. q, qd, effort: (N, n). cutoff: Hz; 0: chosen from the data. Returns qdd,\n"
      "(N, n), instants, (N,) s, the cut-off and the frequency of the samples, Hz.");
  module.def(
      "sample_instants", &sampleInstants, "time"_a, "q"_a, "qd"_a, "effort"_a,
      "(N,) s: when recorded joint states were taken, by their stamps and what they tell.\n\n"
      "time: (N,) s. q, qd, effort: (N, n).");
  module.def("low_pass", &lowPass, "samples"_a, "sampling_frequency"_a, "cutoff"_a, "order"_a = 2,
             "padding"_a = -1, "Zero-phase Butterworth low-pass of equidistant samples (N, n).");
}

}  // namespace inverse_dynamics_tools

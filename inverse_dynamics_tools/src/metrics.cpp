// SPDX-License-Identifier: Apache-2.0
#include "metrics.hpp"

#include <pybind11/stl.h>

#include <inverse_dynamics_evaluation/metrics.hpp>
#include <optional>
#include <vector>

#include "arrays.hpp"
#include "initialized.hpp"

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::JointMetrics)

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace evaluation = inverse_dynamics_evaluation;
using evaluation::JointMetrics;
using MaskArray = py::array_t<bool, py::array::c_style>;

std::vector<JointMetrics> metricsOf(const Array& computed, const Array& measured,
                                    const std::optional<MaskArray>& mask) {
  const ConstMap computed_in = states(computed, "computed"),
                 measured_in = states(measured, "measured");
  if (!mask) {
    const py::gil_scoped_release release;
    return evaluation::metrics(computed_in, measured_in);
  }
  using Rows = Eigen::Array<bool, Eigen::Dynamic, 1>;
  const evaluation::Mask counts = Eigen::Map<const Rows>(mask->data(), mask->size());
  const py::gil_scoped_release release;
  return evaluation::metrics(computed_in, measured_in, counts);
}

}  // namespace

void bindMetrics(py::module_& module) {
  py::class_<JointMetrics>(module, "JointMetrics",
                           "Errors of one joint: see inverse_dynamics_evaluation/metrics.hpp.")
      .def_readonly("count", &JointMetrics::count)
      .def_readonly("mae", &JointMetrics::mae)
      .def_readonly("rmse", &JointMetrics::rmse)
      .def_readonly("nrmse", &JointMetrics::nrmse)
      .def_readonly("bias", &JointMetrics::bias)
      .def_readonly("r2", &JointMetrics::r2)
      .def_readonly("max_abs", &JointMetrics::max_abs)
      .def_readonly("max_at", &JointMetrics::max_at)
      .def_readonly("measured_range", &JointMetrics::measured_range);
  module.def("metrics", &metricsOf, py::arg("computed"), py::arg("measured"),
             py::arg("mask") = py::none(),
             "Errors of each joint: of all samples, or of those where mask (N,) is true.\n\n"
             "computed, measured: (N, n).");
}

}  // namespace inverse_dynamics_tools

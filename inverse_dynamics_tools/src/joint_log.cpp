// SPDX-License-Identifier: Apache-2.0
#include "joint_log.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <inverse_dynamics_evaluation/joint_log.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "annotations.hpp"
#include "initialized.hpp"
#include "joint_states.hpp"

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::JointLog)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::JointLogBuilder)

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace evaluation = inverse_dynamics_evaluation;
using evaluation::JointLog;
using evaluation::JointLogBuilder;

/// Adds the next messages of a recording; whether there were any.
bool addNext(JointLogBuilder& builder, JointStates& states) {
  const InUse reader(states);
  const py::gil_scoped_release release;
  if (!states.source->next(states.block)) return false;
  builder.add(states.block);
  return true;
}

JointLog finish(JointLogBuilder& builder, const std::string& clock) {
  return builder.finish(clockOf(clock));
}

/// (N, n), or (N,) of a vector: memory of `log`, which the array keeps alive.
template <auto Member>
auto view(const py::object& log) {
  auto& matrix = log.cast<JointLog&>().*Member;
  using Matrix = std::remove_reference_t<decltype(matrix)>;
  if constexpr (Matrix::IsVectorAtCompileTime) {
    return py::array_t<typename Matrix::Scalar>(matrix.size(), matrix.data(), log);
  } else {
    return py::array_t<typename Matrix::Scalar>({matrix.cols(), matrix.rows()}, matrix.data(), log);
  }
}

}  // namespace

evaluation::Clock clockOf(const std::string& clock) {
  for (const auto known : {evaluation::Clock::kHeader, evaluation::Clock::kReceive}) {
    if (clock == evaluation::name(known)) return known;
  }
  return evaluation::Clock::kAuto;
}

void bindJointLog(py::module_& module) {
  py::class_<JointLog>(module, "RecordedJoints",
                       "Joint states over time: JointLog of inverse_dynamics_evaluation.")
      .def_readonly("joint_names", &JointLog::joint_names)
      .def_property_readonly("header_stamps", &view<&JointLog::header_stamps>)
      .def_property_readonly("receive_stamps", &view<&JointLog::receive_stamps>)
      .def_property_readonly("q", &view<&JointLog::q>)
      .def_property_readonly("qd", &view<&JointLog::qd>)
      .def_property_readonly("effort", &view<&JointLog::effort>)
      .def_readonly("frame_id", &JointLog::frame_id)
      .def_property_readonly(
          "clock", [](const JointLog& log) -> ClockName { return py::str(name(log.clock)); })
      .def_readonly("notes", &JointLog::notes);
  py::class_<JointLogBuilder>(module, "JointLogBuilder",
                              "Collects messages, by the rules of "
                              "inverse_dynamics_evaluation/joint_log.hpp.")
      .def(py::init([](const JointStates& states, const std::vector<std::string>& joints) {
             return JointLogBuilder(states.source->where(), joints, {true, "--joints"});
           }),
           py::arg("states"), py::arg("joints"))
      .def_property_readonly("messages", &JointLogBuilder::samples, "How many were added.")
      .def("add_next", &addNext, py::arg("states"),
           "Add the next messages of a recording; whether there were any.")
      .def("finish", &finish, py::arg("clock"),
           "Everything added, whose memory the builder gives away: it holds no message then.");
}

}  // namespace inverse_dynamics_tools

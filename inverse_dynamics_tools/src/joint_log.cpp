// SPDX-License-Identifier: Apache-2.0
#include "joint_log.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <Eigen/Core>
#include <cstdint>
#include <inverse_dynamics_evaluation/joint_log.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "initialized.hpp"

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::JointLog)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::JointLogBuilder)

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
namespace evaluation = inverse_dynamics_evaluation;
using Eigen::Index;
using evaluation::JointLog;
using evaluation::JointLogBuilder;
using evaluation::JointSample;

void require(bool fulfilled, const char* what, Index expected, Index got) {
  if (fulfilled) return;
  throw py::value_error("JointLogBuilder.add: " + std::string(what) + ": expected " +
                        std::to_string(expected) + ", got " + std::to_string(got));
}

/// Messages with the same names and array lengths: the NamedTuple Block of joint_state_cdr.py.
struct Block {
  explicit Block(const py::handle& block)
      : rows(block.attr("rows").cast<Integers>()),
        names(block.attr("names").cast<std::vector<std::string>>()),
        frame_id(block.attr("frame_id").cast<std::string>()),
        stamps(block.attr("stamps").cast<Integers>()),
        position(block.attr("position").cast<Array>()),
        velocity(block.attr("velocity").cast<Array>()),
        effort(block.attr("effort").cast<Array>()) {
    const Index count = rows.size();
    require(stamps.size() == count, "stamps of a block", count, stamps.size());
    for (const Array* array : {&position, &velocity, &effort}) {
      require(array->shape(0) == count, "rows of numbers of a block", count, array->shape(0));
    }
  }

  /// Message i of the block.
  JointSample sample(Index i) const {
    JointSample result{names};
    new (&result.position) JointSample::Numbers(row(position, i));
    new (&result.velocity) JointSample::Numbers(row(velocity, i));
    new (&result.effort) JointSample::Numbers(row(effort, i));
    result.header_stamp = stamps.data()[i];
    result.frame_id = frame_id;
    return result;
  }

  static JointSample::Numbers row(const Array& array, Index i) {
    return {array.data() + i * array.shape(1), array.shape(1)};
  }

  Integers rows;
  std::vector<std::string> names;
  std::string frame_id;
  Integers stamps;
  Array position, velocity, effort;
};

/// Adds messages, in the order in which they were received, whichever blocks they are in.
void add(JointLogBuilder& builder, const std::vector<py::object>& blocks,
         const Integers& received) {
  const std::vector<Block> decoded(blocks.begin(), blocks.end());
  std::vector<std::pair<const Block*, Index>> places(static_cast<std::size_t>(received.size()));
  for (const Block& block : decoded) {
    for (Index i = 0; i < block.rows.size(); ++i) {
      places.at(static_cast<std::size_t>(block.rows.data()[i])) = {&block, i};
    }
  }
  for (const auto& [block, i] : places) {
    if (block == nullptr) throw py::value_error("JointLogBuilder.add: a message is in no block");
  }
  const std::int64_t* stamp = received.data();
  const py::gil_scoped_release release;
  for (const auto& [block, i] : places) {
    JointSample sample = block->sample(i);
    sample.receive_stamp = *stamp++;
    sample.message = builder.samples();
    builder.add(sample);
  }
}

JointLog finish(JointLogBuilder& builder, const std::string& clock) {
  for (const auto known : {evaluation::Clock::kHeader, evaluation::Clock::kReceive}) {
    if (clock == evaluation::name(known)) return builder.finish(known);
  }
  return builder.finish(evaluation::Clock::kAuto);
}

/// (N, n), or (N,) of a vector: memory of `log`, which the array keeps alive.
template <auto Member>
py::array view(const py::object& log) {
  auto& matrix = log.cast<JointLog&>().*Member;
  using Matrix = std::remove_reference_t<decltype(matrix)>;
  if constexpr (Matrix::IsVectorAtCompileTime) {
    return py::array_t<typename Matrix::Scalar>(matrix.size(), matrix.data(), log);
  } else {
    return py::array_t<typename Matrix::Scalar>({matrix.cols(), matrix.rows()}, matrix.data(), log);
  }
}

}  // namespace

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
      .def_property_readonly("clock", [](const JointLog& log) { return name(log.clock); })
      .def_readonly("notes", &JointLog::notes);
  py::class_<JointLogBuilder>(module, "JointLogBuilder",
                              "Collects messages, by the rules of "
                              "inverse_dynamics_evaluation/joint_log.hpp.")
      .def(py::init([](const std::string& where, const std::vector<std::string>& joints) {
             return JointLogBuilder(where, joints, {true, "--joints"});
           }),
           py::arg("where"), py::arg("joints"))
      .def_property_readonly("messages", &JointLogBuilder::samples, "How many were added.")
      .def("add", &add, py::arg("blocks"), py::arg("received"),
           "Add blocks that together hold len(received) messages, received at these times [ns].")
      .def("finish", &finish, py::arg("clock"),
           "Everything added, whose memory the builder gives away: it holds no message then.");
}

}  // namespace inverse_dynamics_tools

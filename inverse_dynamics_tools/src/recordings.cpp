// SPDX-License-Identifier: Apache-2.0
#include "recordings.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <inverse_dynamics_evaluation/joint_state_writer.hpp>
#include <inverse_dynamics_evaluation/recording.hpp>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "annotations.hpp"
#include "arrays.hpp"
#include "description.hpp"
#include "initialized.hpp"
#include "joint_states.hpp"

namespace inverse_dynamics_tools {

namespace recordings = inverse_dynamics_evaluation;

/// Messages, thousands at a time.
struct Messages {
  std::unique_ptr<recordings::MessageSource> source;
};

/// A recording that is being written, and how many joints each of its topics has.
struct Writer {
  using Topic = std::tuple<std::string, std::vector<std::string>, std::string>;

  Writer(const std::string& path, recordings::Storage storage, const std::vector<Topic>& topics)
      : writer(path, storage, about(topics)) {
    for (const auto& [name, joint_names, frame_id] : topics) joints.push_back(joint_names.size());
  }

  static std::vector<recordings::JointStateTopic> about(const std::vector<Topic>& topics) {
    std::vector<recordings::JointStateTopic> made;
    made.reserve(topics.size());
    for (const auto& [name, joint_names, frame_id] : topics) {
      made.push_back({name, joint_names, frame_id});
    }
    return made;
  }

  recordings::JointStateWriter writer;
  std::vector<std::size_t> joints;
};

}  // namespace inverse_dynamics_tools

INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::Recording)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_evaluation::Connection)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_tools::Messages)
INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_tools::Writer)

namespace inverse_dynamics_tools {
namespace {

namespace py = pybind11;
using recordings::Connection;
using recordings::JointStateRows;
using recordings::Recording;

/// A text of a file as a Python string: bytes that aren't UTF-8 become lone surrogates.
py::str textOf(const std::string& text) {
  PyObject* const made =
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape");
  if (made == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(made);
}

recordings::Storage storageOf(const std::string& name) {
  for (const auto storage : {recordings::Storage::kSqlite3, recordings::Storage::kMcap}) {
    if (name == recordings::name(storage)) return storage;
  }
  throw py::value_error("storage: expected sqlite3 or mcap, got '" + name + "'");
}

std::tuple<std::vector<std::size_t>, std::vector<std::int64_t>, std::vector<py::bytes>> nextBlock(
    Messages& messages) {
  constexpr std::size_t kMessages = 4096, kBytes = 1 << 26;
  std::vector<std::size_t> connections;
  std::vector<std::int64_t> received;
  std::vector<py::bytes> data;
  recordings::Message message;
  for (std::size_t bytes = 0; connections.size() < kMessages && bytes < kBytes;) {
    if (!messages.source->next(message)) break;
    connections.push_back(message.connection);
    received.push_back(message.received);
    data.emplace_back(reinterpret_cast<const char*>(message.data), message.size);
    bytes += message.size;
  }
  if (connections.empty()) throw py::stop_iteration();
  return {std::move(connections), std::move(received), std::move(data)};
}

Array rowsOf(const inverse_dynamics_evaluation::JointStateNumbers& numbers, std::size_t count) {
  Array array(std::vector<py::ssize_t>{static_cast<py::ssize_t>(count),
                                       static_cast<py::ssize_t>(numbers.columns)});
  std::copy(numbers.values.begin(), numbers.values.end(), array.mutable_data());
  return array;
}

std::tuple<NameTuple, py::str, Integers, Integers, Array, Array, Array> nextStates(
    JointStates& states) {
  const InUse reader(states);
  auto& block = states.block;
  {
    const py::gil_scoped_release release;
    if (!states.source->next(block)) throw py::stop_iteration();
  }
  py::list names;
  for (const std::string& name : block.joint_names) names.append(textOf(name));
  const auto stamps = [](const std::vector<std::int64_t>& given) {
    return Integers(static_cast<py::ssize_t>(given.size()), given.data());
  };
  const std::size_t count = block.size();
  return {py::tuple(names),
          textOf(block.frame_id),
          stamps(block.header_stamps),
          stamps(block.receive_stamps),
          rowsOf(block.position, count),
          rowsOf(block.velocity, count),
          rowsOf(block.effort, count)};
}

/// Of a topic: header and receive stamps, position, velocity, effort.
using Rows = std::tuple<Integers, Integers, Array, Array, Array>;

/// Messages of a topic of n joints, looked at where they lie.
JointStateRows rowsOf(const Rows& given, std::size_t n) {
  const auto& [header, receive, position, velocity, effort] = given;
  const py::ssize_t count = header.size();
  bool fits = receive.size() == count;
  for (const Array* numbers : {&position, &velocity, &effort}) {
    fits = fits && numbers->ndim() == 2 && numbers->shape(0) == count &&
           numbers->shape(1) == static_cast<py::ssize_t>(n);
  }
  if (!fits) throw py::value_error("joint states: expected stamps (N,) and numbers (N, n)");
  return {static_cast<std::size_t>(count),
          header.data(),
          receive.data(),
          position.data(),
          velocity.data(),
          effort.data()};
}

void write(Writer& writer, const std::vector<Rows>& topics) {
  if (topics.size() != writer.joints.size()) {
    throw py::value_error("JointStateWriter.write: expected rows of each topic");
  }
  std::vector<JointStateRows> rows;
  rows.reserve(topics.size());
  for (const Rows& given : topics) rows.push_back(rowsOf(given, writer.joints[rows.size()]));
  const py::gil_scoped_release release;
  writer.writer.write(rows);
}

void writeTorques(const PathText& path, const std::string& storage_name, const Writer::Topic& topic,
                  const Rows& computed, const Array& measured, const py::function& progress) {
  const std::size_t n = std::get<1>(topic).size();
  const JointStateRows rows = rowsOf(computed, n);
  Rows other = computed;
  std::get<4>(other) = measured;
  const double* const efforts = rowsOf(other, n).effort;
  const auto storage = storageOf(storage_name);
  const auto tell = [&](double share) {
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    progress(share);
  };
  const py::gil_scoped_release release;
  recordings::writeTorques(path.bytes, storage, Writer::about({topic}).front(), rows, efforts,
                           tell);
}

void bindConnection(py::module_& module) {
  py::class_<Connection>(module, "Connection",
                         "What a recording states about the messages of a publisher.")
      .def_property_readonly("topic", [](const Connection& c) { return textOf(c.topic); })
      .def_property_readonly("message_type", [](const Connection& c) { return textOf(c.type); })
      .def_readonly("message_count", &Connection::messages)
      .def_readonly("serialization", &Connection::serialization)
      .def_property_readonly("qos_profiles",
                             [](const Connection& c) { return textOf(c.qos_profiles); })
      .def_property_readonly("definition", [](const Connection& c) { return textOf(c.definition); })
      .def_property_readonly("definition_hash",
                             [](const Connection& c) { return textOf(c.definition_hash); });
}

void bindSources(py::module_& module) {
  py::class_<Messages>(module, "Messages", "Serialized messages, thousands at a time.")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", &nextBlock);
  py::class_<JointStates>(module, "JointStates",
                          "Joint states of a topic: JointStateSource of "
                          "inverse_dynamics_evaluation.")
      .def_property_readonly(
          "expected_messages",
          [](const JointStates& states) { return states.source->expectedMessages(); },
          "How many messages there are by the recording's own account.")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", &nextStates);
}

void bindRecording(py::module_& module) {
  const auto release = py::call_guard<py::gil_scoped_release>();
  py::class_<Recording>(module, "Recording",
                        "A rosbag2 recording: inverse_dynamics_evaluation/recording.hpp.")
      .def(py::init([](const PathText& path) {
             const py::gil_scoped_release free;
             return std::make_unique<Recording>(path.bytes);
           }),
           py::arg("path"))
      .def_property_readonly("storage",
                             [](const Recording& recording) -> StorageName {
                               return py::str(recordings::name(recording.storage()));
                             })
      .def("topics",
           [](const Recording& recording) {
             std::vector<std::tuple<py::str, py::str, std::int64_t>> topics;
             for (const auto& topic : recording.topics()) {
               topics.emplace_back(textOf(topic.name), textOf(topic.type), topic.messages);
             }
             return topics;
           })
      .def(
          "topic_of_type",
          [](const Recording& recording, const std::string& type, const PathText& topic) {
            return textOf(recording.topicOfType(type, topic.bytes));
          },
          py::arg("message_type"), py::arg("topic") = "")
      .def(
          "expected_messages",
          [](const Recording& recording, const PathText& topic) {
            return recording.expectedMessages(topic.bytes);
          },
          py::arg("topic"))
      .def("connections", &Recording::definitions, release)
      .def(
          "messages",
          [](const Recording& recording, const PathText& topic) {
            return Messages{recording.messages(topic.bytes)};
          },
          py::arg("topic"))
      .def("all_messages",
           [](const Recording& recording) { return Messages{recording.allMessages()}; })
      .def(
          "joint_states",
          [](const Recording& recording, const PathText& topic) {
            return std::make_unique<JointStates>(recording.jointStates(topic.bytes));
          },
          py::arg("topic") = "");
}

}  // namespace

void bindRecordings(py::module_& module) {
  bindConnection(module);
  bindSources(module);
  bindRecording(module);
  py::class_<Writer>(module, "JointStateWriter",
                     "A new recording: inverse_dynamics_evaluation/joint_state_writer.hpp.")
      .def(py::init([](const PathText& path, const std::string& storage,
                       const std::vector<Writer::Topic>& topics) {
             return std::make_unique<Writer>(path.bytes, storageOf(storage), topics);
           }),
           py::arg("path"), py::arg("storage"), py::arg("topics"))
      .def("write", &write, py::arg("rows"))
      .def(
          "finish", [](Writer& writer) { writer.writer.finish(); },
          py::call_guard<py::gil_scoped_release>());
  module.def(
      "write_torques", &writeTorques, py::arg("path"), py::arg("storage"), py::arg("topic"),
      py::arg("computed"), py::arg("measured"), py::kw_only(), py::arg("progress"),
      "A new recording of computed torques, and of measured ones with _gt behind the topic's\n"
      "name.\n\n"
      "topic: name, joint names, frame. computed: header and receive stamps, (N,); positions,\n"
      "velocities, torques, (N, n). measured: (N, n). progress: called with the share that is\n"
      "written.");
}

}  // namespace inverse_dynamics_tools

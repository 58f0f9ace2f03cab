// SPDX-License-Identifier: Apache-2.0
#include "recordings.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <inverse_dynamics_evaluation/joint_state_source.hpp>
#include <inverse_dynamics_evaluation/joint_state_writer.hpp>
#include <inverse_dynamics_evaluation/recording.hpp>
#include <inverse_dynamics_evaluation/sample_table.hpp>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "annotations.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "description.hpp"

namespace inverse_dynamics_tools {

namespace recordings = inverse_dynamics_evaluation;

/// Messages, thousands at a time.
struct Messages {
  std::unique_ptr<recordings::MessageSource> source;
};

/// Joint states of a recording, and the one that was read ahead of the next block.
struct JointStates {
  std::unique_ptr<recordings::JointStateSource> source;
  recordings::JointSample sample = {};
  bool waiting = false;
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

namespace {

namespace py = pybind11;
using namespace py::literals;
using recordings::JointStateRows;
using recordings::Recording;
using recordings::SampleTable;

recordings::Storage storageOf(const std::string& name) {
  for (const auto storage : {recordings::Storage::kSqlite3, recordings::Storage::kMcap}) {
    if (name == recordings::name(storage)) return storage;
  }
  throw py::value_error("storage: expected sqlite3 or mcap, got '" + name + "'");
}

std::tuple<std::vector<py::str>, std::vector<std::int64_t>, std::vector<py::bytes>> nextBlock(
    Messages& messages) {
  constexpr std::size_t kMessages = 4096, kBytes = 1 << 26;
  std::vector<py::str> topics;
  std::vector<std::int64_t> received;
  std::vector<py::bytes> data;
  recordings::Message message;
  for (std::size_t bytes = 0; topics.size() < kMessages && bytes < kBytes;) {
    if (!messages.source->next(message)) break;
    topics.push_back(textOf(*message.topic));
    received.push_back(message.received);
    data.emplace_back(reinterpret_cast<const char*>(message.data), message.size);
    bytes += message.size;
  }
  if (topics.empty()) throw py::stop_iteration();
  return {std::move(topics), std::move(received), std::move(data)};
}

/// Joint states of the same names, frame and lengths, thousands at a time.
struct Block {
  explicit Block(const recordings::JointSample& first)
      : names(*first.names),
        frame_id(first.frame_id),
        columns{first.position.size, first.velocity.size, first.effort.size} {}

  bool takes(const recordings::JointSample& sample) const {
    constexpr std::size_t kMessages = 4096, kNumbers = 1 << 18;
    return stamps[0].size() < kMessages && numbers[0].size() < kNumbers && *sample.names == names &&
           sample.frame_id == frame_id && sample.position.size == columns[0] &&
           sample.velocity.size == columns[1] && sample.effort.size == columns[2];
  }

  void add(const recordings::JointSample& sample) {
    stamps[0].push_back(sample.header_stamp);
    stamps[1].push_back(sample.receive_stamp);
    const recordings::JointSample::Numbers fields[] = {sample.position, sample.velocity,
                                                       sample.effort};
    for (std::size_t i = 0; i < 3; ++i) {
      numbers[i].insert(numbers[i].end(), fields[i].data, fields[i].data + fields[i].size);
    }
  }

  Integers stampsOf(std::size_t i) const {
    return Integers(static_cast<py::ssize_t>(stamps[i].size()), stamps[i].data());
  }
  Array rowsOf(std::size_t i) const {
    const std::vector<std::size_t> shape = {stamps[0].size(), columns[i]};
    return Array(shape, numbers[i].data());
  }

  std::vector<std::string> names;
  std::string frame_id;
  std::array<std::size_t, 3> columns;
  std::array<std::vector<std::int64_t>, 2> stamps;
  std::array<std::vector<double>, 3> numbers;
};

std::tuple<NameTuple, py::str, Integers, Integers, Array, Array, Array> nextStates(
    JointStates& states) {
  const auto take = [&] {
    states.waiting = false;
    return states.waiting = states.source->next(states.sample);
  };
  if (!states.waiting && !take()) throw py::stop_iteration();
  Block block(states.sample);
  do block.add(states.sample);
  while (take() && block.takes(states.sample));
  py::list names;
  for (const std::string& name : block.names) names.append(textOf(name));
  return {py::tuple(names), textOf(block.frame_id), block.stampsOf(0), block.stampsOf(1),
          block.rowsOf(0),  block.rowsOf(1),        block.rowsOf(2)};
}

std::shared_ptr<SampleTable> readSamples(const Recording& recording, const PathText& topic,
                                         const std::vector<std::string>& joints,
                                         const std::string& clock, const py::function& progress) {
  recordings::RecordingOptions options;
  options.joints = joints;
  options.clock = clockOf(clock);
  options.joints_option = "--joints";
  const py::gil_scoped_release release;
  auto table = std::make_shared<SampleTable>();
  recordings::readTable(*recording.jointStates(topic.bytes, options), options, *table,
                        telling(progress));
  return table;
}

/// Columns of the samples, named as in files of results: (N, n), or (N,) for a vector. The arrays are
/// views that keep the table alive.
py::dict seriesOf(const py::object& self) {
  const auto& table = *self.cast<const SampleTable*>();
  py::dict series;
  const auto put = [&](const char* name, const auto& columns) {
    using Scalar = typename std::decay_t<decltype(columns)>::Scalar;
    std::vector<py::ssize_t> shape = {columns.cols(), columns.rows()};
    if (std::decay_t<decltype(columns)>::ColsAtCompileTime == 1) shape = {columns.rows()};
    series[name] = py::array_t<Scalar>(shape, columns.data(), self);
  };
  put("time", table.time);
  put("header_stamps", table.header_stamps);
  put("receive_stamps", table.receive_stamps);
  put("q", table.q);
  put("qd", table.qd);
  put("qdd", table.qdd);
  put("effort", table.effort);
  put("measured", table.measured);
  put("computed", table.computed);
  put("repeated", table.repeated);
  put("non_increasing", table.non_increasing);
  put("start_transient", table.start_transient);
  put("isolated", table.isolated);
  put("kept", table.kept);
  return series;
}

/// Messages of a topic: header and receive stamps, position, velocity, effort.
using Rows = std::tuple<Integers, Integers, Array, Array, Array>;

/// Views of a topic's messages of n joints.
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
  const py::gil_scoped_release release;
  recordings::writeTorques(path.bytes, storage, Writer::about({topic}).front(), rows, efforts,
                           telling(progress));
}

void bindSources(py::module_& module) {
  py::class_<Messages>(
      module, "Messages",
      "Serialized messages, thousands at a time: topics, stamps of reception, messages.")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", &nextBlock);
  py::class_<JointStates>(module, "JointStates",
                          "Joint states of a topic, thousands at a time: names, frame, header and\n"
                          "receive stamps, positions, velocities, efforts.")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", &nextStates);
}

void bindRecording(py::module_& module) {
  py::class_<Recording>(module, "Recording",
                        "A rosbag2 recording: inverse_dynamics_evaluation/recording.hpp.")
      .def(py::init([](const PathText& path) {
             const py::gil_scoped_release free;
             return std::make_unique<Recording>(path.bytes);
           }),
           "path"_a)
      .def_property_readonly(
          "storage",
          [](const Recording& recording) -> StorageName {
            return py::str(recordings::name(recording.storage()));
          },
          "sqlite3 or mcap.")
      .def(
          "topics",
          [](const Recording& recording) {
            std::vector<std::tuple<py::str, py::str, std::int64_t>> topics;
            for (const auto& topic : recording.topics()) {
              topics.emplace_back(textOf(topic.name), textOf(topic.type), topic.messages);
            }
            return topics;
          },
          "Name, type and number of messages of each.")
      .def(
          "topic_of_type",
          [](const Recording& recording, const std::string& type, const PathText& topic) {
            return textOf(recording.topicOfType(type, topic.bytes));
          },
          "message_type"_a, "topic"_a = "",
          "The topic, which has this type; none named: the only one.")
      .def(
          "topics_with_joints",
          [](const Recording& recording, const PathText& usual,
             const std::vector<std::string>& joints) {
            recordings::RecordingOptions options;
            options.joints = joints;
            return textOf(recording.topicsWithJoints(usual.bytes, options));
          },
          "usual"_a, "joints"_a,
          "The usual topic of joint states, or those that have all joints where it hasn't.")
      .def(
          "expected_messages",
          [](const Recording& recording, const PathText& topic) {
            return recording.expectedMessages(topic.bytes);
          },
          "topic"_a, "How many messages the metadata states.")
      .def(
          "messages",
          [](const Recording& recording, const PathText& topic) {
            return Messages{recording.messages(topic.bytes)};
          },
          "topic"_a, "Messages of a topic, serialized.")
      .def(
          "all_messages",
          [](const Recording& recording) { return Messages{recording.allMessages()}; },
          "Messages of all topics, serialized.")
      .def(
          "joint_states",
          [](const Recording& recording, const PathText& topic) {
            return JointStates{recording.jointStates(topic.bytes)};
          },
          "topic"_a = "", "Joint states of a topic; none named: of the only one.")
      .def("read_samples", &readSamples, "topic"_a, "joints"_a, "clock"_a, "progress"_a,
           "Joint states as a table. progress: called with the share that is read.");
}

void bindSampleTable(py::module_& module) {
  py::class_<SampleTable, std::shared_ptr<SampleTable>>(
      module, "SampleTable", "Samples of a recording: SampleTable of inverse_dynamics_evaluation.")
      .def_readonly("joint_names", &SampleTable::joint_names, "Those of the recording.")
      .def_readonly("frame_id", &SampleTable::frame_id, "Of the first message.")
      .def_property_readonly(
          "clock",
          [](const SampleTable& table) -> ClockName {
            return py::str(recordings::name(table.clock()));
          },
          "header or receive: which stamps are the time.")
      .def_readonly("notes", &SampleTable::notes, "What was left out or assumed in reading.")
      .def_property_readonly("series", &seriesOf,
                             "Arrays of all samples by name, as series.npz has them: views.");
}

}  // namespace

recordings::Clock clockOf(const std::string& clock) {
  for (const auto known : {recordings::Clock::kHeader, recordings::Clock::kReceive}) {
    if (clock == recordings::name(known)) return known;
  }
  return recordings::Clock::kAuto;
}

void bindRecordings(py::module_& module) {
  bindSampleTable(module);
  bindSources(module);
  bindRecording(module);
  py::class_<Writer>(module, "JointStateWriter",
                     "A new recording: inverse_dynamics_evaluation/joint_state_writer.hpp.")
      .def(py::init([](const PathText& path, const std::string& storage,
                       const std::vector<Writer::Topic>& topics) {
             return std::make_unique<Writer>(path.bytes, storageOf(storage), topics);
           }),
           "path"_a, "storage"_a, "topics"_a)
      .def("write", &write, "rows"_a, "Writes rows of each topic.")
      .def(
          "finish", [](Writer& writer) { writer.writer.finish(); },
          py::call_guard<py::gil_scoped_release>(), "Ends the recording, which is whole then.");
  module.def(
      "write_torques", &writeTorques, "path"_a, "storage"_a, "topic"_a, "computed"_a, "measured"_a,
      py::kw_only(), "progress"_a,
      "A new recording of computed torques, and of measured ones with _gt behind the topic's\n"
      "name.\n\n"
      "topic: name, joint names, frame. computed: header and receive stamps, (N,); positions,\n"
      "velocities, torques, (N, n). measured: (N, n). progress: called with the share that is\n"
      "written.");
}

}  // namespace inverse_dynamics_tools

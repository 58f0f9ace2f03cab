// SPDX-License-Identifier: Apache-2.0

/// @file
/// How long recordings take to read and to write, per message, on one core.
///
///     recordings_benchmark [MESSAGES [DIRECTORY]]     1000000 messages, the system's directory for
///                                                     temporary files
///
/// A recording of 7 joints is made in each kind of storage. Reading is one pass over its joint
/// states; writing is what an evaluation leaves, two messages for each one that was read; copying
/// is read() and write() of the bytes of the file that was written. Times are those of the
/// processor, the operating system's part included.

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <inverse_dynamics_evaluation/joint_state_source.hpp>
#include <inverse_dynamics_evaluation/joint_state_writer.hpp>
#include <inverse_dynamics_evaluation/recording.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using inverse_dynamics_evaluation::JointStateRows;
using inverse_dynamics_evaluation::JointStateTopic;
using inverse_dynamics_evaluation::JointStateWriter;
using inverse_dynamics_evaluation::Recording;
using inverse_dynamics_evaluation::Storage;

constexpr std::size_t kJoints = 7;
constexpr std::size_t kBlock = 4096;

double secondsOfProcessor() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::vector<JointStateTopic> topics(std::size_t count) {
  std::vector<std::string> joints;
  joints.reserve(kJoints);
  for (std::size_t j = 0; j < kJoints; ++j) joints.push_back("panda_joint" + std::to_string(j + 1));
  std::vector<JointStateTopic> found;
  found.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    found.push_back({i == 0 ? "/torques" : "/torques_gt", joints, "base"});
  }
  return found;
}

void write(const fs::path& path, Storage storage, std::size_t topic_count, std::size_t messages) {
  std::vector<double> numbers(kBlock * kJoints);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = std::sin(static_cast<double>(i));
  std::vector<std::int64_t> stamps(kBlock);
  JointStateWriter writer(path, storage, topics(topic_count));
  for (std::size_t begin = 0; begin < messages; begin += kBlock) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      stamps[i] = 1'700'000'000'000'000'000 + static_cast<std::int64_t>(begin + i) * 1'000'000;
    }
    const std::size_t count = std::min(kBlock, messages - begin);
    const JointStateRows rows{count,          stamps.data(),  stamps.data(),
                              numbers.data(), numbers.data(), numbers.data()};
    writer.write(std::vector<JointStateRows>(topic_count, rows));
  }
  writer.finish();
}

void read(const fs::path& path, std::size_t messages) {
  const auto source = Recording(path).jointStates();
  inverse_dynamics_evaluation::JointSample sample;
  std::size_t count = 0;
  while (source->next(sample)) ++count;
  if (count != messages) throw std::runtime_error("not all messages were read");
}

// The bytes of a file, through memory of 1 MB.
void copyBytes(const fs::path& from, const fs::path& to) {
  const int in = ::open(from.c_str(), O_RDONLY);
  const int out = ::open(to.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  std::vector<char> memory(1 << 20);
  ssize_t size = 0;
  while ((size = ::read(in, memory.data(), memory.size())) > 0) {
    if (::write(out, memory.data(), static_cast<std::size_t>(size)) != size) size = -1;
  }
  ::close(in);
  ::close(out);
  if (size < 0) throw std::runtime_error("the file couldn't be copied");
}

fs::path fileOf(const fs::path& bag) {
  for (const auto& entry : fs::directory_iterator(bag)) {
    if (entry.path().extension() != ".yaml") return entry.path();
  }
  throw std::runtime_error(bag.string() + " has no file");
}

template <class Function>
double microsecondsEach(std::size_t messages, Function function) {
  const double begin = secondsOfProcessor();
  function();
  return (secondsOfProcessor() - begin) * 1e6 / static_cast<double>(messages);
}

void measure(Storage storage, std::size_t messages, const fs::path& directory) {
  const fs::path input = directory / "input", output = directory / "output";
  write(input, storage, 1, messages);
  const double reading = microsecondsEach(messages, [&] { read(input, messages); });
  const double writing = microsecondsEach(messages, [&] { write(output, storage, 2, messages); });
  const double copying =
      microsecondsEach(messages, [&] { copyBytes(fileOf(output), directory / "copy"); });
  std::printf("%-8s %10.2f %12.2f %22.2f\n", name(storage).c_str(), reading, writing, copying);
  std::fflush(stdout);
  for (const fs::path& made : {input, output, directory / "copy"}) fs::remove_all(made);
}

}  // namespace

int main(int count, char** arguments) {
  const std::size_t messages = count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 1'000'000;
  std::string directory =
      (count > 2 ? fs::path(arguments[2]) : fs::temp_directory_path()) / "recordings_XXXXXX";
  if (messages == 0 || ::mkdtemp(directory.data()) == nullptr) {
    std::fprintf(stderr, "usage: recordings_benchmark [MESSAGES [DIRECTORY]]\n");
    return 2;
  }
  int status = 0;
  try {
    std::printf("microseconds of the processor per message of the input, %zu messages\n", messages);
    std::printf("%-8s %10s %12s %22s\n", "storage", "reading", "writing two",
                "copying what was written");
    for (const Storage storage : {Storage::kSqlite3, Storage::kMcap}) {
      measure(storage, messages, directory);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    status = 1;
  }
  fs::remove_all(directory);
  return status;
}

// SPDX-License-Identifier: Apache-2.0

#include "pinocchio.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

namespace chain_dynamics::fuzz {
namespace {

constexpr int kMilliseconds = 5000;

/// The other process, its input and its output.
class Process {
 public:
  explicit Process(const char* program) {
    int in[2], out[2];
    if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0) return;
    id_ = fork();
    if (id_ == 0) {
      dup2(in[0], STDIN_FILENO);
      dup2(out[1], STDOUT_FILENO);
      execl(program, program, nullptr);
      _exit(127);
    }
    close(in[0]);
    close(out[1]);
    in_ = in[1];
    out_ = out[0];
  }
  ~Process() {
    close(in_);
    close(out_);
    kill(id_, SIGKILL);
    waitpid(id_, nullptr, 0);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  bool write(const std::string& bytes) const {
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t count = ::write(in_, bytes.data() + done, bytes.size() - done);
      if (count <= 0) return false;
      done += static_cast<std::size_t>(count);
    }
    return true;
  }

  bool read(void* to, std::size_t size) const {
    auto* bytes = static_cast<char*>(to);
    while (size > 0) {
      pollfd ready{out_, POLLIN, 0};
      if (poll(&ready, 1, kMilliseconds) <= 0) return false;
      const ssize_t count = ::read(out_, bytes, size);
      if (count <= 0) return false;
      bytes += count;
      size -= static_cast<std::size_t>(count);
    }
    return true;
  }

 private:
  pid_t id_ = -1;
  int in_ = -1, out_ = -1;
};

template <typename Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

void append(std::string& bytes, const std::string& text) {
  append(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

std::string request(const std::string& urdf, const std::vector<std::string>& joints,
                    const State& state) {
  std::string bytes;
  append(bytes, urdf);
  append(bytes, static_cast<std::uint32_t>(joints.size()));
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    append(bytes, joints[j]);
    for (const double number : {state.q[i], state.qd[i], state.qdd[i]}) append(bytes, number);
  }
  return bytes;
}

}  // namespace

std::optional<Eigen::VectorXd> pinocchioTorques(const std::string& urdf,
                                                const std::vector<std::string>& joints,
                                                const State& state) {
  static const char* const program = std::getenv("CHAIN_DYNAMICS_PINOCCHIO");
  static std::optional<Process> process;
  if (program == nullptr) return std::nullopt;
  signal(SIGPIPE, SIG_IGN);
  if (!process) process.emplace(program);

  std::uint32_t count = 0;
  Eigen::VectorXd tau(static_cast<Eigen::Index>(joints.size()));
  const bool answered =
      process->write(request(urdf, joints, state)) && process->read(&count, sizeof count) &&
      (count == 0 || (count == joints.size() && process->read(tau.data(), count * sizeof(double))));
  if (!answered) process.reset();
  return answered && count > 0 ? std::optional(tau) : std::nullopt;
}

}  // namespace chain_dynamics::fuzz

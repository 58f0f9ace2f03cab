// SPDX-License-Identifier: Apache-2.0

/// @file
/// Any bytes as a run configuration: a robot that can be used, or one line that names the file.

#include <algorithm>
#include <chain_dynamics/text.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <ios>
#include <string>

#include "inverse_dynamics_evaluation/accelerations.hpp"
#include "inverse_dynamics_evaluation/error.hpp"
#include "inverse_dynamics_evaluation/run_configuration.hpp"

namespace {

namespace fs = std::filesystem;
using namespace inverse_dynamics_evaluation;

// A workspace with the project's robots, in memory where the system has such a place; it goes with
// the program.
class Workspace {
 public:
  Workspace() {
    const fs::path memory("/dev/shm");
    std::string pattern =
        (fs::is_directory(memory) ? memory : fs::temp_directory_path()) / "XXXXXX";
    path_ = ::mkdtemp(pattern.data());
    const fs::path index = path_ / "share/ament_index/resource_index/packages";
    fs::create_directories(index);
    std::ofstream(index / "inverse_dynamics_robots").flush();
    fs::create_directory_symlink(INVERSE_DYNAMICS_ROBOTS_DIR,
                                 path_ / "share/inverse_dynamics_robots");
    ::setenv("AMENT_PREFIX_PATH", path_.c_str(), 1);
  }
  ~Workspace() { fs::remove_all(path_); }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  std::string file() const { return path_ / "robot.yaml"; }

 private:
  fs::path path_;
};

void require(bool condition, const char* what, const std::string& detail) {
  if (condition) return;
  std::fprintf(stderr, "finding: %s: %s\n", what, detail.c_str());
  std::abort();
}

void requireUsable(const RunConfiguration& robot) {
  require(chain_dynamics::isPrintable(robot.name), "a name that no file can have", robot.name);
  require(robot.urdf.empty() || fs::is_regular_file(robot.urdf), "no file", robot.urdf);
  require(robot.model.empty() || fs::is_regular_file(robot.model), "no file", robot.model);
  require(!robot.cutoff || (std::isfinite(*robot.cutoff) && *robot.cutoff > 0), "a cut-off", "");
  require(std::all_of(robot.drive_gains.begin(), robot.drive_gains.end(),
                      [](double gain) { return std::isfinite(gain) && gain > 0; }),
          "a drive gain", "");
  accelerationMethod(robot.accelerations);
  recordedNames(robot, robot.joints);
  solverParameters(robot);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Workspace kWorkspace;
  const std::string file = kWorkspace.file();
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    requireUsable(readRunConfiguration(file));
  } catch (const ConfigurationError& error) {
    constexpr std::size_t kLongest = 10'000;
    const std::string text = error.what();
    require(text.rfind(file, 0) == 0, "an error without its place", text);
    require(text.size() < kLongest, "a long error", text);
    require(chain_dynamics::isPrintable(text), "an error of several lines", text);
  }
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
#include "context.hpp"

#include <chain_dynamics/fast_model.hpp>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "peers.hpp"

namespace inverse_dynamics_benchmarks {
namespace {

std::string processor() {
  std::ifstream stream("/proc/cpuinfo");
  std::string model, family, number;
  const auto value = [](const std::string& line) {
    const auto colon = line.find(": ");
    return colon == std::string::npos ? "" : line.substr(colon + 2);
  };
  for (std::string line; std::getline(stream, line) && !line.empty();) {
    if (line.rfind("model name", 0) == 0) {
      model = value(line);
    } else if (line.rfind("cpu family", 0) == 0) {
      family = value(line);
    } else if (line.rfind("model", 0) == 0) {
      number = value(line);
    }
  }
  if (model.empty()) return "unknown";
  return family.empty() ? model : model + " (family " + family + ", model " + number + ")";
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#elif defined(__GNUC__)
  return "gcc " __VERSION__;
#else
  return "unknown";
#endif
}

}  // namespace

std::vector<std::pair<std::string, std::string>> measurementContext() {
  return {
      {"processor", processor()},
      {"compiler", compiler()},
      {"compiler_flags", BENCHMARK_FLAGS},
#ifdef __OPTIMIZE__
      {"optimized", "yes"},
#else
      {"optimized", "no"},
#endif
      {"kernels", chain_dynamics::FastModel::instructionSets().back()},
      {"kdl", kdlVersion()},
#ifdef BENCHMARK_PINOCCHIO
      {"pinocchio", pinocchioVersion()},
#endif
#ifdef BENCHMARK_MUJOCO
      {"mujoco", mujocoVersion()},
#endif
#ifdef BENCHMARK_CASADI
      {"casadi", casadiVersion()},
#endif
  };
}

}  // namespace inverse_dynamics_benchmarks

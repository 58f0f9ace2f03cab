// SPDX-License-Identifier: Apache-2.0

#include "checks.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <ios>
#include <string>

namespace inverse_dynamics_evaluation::fuzz {
namespace {

// NaN too.
bool isSame(const JointStateNumbers& a, const JointStateNumbers& b) {
  const std::size_t count = a.values.size();
  return a.columns == b.columns && b.values.size() == count &&
         (count == 0 || std::memcmp(a.values.data(), b.values.data(), 8 * count) == 0);
}

}  // namespace

void require(bool condition, const char* what, const std::string& detail) {
  if (condition) return;
  std::fprintf(stderr, "finding: %s: %s\n", what, detail.c_str());
  std::abort();
}

void requireText(const std::string& text, const std::string& where) {
  constexpr std::size_t kLongest = 10'000;
  require(text.compare(0, where.size(), where) == 0, "an error without its place", text);
  require(text.size() < kLongest, "a long error", text);
  // A list of topics has lines.
  const bool fit = std::none_of(text.begin(), text.end(), [](unsigned char letter) {
    return (letter < 0x20 && letter != '\n') || letter == 0x7f;
  });
  require(fit, "control characters in an error", text);
}

bool isSame(const JointStateBlock& a, const JointStateBlock& b) {
  return a.joint_names == b.joint_names && a.frame_id == b.frame_id &&
         a.header_stamps == b.header_stamps && a.receive_stamps == b.receive_stamps &&
         isSame(a.position, b.position) && isSame(a.velocity, b.velocity) &&
         isSame(a.effort, b.effort);
}

void writeSeedsIfAsked(int argc, char** argv, Seeds (*seeds)()) {
  if (argc != 3 || std::string(argv[1]) != "--seeds") return;
  const std::filesystem::path directory(argv[2]);
  std::filesystem::create_directories(directory);
  int number = 0;
  for (const auto& seed : seeds()) {
    std::ofstream file(directory / ("seed_" + std::to_string(number++)), std::ios::binary);
    file.write(reinterpret_cast<const char*>(seed.data()),
               static_cast<std::streamsize>(seed.size()));
  }
  std::exit(EXIT_SUCCESS);
}

}  // namespace inverse_dynamics_evaluation::fuzz

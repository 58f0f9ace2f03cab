// SPDX-License-Identifier: Apache-2.0

/// @file
/// Any text as a robot description: a chain that has the torques that Pinocchio computes from the
/// same text, or an error that says why.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <sstream>
#include <string>

#include "chain_dynamics/urdf.hpp"
#include "pinocchio.hpp"
#include "reading.hpp"

namespace {

using namespace chain_dynamics;

std::optional<Model> read(const std::string& urdf, const UrdfOptions& options) {
  try {
    return Model(chainFromUrdf(urdf, options));
  } catch (const ModelError& error) {
    fuzz::requireText(error, "");
    return std::nullopt;
  }
}

/// Whether both readers mean the same: no joint that follows another, which Pinocchio leaves at
/// zero, and no origin (`xyz="..."`) far away, where much is lost by rounding on the way there and
/// back by fixed joints.
bool isComparable(const std::string& urdf) {
  constexpr double kFar = 100;
  if (urdf.find("mimic") != std::string::npos) return false;
  for (std::size_t at = urdf.find("xyz"); at != std::string::npos; at = urdf.find("xyz", at + 1)) {
    const std::size_t begin = std::min(urdf.find_first_of("\"'", at), urdf.size() - 1) + 1;
    std::istringstream numbers(urdf.substr(begin, urdf.find_first_of("\"'", begin) - begin));
    for (double number = 0; numbers >> number;) {
      if (std::abs(number) > kFar) return false;
    }
  }
  return true;
}

void requireTorquesOfPinocchio(const std::string& urdf, const Model& model,
                               const fuzz::State& state) {
  const auto expected = fuzz::pinocchioTorques(urdf, model.chain.jointNames(), state);
  if (!expected) return;
  Eigen::VectorXd tau(expected->size());
  torques(model, state.q, state.qd, state.qdd, tau);
  constexpr double kRelative = 1e-9;
  const double allowed = kRelative * fuzz::largestTerm(model, state, model.chain.gravity().norm());
  if (((tau - *expected).array().abs() <= allowed).all()) return;
  std::cerr << "torques " << tau.transpose() << "\nPinocchio's " << expected->transpose() << "\n";
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string urdf(reinterpret_cast<const char*>(data), size);
  UrdfOptions options;
  for (const bool lump : {true, false}) {
    options.lump_attached = lump;
    options.allow_massless = !lump;
    const std::optional<Model> model = read(urdf, options);
    if (!model || !fuzz::isModerate(*model)) continue;
    const fuzz::State state = fuzz::someState(model->chain.jointCount());
    fuzz::requireEqualKernels(*model, state);
    if (lump && isComparable(urdf)) requireTorquesOfPinocchio(urdf, *model, state);
  }
  return 0;
}

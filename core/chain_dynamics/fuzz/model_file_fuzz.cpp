// SPDX-License-Identifier: Apache-2.0

/// @file
/// Any text as a model file: a model that can be computed with, or an error that names the place.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "chain_dynamics/model_file.hpp"
#include "reading.hpp"

namespace {

using namespace chain_dynamics;

std::optional<Model> read(const std::string& text) {
  try {
    return modelFromYaml(text, "robot.yaml");
  } catch (const ModelError& error) {
    fuzz::requireText(error, "robot.yaml");
    return std::nullopt;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::optional<Model> model = read(std::string(reinterpret_cast<const char*>(data), size));
  if (!model) return 0;
  checkModel(*model);
  if (fuzz::isModerate(*model)) {
    fuzz::requireEqualKernels(*model, fuzz::someState(model->chain.jointCount()));
  }
  return 0;
}

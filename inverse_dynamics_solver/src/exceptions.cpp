// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/exceptions.hpp"

namespace inverse_dynamics_solver {

std::string errorText(const std::string& where, const std::string& what,
                      const std::string& expected, const std::string& got,
                      const std::string& remedy) {
  std::string text = where;

  // Parts after the first are joined with the separator that fits them.
  const auto append = [&text](const char* separator, const std::string& part) {
    if (part.empty()) return;
    if (!text.empty()) text += separator;
    text += part;
  };
  append(": ", what);
  append(": ", expected.empty() ? "" : "expected " + expected);
  append(expected.empty() ? ": " : ", ", got.empty() ? "" : "got " + got);
  append("; ", remedy);
  return text;
}

UninitializedException::UninitializedException() : UninitializedException("solver") {}

UninitializedException::UninitializedException(const std::string& method)
    : Exception(errorText(method, "the solver is not initialized", "", "",
                          "call initialize() first, and see that it doesn't throw")) {}

}  // namespace inverse_dynamics_solver

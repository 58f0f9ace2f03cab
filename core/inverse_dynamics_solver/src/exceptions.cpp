// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_solver/exceptions.hpp"

#include <string>

#include "chain_dynamics/text.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

std::string errorText(const std::string& where, const std::string& what,
                      const std::string& expected, const std::string& got,
                      const std::string& remedy) {
  return chain_dynamics::errorText(where, what, expected, got, remedy);
}

UninitializedException::UninitializedException() : UninitializedException("solver") {}

UninitializedException::UninitializedException(const std::string& method)
    : Exception(errorText(method, "the solver is not initialized", "", "",
                          "call initialize() first, and see that it doesn't throw")) {}

}  // namespace v2
}  // namespace inverse_dynamics_solver

// SPDX-License-Identifier: Apache-2.0
/// @file
/// C++ exceptions as the Python exceptions of inverse_dynamics.errors, with the same text.
#pragma once

#include <string>

namespace inverse_dynamics_tools {

/// Registers the translation, for this module only.
void bindErrors();

/// Throws ArgumentError.
[[noreturn]] void throwArgumentError(const std::string& text);

}  // namespace inverse_dynamics_tools

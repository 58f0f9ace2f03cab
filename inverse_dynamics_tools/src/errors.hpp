// SPDX-License-Identifier: Apache-2.0
/// @file
/// C++ exceptions as the Python exceptions of inverse_dynamics.errors, with the same text.
#pragma once

namespace inverse_dynamics_tools {

/// Registers the translation, for this module only.
void bindErrors();

}  // namespace inverse_dynamics_tools

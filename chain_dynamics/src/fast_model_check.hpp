// SPDX-License-Identifier: Apache-2.0

/// @file
/// Whether fast kernels can be trusted on this processor: asked once, when a model is loaded.
///
///     if (!equalsPlain(fast, model)) { ... }   // other kernels, then

#pragma once

#include "chain_dynamics/fast_model.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Whether the fast kernels give what the functions of model.hpp give, at a few states: to nine
/// digits of the largest number, far above rounding, far below a mistake.
bool equalsPlain(const FastModel& fast, const Model& model);

}  // namespace v2
}  // namespace chain_dynamics

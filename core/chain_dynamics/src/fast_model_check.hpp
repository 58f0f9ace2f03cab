// SPDX-License-Identifier: Apache-2.0

/// @file
/// Whether fast kernels can be trusted on this processor: checked once, when a model is loaded.

#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "chain_dynamics/fast_model.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Whether the fast kernels give what the functions of model.hpp give, at a few states: to 1e-8 of
/// the largest entry. False for NaN and infinity.
bool equalsPlain(const FastModel& fast, const Model& model);

/// One of several instruction sets.
struct Choice {
  std::size_t index;
  std::vector<std::string> warnings;  ///< one for each better one that can't be used
};

/// The last of the sets that equals the plain functions.
///
/// @param model  what messages call it.
/// @param sets   names, the best last.
/// @throws ModelError  if none does.
Choice bestEqual(const std::string& model, const std::vector<std::string>& sets,
                 const std::function<bool(std::size_t)>& equals);

}  // namespace v2
}  // namespace chain_dynamics

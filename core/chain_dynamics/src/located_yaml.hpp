// SPDX-License-Identifier: Apache-2.0

/// @file
/// What LocatedValue looks at: nodes of a YAML text with their lines.

#pragma once

#include <string>
#include <vector>

#include "chain_dynamics/located_yaml.hpp"

namespace chain_dynamics {
inline namespace v2 {

struct LocatedValue::Content {
  enum class Kind { kScalar, kList, kMap };

  Kind kind = Kind::kScalar;
  bool plain = false;               // a scalar without quotes
  int line = 1;                     // from 1
  std::string text = {};            // of a scalar
  std::vector<Content> parts = {};  // of a list; of a map: key, value, key, value, ...
};

struct LocatedValue::Document {
  std::string file;
  Throw raise;
  Content root = {};

  /// Throws the error `file[:line]: text`; line 0: none.
  [[noreturn]] void refuse(int line, const std::string& text) const;

  /// Reads the root. Throws what raise throws.
  void read(const std::string& text);
};

}  // namespace v2
}  // namespace chain_dynamics

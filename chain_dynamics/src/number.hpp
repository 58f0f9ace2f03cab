// SPDX-License-Identifier: Apache-2.0

/// @file
/// Numbers of files, read strictly.
///
///     if (const auto length = finiteNumber("0.1273")) { use(*length); }
///
/// The whole text must be one finite number, with a decimal point whatever the locale: strtod and
/// std::stod would read "0.1273" as 0 where the user's language writes a comma.

#pragma once

#include <cmath>
#include <locale>
#include <optional>
#include <sstream>
#include <string>

namespace chain_dynamics {
inline namespace v2 {

/// The finite number that a text is, blanks around it aside; nothing if it isn't one.
inline std::optional<double> finiteNumber(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double value = 0;
  if (!(stream >> value) || !std::isfinite(value)) {
    return std::nullopt;
  }
  stream >> std::ws;
  return stream.eof() ? std::optional<double>(value) : std::nullopt;
}

}  // namespace v2
}  // namespace chain_dynamics

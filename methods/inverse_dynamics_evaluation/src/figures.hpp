// SPDX-License-Identifier: Apache-2.0

/// @file
/// Numbers in texts.
///
///     formatted("%.3g", 1.0 / 3.0);                // 0.333
///     figures("%.4g", {13.58, 14.3}, " ");         // 13.58 14.3

#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// A number as `format` writes it.
inline std::string formatted(const char* format, double number) {
  char text[400];  // %f of the greatest double needs 318
  std::snprintf(text, sizeof text, format, number);
  return text;
}

/// Numbers with something between them.
inline std::string figures(const char* format, const std::vector<double>& numbers,
                           const char* between) {
  std::string text;
  for (const double number : numbers) {
    text += (text.empty() ? "" : between) + formatted(format, number);
  }
  return text;
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

// SPDX-License-Identifier: Apache-2.0

/// @file
/// Numbers of files, read strictly.
///
/// The whole text must be one finite number, with a decimal point whatever the locale: strtod and
/// std::stod would read "0.1273" as 0 where the user's language writes a comma.

#pragma once

#include <optional>
#include <string>

namespace chain_dynamics {
inline namespace v2 {

/// The finite number that a text is, blanks, tabs and line breaks around it aside; nothing if it
/// isn't one.
///
/// A number is a sign or none, decimal digits with a point or without, and an exponent or none:
/// `-1.5e-3`, `+2`, `.5`, `5.`. One too small for a double is 0, one too great isn't finite.
std::optional<double> finiteNumber(const std::string& text);

/// Whether all of a text is such a number; one that is too great too.
bool isDecimal(const std::string& text);

/// Masses, squares of lengths and of velocities of this size have products that a double holds.
constexpr double kLargestNumber = 1e50;

}  // namespace v2
}  // namespace chain_dynamics

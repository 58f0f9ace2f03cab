// SPDX-License-Identifier: Apache-2.0

/// @file
/// Texts of messages: one format of errors, what a terminal may show, and "did you mean".
///
///     errorText("arm.yaml:31: joint elbow", "friction", "5 numbers", "4", "give fv, fo, fc, ...");
///     // arm.yaml:31: joint elbow: friction: expected 5 numbers, got 4; give fv, fo, fc, ...
///     nearestName("orgin", {"origin", "parent", "child"});  // origin
///
/// Texts are UTF-8. Threads: all functions are safe.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace chain_dynamics {
inline namespace v2 {

/// Text of every error: `where: what: expected ..., got ...; remedy`. Empty parts are left out.
///
/// Each part is printable() and of limited length, whatever file or argument it quotes.
///
/// @param where     file with its line, parameter with its namespace, or method and argument.
/// @param what      the mistake, in a few words.
/// @param expected  what would have been right.
/// @param got       what was found.
/// @param remedy    what to do now.
std::string errorText(const std::string& where, const std::string& what,
                      const std::string& expected = "", const std::string& got = "",
                      const std::string& remedy = "");

/// A text that a terminal or a log shows as one line and doesn't act on.
///
/// Control characters (terminal escapes, line breaks), marks that reverse the direction of writing,
/// and bytes that aren't UTF-8 become `\n`, `\x1b`, `\u202e`. A long text keeps its beginning and
/// its end. A printable text stays as it is.
///
/// @param longest  number of bytes beyond which the middle is left out.
std::string printable(const std::string& text, std::size_t longest = 500);

/// Whether a text is UTF-8 without control characters: what a name may be made of.
bool isPrintable(const std::string& text);

/// Where the first character that isn't UTF-8 begins; the text's size if all are.
std::size_t firstNotUtf8(const std::string& text);

/// A number with up to so many significant digits: `0.1`, `-9.81`, `1e+20`.
std::string numberText(double value, int digits = 6);

/// The words with a separator between each two.
std::string joined(const std::vector<std::string>& words, const std::string& separator = ", ");

/// How many letters must be inserted, deleted, replaced or exchanged with the next one to make one
/// word of the other; upper and lower case are the same.
///
/// Optimal string alignment. Of long words the first 100 bytes count.
std::size_t editDistance(const std::string& a, const std::string& b);

/// The known name that a misspelt one most likely means; empty if none is near.
///
/// Near: at most a third of the letters differ; of short names, one. Of several that are as near,
/// one with the same letters, in another order, is preferred.
std::string nearestName(const std::string& name, const std::vector<std::string>& known);

}  // namespace v2
}  // namespace chain_dynamics

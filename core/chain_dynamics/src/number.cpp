// SPDX-License-Identifier: Apache-2.0

#include "number.hpp"

#include <charconv>
#include <cstddef>
#include <locale>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>

namespace chain_dynamics {
inline namespace v2 {
namespace {

/// from_chars where all of the text is a decimal number, of any size; a plus sign is left out, as
/// from_chars doesn't know it. Nothing where it isn't, or is a word that from_chars knows: nan, inf.
std::optional<std::from_chars_result> readAll(std::string_view text, double& value) {
  if (text.find_first_not_of("+-.0123456789eE") != std::string_view::npos) return std::nullopt;
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool all =
      result.ec != std::errc::invalid_argument && result.ptr == text.data() + text.size();
  return all ? std::optional(result) : std::nullopt;
}

/// What from_chars leaves open: 0 for a number too small, nothing for one too great.
std::optional<double> outOfRange(const std::string& number) {
  std::istringstream stream(number);
  stream.imbue(std::locale::classic());
  double value = 0;
  return stream >> value ? std::optional<double>(value) : std::nullopt;
}

}  // namespace

bool isDecimal(const std::string& text) {
  double value = 0;
  return readAll(text, value).has_value();
}

std::optional<double> finiteNumber(const std::string& text) {
  constexpr const char* kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string::npos) return std::nullopt;
  const std::string number = text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
  double value = 0;
  const auto result = readAll(number, value);
  if (!result) return std::nullopt;
  return result->ec == std::errc::result_out_of_range ? outOfRange(number) : value;
}

}  // namespace v2
}  // namespace chain_dynamics

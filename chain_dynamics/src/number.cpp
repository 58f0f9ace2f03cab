// SPDX-License-Identifier: Apache-2.0

#include "number.hpp"

#include <charconv>
#include <cmath>
#include <locale>
#include <sstream>

namespace chain_dynamics {
inline namespace v2 {
namespace {

const char* skipDigits(const char* at, const char* end) {
  while (at != end && *at >= '0' && *at <= '9') ++at;
  return at;
}

bool isSign(const char* at, const char* end) { return at != end && (*at == '+' || *at == '-'); }

/// Whether all of it is a decimal number: `[+-] digits [. digits] [e [+-] digits]`.
bool isDecimal(const char* at, const char* end) {
  at += isSign(at, end) ? 1 : 0;
  const char* const whole = at;
  at = skipDigits(at, end);
  auto digits = at - whole;
  if (at != end && *at == '.') {
    const char* const fraction = ++at;
    at = skipDigits(at, end);
    digits += at - fraction;
  }
  if (digits > 0 && at != end && (*at == 'e' || *at == 'E')) {
    ++at;
    at += isSign(at, end) ? 1 : 0;
    const char* const exponent = at;
    at = skipDigits(at, end);
    digits = at - exponent;
  }
  return digits > 0 && at == end;
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
  return isDecimal(text.data(), text.data() + text.size());
}

std::optional<double> finiteNumber(const std::string& text) {
  constexpr const char* kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string::npos) return std::nullopt;
  const char* begin = text.data() + first;
  const char* const end = text.data() + text.find_last_not_of(kBlanks) + 1;
  if (!isDecimal(begin, end)) return std::nullopt;
  begin += *begin == '+' ? 1 : 0;  // which from_chars doesn't know
  double value = 0;
  const auto result = std::from_chars(begin, end, value);
  if (result.ec == std::errc::result_out_of_range) return outOfRange(std::string(begin, end));
  return std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

}  // namespace v2
}  // namespace chain_dynamics

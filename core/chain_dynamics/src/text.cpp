// SPDX-License-Identifier: Apache-2.0

#include "chain_dynamics/text.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "utf8.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

/// Whether a terminal would act on the character, or show the rest of the line in another order.
bool isControl(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0)  // C0, DEL, C1
         || code == 0x2028 || code == 0x2029           // separators of lines and paragraphs
         || (code >= 0x202A && code <= 0x202E)         // embeddings and overrides
         || (code >= 0x2066 && code <= 0x2069);        // isolates
}

std::string hexadecimal(std::uint32_t value, int digits) {
  std::string text;
  for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4) {
    text += "0123456789abcdef"[value >> static_cast<unsigned>(shift) & 0xFU];
  }
  return text;
}

std::string escaped(std::uint32_t code) {
  switch (code) {
    case '\n':
      return "\\n";
    case '\r':
      return "\\r";
    case '\t':
      return "\\t";
    default:
      return code < 0x80 ? "\\x" + hexadecimal(code, 2) : "\\u" + hexadecimal(code, 4);
  }
}

/// The text without its middle, cut between characters.
std::string shortened(const std::string& text, std::size_t longest) {
  if (text.size() <= longest) return text;
  constexpr std::size_t kLongestCharacter = 4;
  const auto boundary = [&text](std::size_t i) {
    for (std::size_t k = i; k > 0 && i - k < kLongestCharacter; --k) {
      if (!isContinuation(byteAt(text, k))) return k;
    }
    return i;
  };
  const std::size_t head = boundary(longest / 4 * 3);
  const std::size_t tail = boundary(text.size() - longest / 4);
  return text.substr(0, head) + " [... " + std::to_string(tail - head) + " bytes left out ...] " +
         text.substr(tail);
}

std::string lowerCase(std::string text) {
  constexpr std::size_t kLongest = 100;
  text.resize(std::min(text.size(), kLongest));
  for (char& letter : text) {
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  return text;
}

std::string sortedLetters(const std::string& word) {
  std::string letters = lowerCase(word);
  std::sort(letters.begin(), letters.end());
  return letters;
}

}  // namespace

std::string errorText(const std::string& where, const std::string& what,
                      const std::string& expected, const std::string& got,
                      const std::string& remedy) {
  constexpr std::size_t kLongestList = 2000;  // remedies list the known names
  std::string text = printable(where);
  const auto append = [&text](const char* separator, const char* word, const std::string& part) {
    if (!part.empty()) text += (text.empty() ? "" : separator) + std::string(word) + part;
  };
  append(": ", "", printable(what));
  append(": ", "expected ", printable(expected, kLongestList));
  append(expected.empty() ? ": " : ", ", "got ", printable(got));
  append("; ", "", printable(remedy, kLongestList));
  return text;
}

std::string printable(const std::string& text, std::size_t longest) {
  const std::string kept = shortened(text, longest);
  std::string result;
  for (std::size_t i = 0; i < kept.size();) {
    const Character character = characterAt(kept, i);
    if (character.size == 0) {
      result += "\\x" + hexadecimal(byteAt(kept, i), 2);
    } else if (isControl(character.code)) {
      result += escaped(character.code);
    } else {
      result.append(kept, i, character.size);
    }
    i += std::max<std::size_t>(character.size, 1);
  }
  return result;
}

std::size_t firstNotUtf8(const std::string& text) {
  std::size_t i = 0;
  while (i < text.size()) {
    const Character character = characterAt(text, i);
    if (character.size == 0) break;
    i += character.size;
  }
  return i;
}

bool isPrintable(const std::string& text) { return printable(text, text.size()) == text; }

std::string numberText(double value, int digits) {
  std::ostringstream stream;
  stream.precision(digits);
  stream << value;
  return stream.str();
}

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (&word == words.data() ? "" : separator) + word;
  return text;
}

std::size_t editDistance(const std::string& a, const std::string& b) {
  const std::string from = lowerCase(a);
  const std::string to = lowerCase(b);
  // rows of the table of distances between the beginnings of both words
  std::vector<std::size_t> before(to.size() + 1);
  std::vector<std::size_t> last(to.size() + 1);
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < from.size(); ++i) {
    before.swap(last);
    last.swap(row);
    row[0] = i + 1;
    for (std::size_t j = 0; j < to.size(); ++j) {
      row[j + 1] = std::min({last[j] + (from[i] == to[j] ? 0 : 1), last[j + 1] + 1, row[j] + 1});
      if (i > 0 && j > 0 && from[i] == to[j - 1] && from[i - 1] == to[j]) {
        row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
      }
    }
  }
  return row.back();
}

std::string nearestName(const std::string& name, const std::vector<std::string>& known) {
  const std::string letters = sortedLetters(name);
  std::string nearest;
  // distance, and whether the letters are others
  auto least = std::make_pair(std::max<std::size_t>(name.size() / 3, 1) + 1, false);
  for (const std::string& candidate : known) {
    const auto cost =
        std::make_pair(editDistance(name, candidate), sortedLetters(candidate) != letters);
    if (cost < least && cost.first < candidate.size()) {
      least = cost;
      nearest = candidate;
    }
  }
  return nearest;
}

}  // namespace v2
}  // namespace chain_dynamics

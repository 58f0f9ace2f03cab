// SPDX-License-Identifier: Apache-2.0

// From a text of YAML to nodes, by yaml-cpp's events. What no configuration needs is refused.

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "chain_dynamics/text.hpp"
#include "located_yaml.hpp"
#include "utf8.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

constexpr std::size_t kMostBytes = 4U << 20U;
constexpr std::size_t kMostValues = 200'000;
constexpr std::size_t kMostLevels = 50;
constexpr const char* kNoYaml = "isn't YAML: ";
constexpr const char* kEscape =
    "an escape stands for NUL, a surrogate or a code above 10ffff; write the character itself";

int lineAt(const std::string& text, std::size_t i) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(i);
  return 1 + static_cast<int>(std::count(text.begin(), end, '\n'));
}

/// Whether YAML may hold the character [YAML 1.2, c-printable].
bool isAllowed(std::uint32_t code) {
  return code == '\t' || code == '\n' || code == '\r' || (code >= 0x20 && code < 0x7F) ||
         code == 0x85 || (code >= 0xA0 && code != 0xFFFE && code != 0xFFFF);
}

/// From a place in a text to the next blank or bracket.
std::string wordAt(const std::string& text, std::size_t begin) {
  return text.substr(begin,
                     std::min(text.find_first_of(" \t\r\n,[]{}", begin), text.size()) - begin);
}

/// What is wrong, of yaml-cpp's error on a line.
std::string problemOf(const YAML::Exception& error, const std::string& line) {
  namespace is = YAML::ErrorMsg;
  constexpr std::size_t kLongest = 100;
  const std::string& text = error.msg;
  if (line.find('\t') < line.find_first_not_of(" \t")) {
    return "a tab is before the text; indent with spaces";
  }
  return text.rfind(is::INVALID_UNICODE, 0) == 0 ? kEscape
         : text == is::END_OF_SEQ_FLOW           ? "expected ',' or ']'"
         : text == is::END_OF_MAP_FLOW           ? "expected ',' or '}'"
         : text == is::MAP_VALUE          ? "no colon is expected here; put the text in quotes"
         : text == is::YAML_MAJOR_VERSION ? "expected version 1"
                                          : printable(text, kLongest);
}

}  // namespace

/// Takes the events of one document.
class LocatedValue::Builder : public YAML::EventHandler {
 public:
  Builder(const std::string& text, Document& document) : text_(text), document_(document) {}

  bool isEmpty() const { return !found_; }

  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& what) const {
    document_.refuse(mark.is_null() ? 0 : mark.line + 1, kNoYaml + what);
  }

  /// The error of an alias at this place.
  [[noreturn]] void refuseAlias(const YAML::Mark& mark) const {
    refuse(mark, "the alias " + printable(wordAt(text_, at(mark)), kLongestWord) +
                     " isn't supported; write out what it stands for");
  }

  bool isAlias(const YAML::Mark& mark) const {
    return !mark.is_null() && at(mark) < text_.size() && text_[at(mark)] == '*';
  }

  std::string lineOf(const YAML::Mark& mark) const {
    if (mark.is_null() || at(mark) >= text_.size()) return "";
    const std::size_t begin = text_.rfind('\n', at(mark)) + 1;  // npos + 1 is 0
    return text_.substr(begin, text_.find('\n', begin) - begin);
  }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (begun_) {
      const bool another = text_.compare(at(mark), 3, "---") == 0;
      refuse(mark, another ? "expected one document, got another one"
                           : "expected the end, got text that isn't YAML from here on; is it a "
                             "table?");
    }
    begun_ = true;
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    scalar(mark, "?", isKeyNext() ? nullWordAt(at(mark)) : "");
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { refuseAlias(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t /*anchor*/,
                const std::string& value) override {
    if (value.find('\0') != std::string::npos || firstNotUtf8(value) < value.size()) {
      refuse(mark, kEscape);
    }
    scalar(mark, tag, value);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override {
    open_.push_back({&add(mark, tag, {Content::Kind::kList}), mark.column, false});
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value style) override {
    Content& node = add(mark, tag, {Content::Kind::kMap});
    open_.push_back({&node, mark.column, style == YAML::EmitterStyle::Block});
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  // A list or a map whose parts are being read.
  struct Open {
    Content* node;
    int column;
    bool block_map;
  };

  static constexpr std::size_t kLongestWord = 60;

  static std::size_t at(const YAML::Mark& mark) { return static_cast<std::size_t>(mark.pos); }

  bool isInMap() const { return !open_.empty() && open_.back().node->kind == Content::Kind::kMap; }
  bool isKeyNext() const { return isInMap() && open_.back().node->parts.size() % 2 == 0; }

  // What stands for null there, as a key is a text.
  std::string nullWordAt(std::size_t begin) const {
    for (const char* const word : {"null", "Null", "NULL", "~"}) {
      if (text_.compare(begin, std::strlen(word), word) == 0) return word;
    }
    return "";
  }

  // yaml-cpp has `!` for what stands in quotes, and for what has that tag.
  void scalar(const YAML::Mark& mark, const std::string& tag, const std::string& value) {
    const bool is_key = isKeyNext();
    if (is_key && tag == "?" && value.empty()) {
      refuse(mark, "expected a key before the colon, got none");
    }
    const std::size_t begin = contentAt(mark);
    Content& node = add(mark, tag, {Content::Kind::kScalar, tag == "?", mark.line + 1, value});
    const std::size_t end = node.plain ? begin + value.size() : endOfQuotes(mark, begin);
    if (is_key && open_.back().block_map && mark.column == open_.back().column) {
      requireColon(mark, end);
    } else if (isInMap() && !is_key && node.plain && value.empty()) {
      node.line = (&node - 1)->line;  // the key's, not that of the next token
    }
  }

  // yaml-cpp takes what is left of the text where a quote isn't closed.
  std::size_t endOfQuotes(const YAML::Mark& mark, std::size_t begin) const {
    const char quote = text_[begin];
    if (quote != '"' && quote != '\'') {
      return begin;  // a block of lines
    }
    for (std::size_t i = begin + 1; i < text_.size(); ++i) {
      const bool pair = quote == '"' ? text_[i] == '\\' : text_.compare(i, 2, "''") == 0;
      if (pair) {
        ++i;
      } else if (text_[i] == quote) {
        return i + 1;
      }
    }
    refuse(mark, std::string("the quote ") + quote + " isn't closed");
  }

  // yaml-cpp takes a text for a key where nothing follows.
  void requireColon(const YAML::Mark& mark, std::size_t end) const {
    const std::size_t next = text_.find_first_not_of(" \t", end);
    if (next == std::string::npos || text_[next] != ':') {
      refuse(mark, "expected a colon behind the key, got none");
    }
  }

  Content& add(const YAML::Mark& mark, const std::string& tag, Content node) {
    if (hasTag(mark)) {
      refuse(mark, "the tag '" + printable(tag, kLongestWord) + "' isn't supported; leave it out");
    }
    if (open_.size() == kMostLevels) {
      refuse(mark, "expected at most " + std::to_string(kMostLevels) + " levels, got more");
    }
    if (count_++ == kMostValues) {
      refuse(mark, "expected at most " + std::to_string(kMostValues) + " values, got more");
    }
    found_ = found_ || !(node.plain && at(mark) >= text_.size());
    node.line = mark.line + 1;
    if (open_.empty()) {
      document_.root = std::move(node);
      return document_.root;
    }
    std::vector<Content>& parts = open_.back().node->parts;
    parts.push_back(std::move(node));
    return parts.back();
  }

  bool hasTag(const YAML::Mark& mark) const {
    const std::size_t i = contentAt(mark);
    return i < text_.size() && text_[i] == '!';
  }

  // Where a value begins, behind its anchor.
  std::size_t contentAt(const YAML::Mark& mark) const {
    const std::size_t i = at(mark);
    return i < text_.size() && text_[i] == '&'
               ? std::min(text_.find_first_not_of(" \t\r\n", i + wordAt(text_, i).size()),
                          text_.size())
               : i;
  }

  const std::string& text_;
  Document& document_;
  std::vector<Open> open_;  // around the next value
  std::size_t count_ = 0;
  bool begun_ = false;
  bool found_ = false;
};

void LocatedValue::Document::refuse(int line, const std::string& text) const {
  raise(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " + text);
  std::abort();
}

void LocatedValue::Document::read(const std::string& text) {
  if (text.size() > kMostBytes) {
    refuse(0, "expected YAML of at most " + std::to_string(kMostBytes >> 20U) +
                  " MiB, got a longer file");
  }
  const std::size_t wrong = firstNotUtf8(text);
  if (wrong < text.size()) {
    refuse(lineAt(text, wrong), "isn't text in UTF-8; expected YAML; save it in that encoding");
  }
  for (std::size_t i = 0; i < text.size();) {
    const Character character = characterAt(text, i);
    if (!isAllowed(character.code)) {
      refuse(lineAt(text, i), std::string(kNoYaml) + "the character '" +
                                  printable(text.substr(i, character.size)) + "' isn't allowed");
    }
    i += character.size;
  }
  std::istringstream stream(text);
  Builder builder(text, *this);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    if (builder.isAlias(error.mark)) builder.refuseAlias(error.mark);
    builder.refuse(error.mark, problemOf(error, builder.lineOf(error.mark)));
  }
  if (builder.isEmpty()) refuse(0, "is empty; expected keys with values");
}

}  // namespace v2
}  // namespace chain_dynamics

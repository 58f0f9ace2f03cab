// SPDX-License-Identifier: Apache-2.0

#include "located_yaml.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "chain_dynamics/error.hpp"
#include "number.hpp"
#include "utf8.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace {

bool isOneOf(const std::string& word, const std::vector<std::string>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::optional<bool> truthOf(const std::string& word) {
  if (isOneOf(word, {"true", "True", "TRUE"})) return true;
  return isOneOf(word, {"false", "False", "FALSE"}) ? std::optional<bool>(false) : std::nullopt;
}

bool isInteger(const std::string& word) {
  const std::size_t first = word.find_first_not_of("+-");
  return first <= 1 && word.find_first_not_of("0123456789", first) == std::string::npos;
}

// `.inf`, `.nan`: numbers of YAML that no configuration has.
bool isNotFinite(const std::string& word) {
  const std::size_t sign = word.find_first_of("+-") == 0 ? 1 : 0;
  return isOneOf(word.substr(sign), {".inf", ".Inf", ".INF"}) ||
         isOneOf(word, {".nan", ".NaN", ".NAN"});
}

bool isNumber(const std::string& word) { return isDecimal(word) || isNotFinite(word); }

constexpr const char* kSecondTime = "stands here for a second time";

void throwModelError(const std::string& text) { throw ModelError(text); }

std::string meant(const std::string& word, const std::vector<std::string>& known) {
  const std::string nearest = nearestName(word, known);
  return nearest.empty() ? "" : "did you mean " + nearest + "?";
}

/// The first bytes of a file; nothing where it can't be read, as errno then says.
std::optional<std::string> contentOf(const std::string& path, std::size_t most) {
  errno = 0;
  std::FILE* const file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) return std::nullopt;
  std::string content(most, '\0');
  content.resize(std::fread(content.data(), 1, content.size(), file));
  const int error = std::ferror(file) != 0 ? errno : 0;
  std::fclose(file);
  errno = error;
  return error != 0 ? std::nullopt : std::optional<std::string>(content);
}

}  // namespace

// ---------------------------------------------------------------------------------------------
// A value

LocatedValue::LocatedValue(std::shared_ptr<const Document> document, const Content& node)
    : document_(std::move(document)), node_(&node) {}

LocatedValue LocatedValue::inner(const Content& node, const std::string& key) const {
  LocatedValue value = *this;
  value.node_ = &node;
  value.key_ = key;
  return value;
}

LocatedValue LocatedValue::named(const std::string& item) const {
  LocatedValue value = *this;
  value.item_ = item;
  value.key_.clear();
  return value;
}

LocatedValue LocatedValue::ofText(const std::string& text, const std::string& file,
                                  const Throw& raise) {
  constexpr const char* kByteOrderMark = "\xEF\xBB\xBF";
  const auto document =
      std::make_shared<Document>(Document{file, raise ? raise : Throw(&throwModelError)});
  document->read(text.rfind(kByteOrderMark, 0) == 0 ? text.substr(3) : text);
  return {document, document->root};
}

LocatedValue LocatedValue::ofFile(const std::string& path, const Throw& raise) {
  constexpr std::size_t kMoreThanIsRead = (4U << 20U) + 1;  // a device may have no end
  const auto content = contentOf(path, kMoreThanIsRead);
  if (!content) {
    const Document nothing{path, raise ? raise : Throw(&throwModelError)};
    nothing.refuse(0, std::string("can't be read (") + std::strerror(errno) + ")");
  }
  return ofText(*content, path, raise);
}

bool LocatedValue::isList() const { return node_->kind == Content::Kind::kList; }
bool LocatedValue::isMap() const { return node_->kind == Content::Kind::kMap; }
bool LocatedValue::isNull() const {
  return plain() != nullptr && isOneOf(*plain(), {"", "~", "null", "Null", "NULL"});
}

const std::string& LocatedValue::file() const { return document_->file; }

const std::string* LocatedValue::plain() const {
  return node_->kind == Content::Kind::kScalar && node_->plain ? &node_->text : nullptr;
}

std::string LocatedValue::where() const {
  const std::string place = file() + ":" + std::to_string(node_->line);
  return place + (item_.empty() ? "" : ": " + item_) + (key_.empty() ? "" : ": " + key_);
}

std::string LocatedValue::shown() const {
  if (isMap()) return "keys with values";
  if (isList()) return "a list of " + std::to_string(node_->parts.size());
  if (key_.empty()) {
    return "a text";  // of a whole file, perhaps a wrong one: it may be anyone's secret
  }
  constexpr std::size_t kLongest = 60;
  const std::string& text = node_->text;
  std::size_t end = std::min(text.size(), kLongest);
  while (end > 0 && end < text.size() && isContinuation(byteAt(text, end))) --end;
  const std::string quoted = "'" + printable(text.substr(0, end)) + "'";
  return text.empty() ? "nothing" : end < text.size() ? quoted + "..." : quoted;
}

void LocatedValue::fail(const std::string& expected, const std::string& remedy) const {
  document_->raise(errorText(where(), "", expected, shown(), remedy));
  std::abort();
}

void LocatedValue::refuse(const std::string& text) const {
  document_->raise(where() + ": " + text);
  std::abort();
}

LocatedValue::Scalar LocatedValue::scalar() const {
  if (node_->kind != Content::Kind::kScalar || isNull()) fail("a text, a number, true or false");
  if (plain() == nullptr) return node_->text;
  const std::string& word = *plain();
  if (const auto truth = truthOf(word)) return *truth;
  if (isInteger(word)) return integer();
  return isNumber(word) ? Scalar(number()) : Scalar(word);
}

std::string LocatedValue::text(const std::vector<std::string>& one_of) const {
  if (node_->kind != Content::Kind::kScalar) fail("a text");
  const std::string& value = node_->text;
  if (!one_of.empty() && !isOneOf(value, one_of)) {
    fail("one of " + joined(one_of), meant(value, one_of));
  }
  if (plain() != nullptr && !std::holds_alternative<std::string>(scalar())) {
    fail("a text", "put it in quotes");
  }
  return value;
}

std::size_t LocatedValue::choice(const std::vector<std::string>& words) const {
  return static_cast<std::size_t>(std::find(words.begin(), words.end(), text(words)) -
                                  words.begin());
}

double LocatedValue::number() const {
  if (plain() == nullptr || !isNumber(*plain())) fail("a number");
  const auto value = finiteNumber(*plain());
  if (!value) fail("a finite number");
  return *value;
}

std::int64_t LocatedValue::integer() const {
  if (plain() == nullptr || !isInteger(*plain())) fail("an integer");
  const std::string& word = *plain();
  std::int64_t value = 0;
  const auto result =
      std::from_chars(word.data() + (word[0] == '+' ? 1 : 0), word.data() + word.size(), value);
  if (result.ec != std::errc()) fail("an integer of at most 64 bits");
  return value;
}

bool LocatedValue::truth() const {
  const auto value = plain() == nullptr ? std::nullopt : truthOf(*plain());
  if (!value) fail("true or false");
  return *value;
}

std::vector<LocatedValue> LocatedValue::entries(std::optional<std::size_t> length) const {
  if (!isList() || (length && node_->parts.size() != *length)) {
    fail(length ? "a list of " + std::to_string(*length) : "a list");
  }
  std::vector<LocatedValue> values;
  values.reserve(node_->parts.size());
  for (const Content& part : node_->parts) {
    values.push_back(inner(part, key_ + "[" + std::to_string(values.size()) + "]"));
  }
  return values;
}

std::vector<double> LocatedValue::numbers(std::size_t count) const {
  if (!isList() || node_->parts.size() != count) fail(std::to_string(count) + " numbers");
  std::vector<double> values;
  for (const LocatedValue& entry : entries()) values.push_back(entry.number());
  return values;
}

LocatedMap LocatedValue::map() const { return LocatedMap(*this); }

// ---------------------------------------------------------------------------------------------
// A map

LocatedMap::LocatedMap(const LocatedValue& value) : value_(value) {
  using Content = LocatedValue::Content;
  if (!value.isMap()) value.fail("keys with values");
  std::set<std::string> names;
  const std::vector<Content>& parts = value.node_->parts;
  for (std::size_t i = 0; i + 1 < parts.size(); i += 2) {
    if (parts[i].kind != Content::Kind::kScalar) {
      value.inner(parts[i], value.key_).fail("a text as a key");
    }
    const std::string& name = parts[i].text;
    const std::string key = value.key_.empty() ? name : value.key_ + "." + name;
    if (!names.insert(name).second) value.inner(parts[i], key).refuse(kSecondTime);
    entries_.emplace_back(name, value.inner(parts[i + 1], key));
  }
}

void LocatedMap::expect(const std::vector<std::string>& keys) const {
  std::vector<std::string> there, missing;
  for (const auto& [key, value] : entries_) there.push_back(key);
  for (const std::string& key : keys) {
    if (!isOneOf(key, there)) missing.push_back(key);
  }
  if (missing.empty()) return;
  value_.refuse((missing.size() == 1 ? "the key " + missing[0] + " is missing"
                                     : "the keys " + joined(missing) + " are missing") +
                "; keys: " + (there.empty() ? "none" : joined(there)));
}

LocatedValue LocatedMap::required(const std::string& key) {
  if (const auto found = optional(key)) return *found;
  expect({key});
  for (const auto& [other, value] : entries_) {
    if (other == key) value.fail("a value");
  }
  std::abort();
}

LocatedMap::Entries LocatedMap::leaves() const {
  Entries leaves;
  std::set<std::string> names;
  for (const auto& [key, value] : entries_) {
    Entries found{{"", value}};
    if (value.isMap()) found = value.map().leaves();
    for (const auto& [name, leaf] : found) {
      leaves.emplace_back(name.empty() ? key : key + "." + name, leaf);
      if (!names.insert(leaves.back().first).second) leaf.refuse(kSecondTime);
    }
  }
  return leaves;
}

std::optional<LocatedValue> LocatedMap::optional(const std::string& key) {
  if (!isOneOf(key, asked_)) asked_.push_back(key);
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&key](const auto& entry) { return entry.first == key; });
  return found == entries_.end() || found->second.isNull() ? std::nullopt
                                                           : std::optional(found->second);
}

void LocatedMap::rejectOthers() const {
  for (const auto& [key, value] : entries_) {
    if (!isOneOf(key, asked_)) {
      const std::string hint = meant(key, asked_);
      value.refuse("unknown key" + (hint.empty() ? "" : "; " + hint) +
                   "; known here: " + joined(asked_));
    }
  }
}

}  // namespace v2
}  // namespace chain_dynamics

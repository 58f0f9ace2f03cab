// SPDX-License-Identifier: Apache-2.0

/// @file
/// YAML whose mistakes can be pointed at: every value knows its file, line and key.
///
///     LocatedMap robot = LocatedValue::ofFile("robot.yaml").map();
///     const std::string name = robot.required("name").text();
///     robot.rejectOthers();    // robot.yaml:7: tpi: unknown key; did you mean tip?; known here: ...
///
/// Strict: a key that isn't asked for is an error, so is a key that stands twice. Values without
/// quotes have the types of the core schema of YAML 1.2: `1:30` and `1_000` are texts, `yes` is one
/// too, `1e-3` is a number. Tags, aliases and other encodings than UTF-8 are errors.
///
/// Texts of errors are `file:line: key: expected ..., got ...; remedy`.

#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace chain_dynamics {
inline namespace v2 {

class LocatedMap;

/// A value of a YAML file and where it stands. Cheap to copy; keeps what was read alive.
///
/// Threads: const methods are safe.
class LocatedValue {
 public:
  /// A function that throws the error with this text; each kind of file has an error of its own.
  using Throw = std::function<void(const std::string& text)>;
  using Scalar = std::variant<bool, std::int64_t, double, std::string>;

  /// The value that a text of YAML is.
  ///
  /// @param file   what to call it in errors.
  /// @param raise  throws the errors of this value and those inside of it; none: ModelError.
  /// @throws what raise throws: not UTF-8, not YAML, several documents, none, tags, aliases, more
  ///     than 50 levels, 200,000 values or 4 MiB.
  static LocatedValue ofText(const std::string& text, const std::string& file,
                             const Throw& raise = nullptr);

  /// The same of a file. Throws also where it can't be read.
  static LocatedValue ofFile(const std::string& path, const Throw& raise = nullptr);

  bool isList() const;
  bool isMap() const;
  bool isNull() const;  ///< a key with nothing behind it

  /// A text, a finite number, an integer, true or false: what it looks like.
  Scalar scalar() const;

  /// A text: what looks like something else needs quotes.
  ///
  /// @param one_of  those that are allowed; none: all.
  std::string text(const std::vector<std::string>& one_of = {}) const;

  /// One of these words, as its place among them.
  std::size_t choice(const std::vector<std::string>& words) const;

  double number() const;         ///< a finite one
  std::int64_t integer() const;  ///< of 64 bits
  bool truth() const;            ///< `true` or `false`

  /// A list; of this length, if one is given.
  std::vector<LocatedValue> entries(std::optional<std::size_t> length = std::nullopt) const;

  /// A list of finite numbers.
  std::vector<double> numbers(std::size_t count) const;

  /// Keys with values.
  LocatedMap map() const;

  /// Throws the error that says what was expected here; what was found is added.
  [[noreturn]] void fail(const std::string& expected, const std::string& remedy = "") const;

  /// Throws the error with this text behind where().
  [[noreturn]] void refuse(const std::string& text) const;

  /// `file:line: key`, as error texts begin.
  std::string where() const;

  /// The same value, which error texts call by this name: `joint elbow`. Keys inside of it follow:
  /// `file:line: joint elbow: friction.fv`.
  LocatedValue named(const std::string& item) const;

  const std::string& key() const { return key_; }
  const std::string& file() const;

 private:
  friend class LocatedMap;
  struct Document;
  struct Content;
  class Builder;

  LocatedValue(std::shared_ptr<const Document> document, const Content& node);
  LocatedValue inner(const Content& node, const std::string& key) const;
  const std::string* plain() const;
  std::string shown() const;

  std::shared_ptr<const Document> document_;
  const Content* node_;
  std::string item_;  // begins the names of keys in error texts
  std::string key_;
};

/// Keys with values, and which of them have been asked for.
class LocatedMap {
 public:
  /// Throws an error that names all of these keys that are missing.
  void expect(const std::vector<std::string>& keys) const;

  /// The value of a key that must be there.
  LocatedValue required(const std::string& key);

  /// The value of a key; nothing where it is absent or null.
  std::optional<LocatedValue> optional(const std::string& key);

  /// Throws the error of a key that nobody has asked for.
  void rejectOthers() const;

  /// Where the map stands.
  const LocatedValue& value() const { return value_; }

  using Entries = std::vector<std::pair<std::string, LocatedValue>>;

  /// All of it, in the order of the file. Their LocatedValue::key() is dotted: `outer.inner`.
  const Entries& entries() const { return entries_; }

  /// All values inside that aren't maps, by dotted names below this map. Throws the
  /// error of a name that stands twice: `{a: {b: 1}, a.b: 2}`.
  Entries leaves() const;

 private:
  friend class LocatedValue;
  explicit LocatedMap(const LocatedValue& value);

  LocatedValue value_;
  Entries entries_;
  std::vector<std::string> asked_;
};

}  // namespace v2
}  // namespace chain_dynamics

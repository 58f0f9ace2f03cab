// SPDX-License-Identifier: Apache-2.0
/// @file
/// SQLite's C library with the lifetimes of C++.
#pragma once

#include <sqlite3.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// What SQLite complains of, in its words.
class SqliteError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An open database.
class Database {
 public:
  /// @param uri  a file: URI or a path. @throws SqliteError
  Database(const std::string& uri, int flags);

  sqlite3* get() const { return database_.get(); }

  /// Runs statements that have no results. @throws SqliteError
  void run(const std::string& statements);

  /// @throws SqliteError, with what the library says of the last call.
  [[noreturn]] void fail() const;

  /// Closes it, which writes what is left. @throws SqliteError
  void close();

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
  };
  std::unique_ptr<sqlite3, Close> database_;
};

/// A prepared statement; parameters and columns are counted as SQLite does, from 1 and from 0.
class Statement {
 public:
  /// @throws SqliteError
  Statement(const Database& database, const std::string& text);

  /// Whether there is a (further) row. @throws SqliteError
  bool step() {
    const int result = sqlite3_step(statement_.get());
    if (result == SQLITE_ROW) return true;
    if (result != SQLITE_DONE) database_->fail();
    return false;
  }

  /// Runs a statement without rows, once more.
  void runOnce() {
    step();
    sqlite3_reset(statement_.get());
  }

  bool isType(int column, int type) const {
    return sqlite3_column_type(statement_.get(), column) == type;
  }
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }
  std::string text(int column) const;
  const std::uint8_t* blob(int column) const {
    return static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_.get(), column));
  }
  std::size_t size(int column) const {
    return static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  }

  void bind(int parameter, std::int64_t number) {
    sqlite3_bind_int64(statement_.get(), parameter, number);
  }
  void bind(int parameter, const std::string& text);
  /// The bytes must stay until the statement has run.
  void bind(int parameter, const std::uint8_t* data, std::size_t size) {
    sqlite3_bind_blob64(statement_.get(), parameter, data, size, SQLITE_STATIC);
  }

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  const Database* database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

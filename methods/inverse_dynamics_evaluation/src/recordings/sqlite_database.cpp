// SPDX-License-Identifier: Apache-2.0

#include "sqlite_database.hpp"

#include <sqlite3.h>

#include <string>

namespace inverse_dynamics_evaluation {
inline namespace v2 {

Database::Database(const std::string& uri, int flags) {
  sqlite3* opened = nullptr;
  const int result = sqlite3_open_v2(uri.c_str(), &opened, flags | SQLITE_OPEN_NOMUTEX, nullptr);
  database_.reset(opened);
  if (result != SQLITE_OK) {
    throw SqliteError(opened == nullptr ? "out of memory" : sqlite3_errmsg(opened));
  }
}

void Database::run(const std::string& statements) {
  if (sqlite3_exec(get(), statements.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

void Database::fail() const { throw SqliteError(sqlite3_errmsg(get())); }

void Database::close() {
  if (sqlite3_close(get()) != SQLITE_OK) fail();
  static_cast<void>(database_.release());  // closed
}

Statement::Statement(const Database& database, const std::string& text) : database_(&database) {
  sqlite3_stmt* made = nullptr;
  const int result = sqlite3_prepare_v3(database.get(), text.c_str(), -1, SQLITE_PREPARE_PERSISTENT,
                                        &made, nullptr);
  statement_.reset(made);
  if (result != SQLITE_OK) database.fail();
}

std::string Statement::text(int column) const {
  const auto* const begin =
      reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  return begin == nullptr ? std::string() : std::string(begin, size(column));
}

void Statement::bind(int parameter, const std::string& text) {
  sqlite3_bind_text64(statement_.get(), parameter, text.data(), text.size(), SQLITE_TRANSIENT,
                      SQLITE_UTF8);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

// SPDX-License-Identifier: Apache-2.0

#include <sqlite3.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "bytes.hpp"
#include "sqlite_database.hpp"
#include "storage_reader.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

// A URI in which no character of the path means anything else. The file isn't locked, nor is a log
// beside it looked at.
std::string immutableUri(const std::string& path) {
  const std::string whole = std::filesystem::absolute(path);
  std::string uri = "file:///";
  for (const char letter : whole.substr(std::min(whole.find_first_not_of('/'), whole.size()))) {
    const auto code = static_cast<unsigned char>(letter);
    if (std::isalnum(code) != 0 || letter == '/' || letter == '.' || letter == '_') {
      uri += letter;
    } else {
      constexpr char kDigits[] = "0123456789ABCDEF";
      uri += {'%', kDigits[code >> 4U], kDigits[code & 15U]};
    }
  }
  return uri + "?immutable=1";
}

class SqliteReader : public StorageReader {
 public:
  explicit SqliteReader(const std::string& path)
      : size_(InputFile(path).size()),
        database_(immutableUri(path), SQLITE_OPEN_READONLY | SQLITE_OPEN_URI) {
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    // Nothing in a file is longer than the file; what it may compute isn't, either.
    sqlite3_limit(
        database_.get(), SQLITE_LIMIT_LENGTH,
        static_cast<int>(std::min<std::uint64_t>(size_, std::numeric_limits<int>::max())));
    requireAllPages();
    requireTables();
    readTopics();
  }

  void countMessages() override {
    std::unordered_map<std::int64_t, std::int64_t> counts;
    Statement topics(database_, "SELECT topic_id FROM messages");
    for (rows_ = 0; topics.step(); countRow()) ++counts[topics.integer(0)];
    for (std::size_t i = 0; i < ids_.size(); ++i) connections_[i].messages = counts[ids_[i]];
  }

  void select(const std::vector<bool>& wanted) override {
    wanted_ = wanted;
    const bool ordered = isOrdered();
    steps_ = !ordered && clockWasSet();
    messages_.emplace(database_, std::string("SELECT topic_id, timestamp, data FROM messages "
                                             "ORDER BY ") +
                                     (ordered || steps_ ? "rowid" : "timestamp, rowid"));
    rows_ = 0;
    previous_ = std::numeric_limits<std::int64_t>::min();
    connection_ = kNone;
    done_ = false;
  }

  bool next(Message& message) override {
    while (!done_ && messages_->step()) {
      countRow();
      const std::int64_t id = messages_->integer(0);
      if (connection_ == kNone || id != id_) {
        id_ = id;
        connection_ = connectionOf(id);
      }
      if (connection_ == kNone || !wanted_[connection_]) continue;
      if (!messages_->isType(1, SQLITE_INTEGER)) {
        throw DamageError("a time of reception: expected a whole number, got " +
                          quoted(messages_->text(1)));
      }
      message.topic = &connections_[connection_].topic;
      message.received = messages_->integer(1);
      if (message.received < previous_ && !steps_) {
        throw DamageError(
            "the index of times doesn't fit the messages; repair it with the command "
            "REINDEX of sqlite3");
      }
      previous_ = message.received;
      const bool is_blob = messages_->isType(2, SQLITE_BLOB);
      message.data = is_blob ? messages_->blob(2) : nullptr;
      message.size = is_blob ? messages_->size(2) : 0;
      return true;
    }
    done_ = true;
    return false;
  }

 private:
  // SQLite reads what a file lacks of its last page as zeros. It counts pages by the header, or by the
  // size of the file where a writer before 3.7 has left the header's number out of date.
  void requireAllPages() {
    Statement pages(database_,
                    "SELECT page_count * page_size FROM pragma_page_count, pragma_page_size");
    pages.step();
    const auto expected = static_cast<std::uint64_t>(pages.integer(0));
    if (size_ < expected) {
      throw DamageError("the file is cut off: expected " + std::to_string(expected) +
                        " bytes, as many as its pages have, got " + std::to_string(size_));
    }
  }

  // A view may compute without end, and a virtual table be anything.
  void requireTables() {
    Statement names(database_,
                    "SELECT name, iif(type = 'table' AND rootpage = 0, 'virtual table', type) FROM "
                    "sqlite_master WHERE name IN ('messages', 'topics')");
    int tables = 0;
    while (names.step()) {
      const std::string kind = names.text(1);
      if (kind == "table") {
        ++tables;
      } else if (kind != "index") {
        throw DamageError("expected the table " + names.text(0) + ", got a " + kind);
      }
    }
    if (tables != 2) throw DamageError("expected the tables messages and topics, got others");
  }

  void readTopics() {
    Statement topics(database_,
                     "SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    for (; topics.step(); countRow()) {
      for (const int column : {1, 2, 3}) {
        if (!topics.isType(column, SQLITE_TEXT)) {
          throw DamageError("a topic's name, type or serialization: expected a text, got a " +
                            quoted(topics.text(column)));
        }
      }
      if (!ids_.empty() && ids_.back() >= topics.integer(0)) {
        throw DamageError("ids of topics: expected each once");
      }
      ids_.push_back(topics.integer(0));
      connections_.push_back({topics.text(1), topics.text(2), topics.text(3), 0});
      requireUtf8(connections_.back().topic, "name of a topic");
      requireUtf8(connections_.back().type, "type of a topic");
    }
  }

  // Whether messages were stored in the order of their reception, as recorders do. Then they are read
  // in the order in which they are stored, without a look-up for each.
  bool isOrdered() {
    std::optional<Statement> rows;
    try {
      rows.emplace(database_,
                   "SELECT rowid FROM messages INDEXED BY timestamp_idx ORDER BY timestamp");
    } catch (const SqliteError&) {  // no index
      rows.emplace(database_, "SELECT timestamp FROM messages ORDER BY rowid");
    }
    rows_ = 0;
    for (std::int64_t previous = std::numeric_limits<std::int64_t>::min(); rows->step();
         countRow()) {
      if (rows->integer(0) < previous) return false;
      previous = rows->integer(0);
    }
    return true;
  }

  bool clockWasSet() {
    Statement rows(database_, "SELECT timestamp FROM messages ORDER BY rowid");
    StoredTimes stored;
    for (rows_ = 0; rows.step(); countRow()) stored.add(rows.integer(0));
    return stored.showStep();
  }

  // A file can't hold more rows than bytes, unless its pages refer to each other in circles.
  void countRow() {
    if (++rows_ > size_) throw DamageError("there are more messages than fit into the file");
  }
  // Index of the connection of a topic's id; kNone: there is none.
  std::size_t connectionOf(std::int64_t id) const {
    const auto at = std::lower_bound(ids_.begin(), ids_.end(), id);
    return at == ids_.end() || *at != id ? kNone : static_cast<std::size_t>(at - ids_.begin());
  }

  std::uint64_t size_;
  Database database_;
  std::vector<std::int64_t> ids_;  // of topics, in the order of the connections, which is theirs
  std::vector<bool> wanted_;
  std::optional<Statement> messages_;
  std::uint64_t rows_ = 0;
  std::int64_t previous_ = 0, id_ = 0;
  std::size_t connection_ = kNone;  // of id_
  bool steps_ = false;              // the recorder's clock was set back
  bool done_ = true;
};

}  // namespace

std::unique_ptr<StorageReader> openSqlite(const std::string& path) {
  return std::make_unique<SqliteReader>(path);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

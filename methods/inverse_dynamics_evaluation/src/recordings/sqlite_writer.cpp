// SPDX-License-Identifier: Apache-2.0

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bytes.hpp"
#include "sqlite_database.hpp"
#include "storage_writer.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

// rosbag2's tables, version 4. The index is made when all messages are there.
constexpr char kTables[] = R"(
CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
CREATE TABLE metadata(
  id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
CREATE TABLE topics(
  id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
  serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL,
  type_description_hash TEXT NOT NULL);
CREATE TABLE message_definitions(
  id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
  encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE messages(
  id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
  data BLOB NOT NULL);
INSERT INTO schema VALUES (4, 'unknown');
)";

class SqliteWriter : public StorageWriter {
 public:
  SqliteWriter(const std::string& path, const std::vector<std::string>& topics)
      : database_(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE) {
    // The file is new, and of no use until it is complete. Large pages take half the time of SQLite's
    // usual 4 kB.
    database_.run("PRAGMA page_size=32768");
    database_.run(
        "PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; PRAGMA locking_mode=EXCLUSIVE;");
    database_.run("BEGIN");
    database_.run(kTables);
    writeTopics(topics);
    insert_.emplace(database_, insertion(rows_.size()));
  }

  void write(std::size_t topic, std::int64_t received, const std::uint8_t* data,
             std::size_t size) override {
    Row& row = rows_[waiting_++];
    row.topic = static_cast<std::int64_t>(topic + 1);
    row.received = received;
    row.data.assign(data, data + size);
    if (waiting_ == rows_.size()) insert(*insert_);
  }

  void finish(const std::string& metadata) override {
    insert_.reset();
    if (waiting_ > 0) {
      Statement rest(database_, insertion(waiting_));
      insert(rest);
    }
    {
      Statement about(database_, "INSERT INTO metadata (metadata_version, metadata) VALUES (9, ?)");
      about.bind(1, metadata);
      about.step();
    }
    database_.run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
    database_.run("COMMIT");
    database_.close();
  }

 private:
  struct Row {
    std::int64_t topic, received;
    Bytes data;
  };

  static std::string insertion(std::size_t rows) {
    std::string text = "INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)";
    for (std::size_t i = 1; i < rows; ++i) text += ", (?, ?, ?)";
    return text;
  }

  // Inserts the rows that wait.
  void insert(Statement& statement) {
    int parameter = 0;
    for (std::size_t i = 0; i < waiting_; ++i) {
      statement.bind(++parameter, rows_[i].topic);
      statement.bind(++parameter, rows_[i].received);
      statement.bind(++parameter, rows_[i].data.data(), rows_[i].data.size());
    }
    statement.runOnce();
    waiting_ = 0;
  }

  void writeTopics(const std::vector<std::string>& topics) {
    Statement topic(database_, "INSERT INTO topics VALUES (?, ?, ?, 'cdr', '[]', ?)");
    for (std::size_t i = 0; i < topics.size(); ++i) {
      topic.bind(1, static_cast<std::int64_t>(i + 1));
      topic.bind(2, topics[i]);
      topic.bind(3, kJointState);
      topic.bind(4, kJointStateHash);
      topic.runOnce();
    }
    if (topics.empty()) return;
    Statement definition(database_,
                         "INSERT INTO message_definitions VALUES (1, ?, 'ros2msg', ?, ?)");
    definition.bind(1, kJointState);
    definition.bind(2, kJointStateDefinition);
    definition.bind(3, kJointStateHash);
    definition.step();
  }

  Database database_;
  std::array<Row, 16> rows_;  // inserted together, which takes half as long as one by one
  std::size_t waiting_ = 0;   // how many of them
  std::optional<Statement> insert_;
};

}  // namespace

std::unique_ptr<StorageWriter> createSqlite(const std::string& path,
                                            const std::vector<std::string>& topics) {
  return std::make_unique<SqliteWriter>(path, topics);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

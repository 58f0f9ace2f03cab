// SPDX-License-Identifier: Apache-2.0

/// @file
/// MCAP files [https://mcap.dev/spec] with chunks, indexes and a summary, as rosbag2 writes them.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bytes.hpp"
#include "crc32.hpp"
#include "mcap_format.hpp"
#include "storage_writer.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {
constexpr std::size_t kChunk = 1 << 20;  // bytes of records after which a chunk ends
constexpr std::uint16_t kSchemaId = 1;

// First and last time of messages, and how many there are.
struct Times {
  std::uint64_t first = std::numeric_limits<std::uint64_t>::max(), last = 0, count = 0;

  void add(std::uint64_t time) {
    first = std::min(first, time);
    last = std::max(last, time);
    ++count;
  }
  // First and last; 0 and 0 of no messages.
  void put(Bytes& out) const {
    putNumber(out, count > 0 ? first : 0);
    putNumber(out, last);
  }
};

class McapWriter : public StorageWriter {
 public:
  McapWriter(const std::string& path, const std::vector<std::string>& topics)
      : file_(path), topics_(topics), indexes_(topics.size()) {
    file_.write(kMcapMagic, sizeof kMcapMagic);
    Bytes header;
    putString(header, "ros2");
    putString(header, "inverse_dynamics_evaluation");
    put(kMcapHeader, header);
    writeDefinitions(chunk_);
  }

  void write(std::size_t topic, std::int64_t received, const std::uint8_t* data,
             std::size_t size) override {
    const auto time = static_cast<std::uint64_t>(received);
    times_.add(time);
    chunk_times_.add(time);
    ++counts_[topic];
    Bytes& index = indexes_[topic];
    if (index.empty()) indexed_.push_back(topic);
    putNumber(index, time);
    putNumber(index, std::uint64_t{chunk_.size()});
    chunk_.push_back(kMcapMessage);
    putNumber(chunk_, std::uint64_t{kMcapMessageHead + size});
    putNumber(chunk_, static_cast<std::uint16_t>(topic + 1));
    putNumber(chunk_, std::uint32_t{0});  // sequence number: none
    putNumber(chunk_, time);
    putNumber(chunk_, time);  // of publication: rosbag2 writes that of reception
    chunk_.insert(chunk_.end(), data, data + size);
    if (chunk_.size() > kChunk) writeChunk();
  }

  void finish(const std::string& metadata) override {
    if (!chunk_.empty()) writeChunk();
    const std::uint64_t begin = file_.size();
    Bytes content, pair;
    putString(content, "rosbag2");
    putString(pair, "serialized_metadata");
    putString(pair, metadata);
    putString(content, {pair.begin(), pair.end()});
    put(kMcapMetadata, content);
    const std::uint64_t size = file_.size() - begin;
    put(kMcapDataEnd, {0, 0, 0, 0});  // checksum: none
    writeSummary(begin, size);
    file_.write(kMcapMagic, sizeof kMcapMagic);
    file_.close();
  }

 private:
  // A record of the file itself.
  void put(McapRecord kind, const Bytes& content) {
    Bytes record;
    putRecord(record, kind, content);
    file_.write(record.data(), record.size());
  }

  void writeDefinitions(Bytes& out) const {
    if (topics_.empty()) return;
    Bytes schema;
    putNumber(schema, kSchemaId);
    putString(schema, kJointState);
    putString(schema, "ros2msg");
    putString(schema, kJointStateDefinition);
    putRecord(out, kMcapSchema, schema);
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      Bytes channel, metadata;
      putNumber(channel, static_cast<std::uint16_t>(i + 1));
      putNumber(channel, kSchemaId);
      putString(channel, topics_[i]);
      putString(channel, "cdr");
      putString(metadata, "offered_qos_profiles");
      putString(metadata, "[]");
      putString(channel, {metadata.begin(), metadata.end()});
      putRecord(out, kMcapChannel, channel);
    }
  }

  // The chunk, the indexes of its messages, and what the summary will state of it.
  void writeChunk() {
    Bytes head;
    chunk_times_.put(head);
    putNumber(head, std::uint64_t{chunk_.size()});
    putNumber(head, crc32(chunk_.data(), chunk_.size()));
    putString(head, "");  // compression: none
    putNumber(head, std::uint64_t{chunk_.size()});
    Bytes record_head = {kMcapChunk};
    putNumber(record_head, std::uint64_t{head.size() + chunk_.size()});
    const std::uint64_t begin = file_.size();
    file_.write(record_head.data(), record_head.size());
    file_.write(head.data(), head.size());
    file_.write(chunk_.data(), chunk_.size());
    const std::uint64_t end = file_.size();

    Bytes places;
    for (const std::size_t topic : indexed_) {
      const auto channel = static_cast<std::uint16_t>(topic + 1);
      putNumber(places, channel);
      putNumber(places, file_.size());
      Bytes index;
      putNumber(index, channel);
      putNumber(index, static_cast<std::uint32_t>(indexes_[topic].size()));
      index.insert(index.end(), indexes_[topic].begin(), indexes_[topic].end());
      put(kMcapMessageIndex, index);
      indexes_[topic].clear();
    }
    Bytes summary;
    chunk_times_.put(summary);
    putNumber(summary, begin);
    putNumber(summary, end - begin);
    putString(summary, {places.begin(), places.end()});
    putNumber(summary, file_.size() - end);
    putString(summary, "");  // compression
    putNumber(summary, std::uint64_t{chunk_.size()});
    putNumber(summary, std::uint64_t{chunk_.size()});
    chunk_indexes_.push_back(std::move(summary));
    chunk_.clear();
    chunk_times_ = {};
    indexed_.clear();
  }

  void writeSummary(std::uint64_t metadata_begin, std::uint64_t metadata_size) {
    const std::uint64_t begin = file_.size();
    Bytes summary, index, footer;
    writeDefinitions(summary);
    for (const Bytes& chunk : chunk_indexes_) putRecord(summary, kMcapChunkIndex, chunk);
    putNumber(index, metadata_begin);
    putNumber(index, metadata_size);
    putString(index, "rosbag2");
    putRecord(summary, kMcapMetadataIndex, index);
    putRecord(summary, kMcapStatistics, statistics());
    file_.write(summary.data(), summary.size());
    putNumber(footer, begin);
    putNumber(footer, std::uint64_t{0});  // offsets of the summary's groups: none
    putNumber(footer, std::uint32_t{0});  // checksum: none
    put(kMcapFooter, footer);
  }

  Bytes statistics() const {
    Bytes content;
    putNumber(content, times_.count);
    putNumber(content, static_cast<std::uint16_t>(topics_.empty() ? 0 : 1));  // schemas
    putNumber(content, static_cast<std::uint32_t>(topics_.size()));
    putNumber(content, std::uint32_t{0});  // attachments
    putNumber(content, std::uint32_t{1});  // metadata
    putNumber(content, static_cast<std::uint32_t>(chunk_indexes_.size()));
    times_.put(content);
    Bytes counts;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      putNumber(counts, static_cast<std::uint16_t>(i + 1));
      putNumber(counts, counts_[i]);
    }
    putString(content, {counts.begin(), counts.end()});
    return content;
  }

  OutputFile file_;
  std::vector<std::string> topics_;
  Times times_;

  Bytes chunk_;                       // records of the current one
  Times chunk_times_;                 // of it
  std::vector<Bytes> indexes_;        // of it: time and place of the messages of each topic
  std::vector<std::size_t> indexed_;  // of it: topics in the order of their first messages
  std::vector<Bytes> chunk_indexes_;  // of all
  std::vector<std::uint64_t> counts_ = std::vector<std::uint64_t>(topics_.size());
};

}  // namespace

std::unique_ptr<StorageWriter> createMcap(const std::string& path,
                                          const std::vector<std::string>& topics) {
  return std::make_unique<McapWriter>(path, topics);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

// SPDX-License-Identifier: Apache-2.0

/// @file
/// MCAP files [https://mcap.dev/spec] with chunks, indexes and a summary, as rosbag2 writes them.

#include <algorithm>
#include <limits>

#include "bytes.hpp"
#include "crc32.hpp"
#include "mcap_format.hpp"
#include "output_file.hpp"
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
  McapWriter(const std::string& path, const std::vector<Connection>& connections)
      : file_(path), connections_(connections), indexes_(connections.size()) {
    file_.write(kMcapMagic, sizeof kMcapMagic);
    Bytes header;
    putString(header, "ros2");
    putString(header, "inverse_dynamics_evaluation");
    put(kMcapHeader, header);
    writeDefinitions(chunk_);
  }

  void write(std::size_t connection, std::int64_t received, const std::uint8_t* data,
             std::size_t size) override;
  void finish(const std::string& metadata) override;

 private:
  // A record of the file itself.
  void put(McapRecord kind, const Bytes& content) {
    Bytes record;
    putRecord(record, kind, content);
    file_.write(record.data(), record.size());
  }
  void writeDefinitions(Bytes& out) const;
  void writeChunk();
  void writeMetadata(const std::string& metadata);
  void writeSummary(std::uint64_t metadata_begin, std::uint64_t metadata_size);
  Bytes statistics() const;

  OutputFile file_;
  std::vector<Connection> connections_;
  Times times_;

  Bytes chunk_;                       // records of the current one
  Times chunk_times_;                 // of it
  std::vector<Bytes> indexes_;        // of it: time and place of the messages of each connection
  std::vector<std::size_t> indexed_;  // of it: connections in the order of their first messages
  std::vector<Bytes> chunk_indexes_;  // of all
  std::vector<std::uint64_t> counts_ = std::vector<std::uint64_t>(connections_.size());
};

void McapWriter::write(std::size_t connection, std::int64_t received, const std::uint8_t* data,
                       std::size_t size) {
  const auto time = static_cast<std::uint64_t>(received);
  times_.add(time);
  chunk_times_.add(time);
  ++counts_[connection];
  Bytes& index = indexes_[connection];
  if (index.empty()) indexed_.push_back(connection);
  putNumber(index, time);
  putNumber(index, std::uint64_t{chunk_.size()});
  chunk_.push_back(kMcapMessage);
  putNumber(chunk_, std::uint64_t{kMcapMessageHead + size});
  putNumber(chunk_, static_cast<std::uint16_t>(connection + 1));
  putNumber(chunk_, std::uint32_t{0});  // sequence number: none
  putNumber(chunk_, time);
  putNumber(chunk_, time);  // of publication: rosbag2 writes that of reception
  chunk_.insert(chunk_.end(), data, data + size);
  if (chunk_.size() > kChunk) writeChunk();
}

void McapWriter::writeDefinitions(Bytes& out) const {
  if (connections_.empty()) return;
  Bytes schema;
  putNumber(schema, kSchemaId);
  putString(schema, connections_.front().type);
  putString(schema, "ros2msg");
  putString(schema, connections_.front().definition);
  putRecord(out, kMcapSchema, schema);
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    Bytes channel, metadata;
    putNumber(channel, static_cast<std::uint16_t>(i + 1));
    putNumber(channel, kSchemaId);
    putString(channel, connections_[i].topic);
    putString(channel, connections_[i].serialization);
    putString(metadata, "offered_qos_profiles");
    putString(metadata, "[]");
    putString(channel, {metadata.begin(), metadata.end()});
    putRecord(out, kMcapChannel, channel);
  }
}

// The chunk, the indexes of its messages, and what the summary will state of it.
void McapWriter::writeChunk() {
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
  for (const std::size_t connection : indexed_) {
    const auto channel = static_cast<std::uint16_t>(connection + 1);
    putNumber(places, channel);
    putNumber(places, file_.size());
    Bytes index;
    putNumber(index, channel);
    putNumber(index, static_cast<std::uint32_t>(indexes_[connection].size()));
    index.insert(index.end(), indexes_[connection].begin(), indexes_[connection].end());
    put(kMcapMessageIndex, index);
    indexes_[connection].clear();
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

void McapWriter::finish(const std::string& metadata) {
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

void McapWriter::writeSummary(std::uint64_t metadata_begin, std::uint64_t metadata_size) {
  const std::uint64_t begin = file_.size();
  Bytes summary, offsets;
  std::size_t done = 0;
  // Where the records of a kind are that were put last.
  const auto end_group = [&](McapRecord kind) {
    if (summary.size() == done) return;
    Bytes offset = {kind};
    putNumber(offset, begin + done);
    putNumber(offset, std::uint64_t{summary.size() - done});
    putRecord(offsets, kMcapSummaryOffset, offset);
    done = summary.size();
  };
  Bytes definitions;
  writeDefinitions(definitions);
  if (!definitions.empty()) {
    const std::size_t schema = kMcapRecordHead + littleEndian<std::uint64_t>(&definitions[1]);
    summary.assign(definitions.begin(), definitions.begin() + static_cast<std::ptrdiff_t>(schema));
    end_group(kMcapSchema);
    summary = std::move(definitions);
    end_group(kMcapChannel);
  }
  for (const Bytes& index : chunk_indexes_) putRecord(summary, kMcapChunkIndex, index);
  end_group(kMcapChunkIndex);
  Bytes index;
  putNumber(index, metadata_begin);
  putNumber(index, metadata_size);
  putString(index, "rosbag2");
  putRecord(summary, kMcapMetadataIndex, index);
  end_group(kMcapMetadataIndex);
  putRecord(summary, kMcapStatistics, statistics());
  end_group(kMcapStatistics);
  file_.write(summary.data(), summary.size());
  const std::uint64_t offsets_begin = file_.size();
  file_.write(offsets.data(), offsets.size());
  Bytes footer;
  putNumber(footer, begin);
  putNumber(footer, offsets_begin);
  putNumber(footer, std::uint32_t{0});  // checksum: none
  put(kMcapFooter, footer);
}

Bytes McapWriter::statistics() const {
  Bytes content;
  putNumber(content, times_.count);
  putNumber(content, static_cast<std::uint16_t>(connections_.empty() ? 0 : 1));  // schemas
  putNumber(content, static_cast<std::uint32_t>(connections_.size()));
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

}  // namespace

std::unique_ptr<StorageWriter> createMcap(const std::string& path,
                                          const std::vector<Connection>& connections) {
  return std::make_unique<McapWriter>(path, connections);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

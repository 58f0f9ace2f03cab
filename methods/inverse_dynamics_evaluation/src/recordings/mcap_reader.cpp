// SPDX-License-Identifier: Apache-2.0

/// @file
/// MCAP files [https://mcap.dev/spec], as far as rosbag2 writes them: messages in chunks, or one
/// after another.
///
/// Chunks are opened when their time has come, and chunks that overlap in time are merged, unless the
/// recorder's clock was set back. A file without an index of its chunks is read once for it; messages
/// outside of chunks are taken by the megabyte, as if these were chunks.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "bytes.hpp"
#include "crc32.hpp"
#include "mcap_format.hpp"
#include "storage_reader.hpp"
#include "unpack.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {
constexpr std::uint64_t kLatest = std::numeric_limits<std::int64_t>::max();
constexpr std::uint64_t kPlain = 1 << 20;  // bytes of records outside of chunks taken together

// Where a chunk is, or records outside of chunks, and what messages they hold.
struct ChunkIndex {
  std::uint64_t offset = 0, length = 0;  // bytes
  std::uint64_t begin_time = kLatest, end_time = 0;
  std::set<std::uint16_t> channels;  // empty: not known
  bool is_chunk = true;
};

// A record within a chunk.
struct Record {
  std::uint8_t kind;
  Fields content;
};

Record nextRecord(Fields& records) {
  const auto kind = records.number<std::uint8_t>();
  const auto size = records.number<std::uint64_t>();
  return {kind, Fields(records.take(size), size)};
}

// A message record.
struct Entry {
  std::uint64_t time;
  const std::uint8_t* data;
  std::size_t size;
  std::uint16_t channel;
};

Entry entryOf(Fields fields) {
  Entry entry{};
  entry.channel = fields.number<std::uint16_t>();
  fields.take(4);  // sequence number
  entry.time = fields.number<std::uint64_t>();
  fields.take(8);  // time of publication
  entry.size = fields.left();
  entry.data = fields.at();
  return entry;
}

// A chunk in memory, with its messages in their order.
struct Chunk {
  Bytes memory;
  std::vector<Entry> entries;
  std::size_t next = 0;
  std::uint64_t place = 0;  // in the file

  std::uint64_t time() const { return entries[next].time; }
};

// Of two chunks, for a heap whose first one has the next message.
bool isLater(const std::unique_ptr<Chunk>& a, const std::unique_ptr<Chunk>& b) {
  return std::make_pair(a->time(), a->place) > std::make_pair(b->time(), b->place);
}

class McapReader : public StorageReader {
 public:
  explicit McapReader(const std::string& path) : file_(path) {
    readHeader();
    readFooter();
    if (summary_ != 0) readSummary();
    const bool has_index = !chunks_.empty() || (counted_ && counts_.empty());
    if (schemas_.empty() || connections_.empty() || !counted_ || !has_index) scan();
  }

  void countMessages() override {
    for (const auto& [channel, i] : connection_of_) {
      const std::uint64_t count = counts_[channel];
      if (count > file_.size()) {  // of a byte each
        throw DamageError("a topic of " + std::to_string(count) +
                          " messages doesn't fit into the file");
      }
      connections_[i].messages = static_cast<std::int64_t>(count);
    }
  }

  void select(const std::vector<bool>& wanted) override {
    wanted_ = wanted;
    next_chunk_ = 0;
    open_.clear();
    steps_ = clockWasSet();
    std::stable_sort(chunks_.begin(), chunks_.end(), [&](const auto& a, const auto& b) {
      return steps_ ? a.offset < b.offset : a.begin_time < b.begin_time;
    });
  }

  bool next(Message& message) override {
    while (
        next_chunk_ < chunks_.size() &&
        (open_.empty() || (!steps_ && chunks_[next_chunk_].begin_time <= open_.front()->time()))) {
      const ChunkIndex& chunk = chunks_[next_chunk_++];
      if (isWanted(chunk)) openChunk(chunk);
    }
    if (open_.empty()) return false;
    // Mostly one chunk is open.
    if (open_.size() > 1) std::pop_heap(open_.begin(), open_.end(), isLater);
    Chunk& chunk = *open_.back();
    const Entry entry = chunk.entries[chunk.next++];
    if (chunk.next == chunk.entries.size()) {
      spent_ = std::move(open_.back());
      open_.pop_back();
    } else if (open_.size() > 1) {
      std::push_heap(open_.begin(), open_.end(), isLater);
    }
    if (entry.time > kLatest) {
      throw DamageError("a time of reception of " + std::to_string(entry.time) + " ns");
    }
    message.topic = &connections_[connection_of_.at(entry.channel)].topic;
    message.received = static_cast<std::int64_t>(entry.time);
    message.data = entry.data;
    message.size = entry.size;
    return true;
  }

 private:
  void readHeader() {
    file_.read(0, sizeof kMcapMagic, record_);
    if (!std::equal(record_.begin(), record_.end(), kMcapMagic)) {
      throw DamageError("expected an MCAP file, got other bytes at its beginning");
    }
    std::uint8_t kind = 0;
    data_ = readRecord(sizeof kMcapMagic, file_.size(), kind);
    if (kind != kMcapHeader) throw DamageError("expected a header, got another record");
  }

  void readFooter() {
    constexpr std::uint64_t kSize = kMcapRecordHead + kMcapFooterSize + sizeof kMcapMagic;
    const std::uint64_t begin = file_.size() < data_ + kSize ? data_ : file_.size() - kSize;
    file_.read(begin, kSize, record_);
    const std::uint8_t* const magic = record_.data() + kSize - sizeof kMcapMagic;
    if (!std::equal(magic, magic + sizeof kMcapMagic, kMcapMagic) || record_[0] != kMcapFooter ||
        littleEndian<std::uint64_t>(&record_[1]) != kMcapFooterSize) {
      throw DamageError(
          "the file has no end: the recorder was killed, or the file is cut off; `mcap recover` "
          "saves "
          "what is there");
    }
    summary_ = littleEndian<std::uint64_t>(&record_[kMcapRecordHead]);
    if (summary_ != 0 && (summary_ < data_ || summary_ > begin)) {
      throw DamageError("the summary lies outside of the file");
    }
    data_end_ = summary_ != 0 ? summary_ : begin;
  }

  void readSummary() {
    const std::uint64_t end = file_.size() - sizeof kMcapMagic;
    std::uint8_t kind = 0;
    for (std::uint64_t at = summary_; at < end;) {
      at = readRecord(at, end, kind);
      if (kind == kMcapFooter || kind == kMcapSummaryOffset) break;
      readSummaryRecord(kind, Fields(record_.data(), record_.size()));
    }
    checkChunks();
  }

  void readSummaryRecord(std::uint8_t kind, Fields fields) {
    if (kind == kMcapSchema) readSchema(fields);
    if (kind == kMcapChannel) readChannel(fields);
    if (kind == kMcapChunkIndex) readChunkIndex(fields);
    if (kind == kMcapStatistics) readStatistics(fields);
  }

  void readSchema(Fields fields) {
    const auto id = fields.number<std::uint16_t>();
    schemas_[id] = fields.string();
  }

  void readChannel(Fields fields) {
    const auto id = fields.number<std::uint16_t>();
    const auto schema = schemas_.find(fields.number<std::uint16_t>());
    Connection connection;
    connection.topic = fields.string();
    connection.serialization = fields.string();
    connection.type = schema == schemas_.end() ? "__schemaless__" : schema->second;
    requireUtf8(connection.topic, "name of a topic");
    requireUtf8(connection.type, "type of a topic");
    if (connection_of_.emplace(id, connections_.size()).second) {
      connections_.push_back(std::move(connection));
    }
  }

  void readChunkIndex(Fields fields) {
    ChunkIndex chunk;
    chunk.begin_time = fields.number<std::uint64_t>();
    chunk.end_time = fields.number<std::uint64_t>();
    chunk.offset = fields.number<std::uint64_t>();
    chunk.length = fields.number<std::uint64_t>();
    const auto size = fields.number<std::uint32_t>();
    for (Fields pairs(fields.take(size), size); pairs.left() > 0; pairs.take(8)) {
      chunk.channels.insert(pairs.number<std::uint16_t>());
    }
    chunks_.push_back(std::move(chunk));
  }

  void readStatistics(Fields fields) {
    fields.take(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8);  // numbers of records, first and last time
    const auto size = fields.number<std::uint32_t>();
    for (Fields pairs(fields.take(size), size); pairs.left() > 0;) {
      const auto channel = pairs.number<std::uint16_t>();
      counts_[channel] = pairs.number<std::uint64_t>();
    }
    counted_ = true;
  }

  // Chunks lie within the file, one behind another, so that together they hold no more than it does.
  void checkChunks() {
    std::sort(chunks_.begin(), chunks_.end(),
              [](const auto& a, const auto& b) { return a.offset < b.offset; });
    std::uint64_t end = data_;
    for (const ChunkIndex& chunk : chunks_) {
      if (chunk.offset < end || chunk.offset > data_end_ ||
          chunk.length > data_end_ - chunk.offset) {
        throw DamageError("chunks in the index overlap or lie outside of the file");
      }
      end = chunk.offset + chunk.length;
    }
  }

  // Reads all records for definitions, numbers of messages, and an index.
  void scan() {
    schemas_.clear();
    connections_.clear();
    connection_of_.clear();
    counts_.clear();
    chunks_.clear();
    std::uint8_t kind = 0;
    Bytes memory;
    for (std::uint64_t at = data_, end = 0; at < data_end_; at = end) {
      end = readRecord(at, data_end_, kind);
      const bool is_chunk = kind == kMcapChunk;
      if (is_chunk || chunks_.empty() || chunks_.back().is_chunk ||
          chunks_.back().length > kPlain) {
        chunks_.emplace_back().offset = at;
        chunks_.back().is_chunk = is_chunk;
      }
      ChunkIndex& index = chunks_.back();
      index.length = end - index.offset;
      if (is_chunk) {
        Fields records = unpackChunk(memory);
        while (records.left() > 0) scanRecord(nextRecord(records), index);
      } else {
        scanRecord({kind, {record_.data(), record_.size()}}, index);
      }
    }
  }

  void scanRecord(const Record& record, ChunkIndex& index) {
    if (record.kind == kMcapSchema) readSchema(record.content);
    if (record.kind == kMcapChannel) readChannel(record.content);
    if (record.kind == kMcapChunk) throw DamageError("a chunk within a chunk");
    if (record.kind != kMcapMessage) return;
    const Entry entry = entryOf(record.content);
    ++counts_[entry.channel];
    index.begin_time = std::min(index.begin_time, entry.time);
    index.end_time = std::max(index.end_time, entry.time);
    index.channels.insert(entry.channel);
  }

  // Reads a record into record_; gives the offset of the next one.
  std::uint64_t readRecord(std::uint64_t offset, std::uint64_t end, std::uint8_t& kind) {
    file_.read(offset, kMcapRecordHead, head_);
    kind = head_[0];
    const auto size = littleEndian<std::uint64_t>(&head_[1]);
    offset += kMcapRecordHead;
    if (offset > end || size > end - offset) {
      throw DamageError("a record at offset " + std::to_string(offset) + " is cut off");
    }
    file_.read(offset, size, record_);
    return offset + size;
  }

  // The records of the chunk in record_; memory: what they will lie in.
  Fields unpackChunk(Bytes& memory) {
    Fields fields(record_.data(), record_.size());
    fields.take(8 + 8);  // first and last time
    const auto size = fields.number<std::uint64_t>();
    const auto sum = fields.number<std::uint32_t>();
    const std::string compression = fields.string();
    const auto packed_size = fields.number<std::uint64_t>();
    const std::uint8_t* const packed = fields.take(packed_size);
    Fields records(packed, packed_size);
    if (compression.empty()) {
      memory.swap(record_);
    } else {
      if (compression == "zstd") {
        zstd_.unpack(packed, packed_size, "a message or chunk", memory);
      } else if (compression == "lz4") {
        unpackLz4(packed, packed_size, memory);
      } else {
        throw DamageError("compression of a chunk: expected zstd or lz4, got " +
                          quoted(compression));
      }
      records = Fields(memory.data(), memory.size());
    }
    if (records.left() != size) {
      throw DamageError("a chunk: expected " + std::to_string(size) + " bytes, got " +
                        std::to_string(records.left()));
    }
    if (sum != 0 && crc32(records.at(), records.left()) != sum) {
      throw DamageError("a chunk's checksum doesn't fit its content");
    }
    return records;
  }

  // The records of a chunk; memory: what they will lie in.
  Fields readChunk(const ChunkIndex& index, Bytes& memory) {
    if (!index.is_chunk) {
      file_.read(index.offset, index.length, memory);
      return {memory.data(), memory.size()};
    }
    std::uint8_t kind = 0;
    const std::uint64_t end = readRecord(index.offset, data_end_, kind);
    if (kind != kMcapChunk || end != index.offset + index.length) {
      throw DamageError("a chunk isn't where the index says");
    }
    return unpackChunk(memory);
  }

  static bool showStep(const std::vector<Entry>& entries) {
    StoredTimes stored;
    for (const Entry& entry : entries) stored.add(static_cast<std::int64_t>(entry.time));
    return stored.showStep();
  }

  // Whether chunks overlap because the recorder's clock was set back.
  bool clockWasSet() {
    std::sort(chunks_.begin(), chunks_.end(),
              [](const auto& a, const auto& b) { return a.offset < b.offset; });
    bool overlap = false;
    std::uint64_t latest = 0;
    for (const ChunkIndex& index : chunks_) {
      if (index.end_time == 0) continue;  // no messages: other records
      overlap = overlap || index.begin_time < latest;
      latest = std::max(latest, index.end_time);
    }
    if (!overlap) return false;
    Chunk chunk;
    StoredTimes stored;
    for (const ChunkIndex& index : chunks_) {
      if (!isWanted(index)) continue;
      readEntries(index, chunk);
      for (const Entry& entry : chunk.entries) stored.add(static_cast<std::int64_t>(entry.time));
    }
    return stored.showStep();
  }

  // Those that are wanted, as stored.
  void readEntries(const ChunkIndex& index, Chunk& chunk) {
    chunk.entries.clear();
    for (Fields records = readChunk(index, chunk.memory); records.left() > 0;) {
      const Record record = nextRecord(records);
      if (record.kind != kMcapMessage) continue;
      const Entry entry = entryOf(record.content);
      if (entry.time >= index.begin_time && entry.time <= index.end_time &&
          isWanted(entry.channel)) {
        chunk.entries.push_back(entry);
      }
    }
  }

  void openChunk(const ChunkIndex& index) {
    auto chunk = spent_ ? std::move(spent_) : std::make_unique<Chunk>();
    chunk->next = 0;
    chunk->place = index.offset;
    readEntries(index, *chunk);
    if (chunk->entries.empty()) {
      spent_ = std::move(chunk);
      return;
    }
    const auto earlier = [](const Entry& a, const Entry& b) { return a.time < b.time; };
    if (!steps_ && !std::is_sorted(chunk->entries.begin(), chunk->entries.end(), earlier) &&
        !showStep(chunk->entries)) {
      std::stable_sort(chunk->entries.begin(), chunk->entries.end(), earlier);
    }
    open_.push_back(std::move(chunk));
    std::push_heap(open_.begin(), open_.end(), isLater);
    requireMemory();
  }

  // Chunks that overlap in time are in memory together.
  void requireMemory() const {
    const std::uint64_t most = mostUnpacked(file_.size());
    std::uint64_t bytes = 0;
    for (const auto& chunk : open_) bytes += chunk->memory.size();
    if (bytes > most) throw beyondLimit("an MCAP file", file_.size(), most);
  }
  bool isWanted(std::uint16_t channel) const {
    const auto at = connection_of_.find(channel);
    return at != connection_of_.end() && wanted_[at->second];
  }

  bool isWanted(const ChunkIndex& chunk) const {
    return chunk.channels.empty() ||
           std::any_of(chunk.channels.begin(), chunk.channels.end(),
                       [&](std::uint16_t channel) { return isWanted(channel); });
  }

  InputFile file_;
  Bytes head_, record_;  // head and content of the record that was read last
  std::uint64_t data_ = 0, data_end_ = 0, summary_ = 0;
  std::unordered_map<std::uint16_t, std::string> schemas_;        // names
  std::unordered_map<std::uint16_t, std::size_t> connection_of_;  // of a channel
  std::unordered_map<std::uint16_t, std::uint64_t> counts_;       // of messages of a channel
  bool counted_ = false;                                          // whether counts_ is known
  std::vector<ChunkIndex> chunks_;  // by time, then by place, or by place
  ZstdUnpacker zstd_;

  std::vector<bool> wanted_;
  bool steps_ = false;  // the recorder's clock was set back: messages are taken as stored
  std::size_t next_chunk_ = 0;
  std::vector<std::unique_ptr<Chunk>> open_;  // a heap: the next message is in the first
  std::unique_ptr<Chunk> spent_;              // holds the message given last, then memory
};

}  // namespace

std::unique_ptr<StorageReader> openMcap(const std::string& path) {
  return std::make_unique<McapReader>(path);
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

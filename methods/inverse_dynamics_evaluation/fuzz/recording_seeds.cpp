// SPDX-License-Identifier: Apache-2.0

#include "recording_seeds.hpp"

#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <ios>
#include <iterator>
#include <regex>
#include <string>
#include <utility>

#include "bytes.hpp"
#include "inverse_dynamics_evaluation/joint_state_writer.hpp"
#include "mcap_format.hpp"

namespace inverse_dynamics_evaluation::fuzz {
namespace {

namespace fs = std::filesystem;
using Packer = std::function<Bytes(const std::uint8_t* data, std::size_t size)>;

std::string contentOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// A file of a new recording: three messages of each topic.
std::string written(Storage storage, const std::string& file) {
  std::string pattern = fs::temp_directory_path() / "seeds_XXXXXX";
  const fs::path directory = ::mkdtemp(pattern.data());
  const std::string bag = directory / "bag";
  JointStateWriter writer(bag, storage,
                          {{"/joint_states", {"a", "b"}, "base"}, {"/other", {"a", "b"}}});
  const std::int64_t stamps[] = {1'000'000'000, 1'010'000'000, 1'020'000'000};
  const double numbers[] = {0.5, -1, 0.25, 2, 1e-3, 7};
  const JointStateRows rows{3, stamps, stamps, numbers, numbers, numbers};
  writer.write({rows, rows});
  writer.finish();
  if (storage == Storage::kSqlite3) {  // a dozen small pages instead of large ones
    sqlite3* database = nullptr;
    sqlite3_open((bag + "/bag.db3").c_str(), &database);
    sqlite3_exec(database, "PRAGMA page_size=512; VACUUM", nullptr, nullptr, nullptr);
    sqlite3_close(database);
  }
  std::string content = contentOf(fs::path(bag) / file);
  fs::remove_all(directory);
  return content;
}

Bytes zstdOf(const std::uint8_t* data, std::size_t size) {
  Bytes packed(ZSTD_compressBound(size));
  packed.resize(ZSTD_compress(packed.data(), packed.size(), data, size, 3));
  return packed;
}

Bytes lz4Of(const std::uint8_t* data, std::size_t size) {
  Bytes packed(LZ4F_compressFrameBound(size, nullptr));
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), data, size, nullptr));
  return packed;
}

// The same records with the data of each message packed.
Bytes withPackedMessages(const Bytes& records, const Packer& packer) {
  Bytes out;
  for (Fields fields(records.data(), records.size()); fields.left() > 0;) {
    const auto kind = static_cast<McapRecord>(fields.number<std::uint8_t>());
    const auto size = fields.number<std::uint64_t>();
    const std::uint8_t* const begin = fields.take(size);
    Bytes content(begin, begin + size);
    if (kind == kMcapMessage) {
      const Bytes packed = packer(begin + kMcapMessageHead, size - kMcapMessageHead);
      content.resize(kMcapMessageHead);
      content.insert(content.end(), packed.begin(), packed.end());
    }
    putRecord(out, kind, content);
  }
  return out;
}

// Header, one chunk and end of the file, without a summary.
std::string mcapOfOneChunk(const std::string& file, const Packer& messages,
                           const std::string& compression, const Packer& chunk) {
  const Bytes bytes(file.begin(), file.end());
  Fields fields(bytes.data(), bytes.size());
  Bytes out(bytes.begin(), bytes.begin() + sizeof kMcapMagic);
  fields.take(sizeof kMcapMagic);
  while (fields.left() > 0) {
    const auto kind = static_cast<McapRecord>(fields.number<std::uint8_t>());
    const auto size = fields.number<std::uint64_t>();
    Fields content(fields.take(size), size);
    if (kind == kMcapHeader) putRecord(out, kind, {content.at(), content.at() + size});
    if (kind != kMcapChunk) continue;
    Bytes made(content.at(), content.at() + 16);  // first and last time
    content.take(16 + 8 + 4);
    content.string();
    const auto stated = content.number<std::uint64_t>();
    const std::uint8_t* const begin = content.take(stated);
    Bytes records(begin, begin + stated);
    if (messages) records = withPackedMessages(records, messages);
    putNumber(made, std::uint64_t{records.size()});
    putNumber(made, std::uint32_t{0});  // no checksum
    putString(made, compression);
    if (chunk) records = chunk(records.data(), records.size());
    putNumber(made, std::uint64_t{records.size()});
    made.insert(made.end(), records.begin(), records.end());
    putRecord(out, kMcapChunk, made);
    break;
  }
  putRecord(out, kMcapDataEnd, Bytes(4));
  putRecord(out, kMcapFooter, Bytes(kMcapFooterSize));
  out.insert(out.end(), std::begin(kMcapMagic), std::end(kMcapMagic));
  return {out.begin(), out.end()};
}

// The same MCAP file, whose only chunk may be changed without a look at its checksum.
std::string withoutChecksum(std::string file) {
  const auto* const data = reinterpret_cast<const std::uint8_t*>(file.data());
  const auto header = littleEndian<std::uint64_t>(data + sizeof kMcapMagic + 1);
  const std::size_t chunk = sizeof kMcapMagic + kMcapRecordHead + header;
  return file.replace(chunk + kMcapRecordHead + 8 + 8 + 8, 4, 4, '\0');
}

}  // namespace

std::string mcapFile() { return written(Storage::kMcap, kMcapName); }

std::string metadataOf(const std::string& compression) {
  std::string plain = written(Storage::kMcap, "metadata.yaml");
  if (compression.empty()) return plain;
  std::string changed = std::regex_replace(plain, std::regex("compression_mode: ''"),
                                           "compression_mode: " + compression);
  changed =
      std::regex_replace(changed, std::regex("compression_format: ''"), "compression_format: zstd");
  return compression == "FILE" ? std::regex_replace(changed, std::regex(kMcapName), kPackedName)
                               : changed;
}

Seeds recordingSeeds() {
  const std::string mcap = mcapFile();
  const auto* const data = reinterpret_cast<const std::uint8_t*>(mcap.data());
  const Bytes packed = zstdOf(data, mcap.size());
  const std::pair<Part, std::string> inputs[] = {
      {Part::kDatabase, written(Storage::kSqlite3, "bag.db3")},
      {Part::kMcapFile, mcap},
      {Part::kMcapFile, withoutChecksum(mcap)},
      {Part::kMcapFile, mcapOfOneChunk(mcap, nullptr, "", nullptr)},
      {Part::kMcapFile, mcapOfOneChunk(mcap, nullptr, "zstd", zstdOf)},
      {Part::kMcapFile, mcapOfOneChunk(mcap, nullptr, "lz4", lz4Of)},
      {Part::kMetadata, metadataOf("")},
      {Part::kCompressedFile, {packed.begin(), packed.end()}},
      {Part::kCompressedMessages, mcapOfOneChunk(mcap, zstdOf, "", nullptr)},
  };
  Seeds seeds;
  for (const auto& [part, content] : inputs) {
    seeds.push_back({static_cast<std::uint8_t>(part)});
    seeds.back().insert(seeds.back().end(), content.begin(), content.end());
  }
  return seeds;
}

}  // namespace inverse_dynamics_evaluation::fuzz

// SPDX-License-Identifier: Apache-2.0

/// @file
/// Any bytes as a file of a recording: messages that belong together, or an error that names the
/// recording. The first byte says which file [recording_seeds.hpp].

#include <algorithm>
#include <climits>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <inverse_dynamics_evaluation/error.hpp>
#include <inverse_dynamics_evaluation/sample_table.hpp>
#include <ios>
#include <numeric>
#include <string>
#include <vector>

#include "checks.hpp"
#include "inverse_dynamics_evaluation/joint_state_writer.hpp"
#include "recording_seeds.hpp"

namespace inverse_dynamics_evaluation::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMost = 10'000;  // messages that are kept for comparison

// In memory where the system has such a place; it goes with the program.
class Directory {
 public:
  Directory() {
    const fs::path memory("/dev/shm");
    std::string pattern =
        (fs::is_directory(memory) ? memory : fs::temp_directory_path()) / "XXXXXX";
    path_ = ::mkdtemp(pattern.data());
    ::setenv("TMPDIR", path_.c_str(), 1);  // for what is unpacked
  }
  ~Directory() { fs::remove_all(path_); }
  Directory(const Directory&) = delete;
  Directory& operator=(const Directory&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

const fs::path& directory() {
  static const Directory kDirectory;
  return kDirectory.path();
}

void put(const fs::path& file, const char* data, std::size_t size) {
  std::ofstream(file, std::ios::binary | std::ios::trunc)
      .write(data, static_cast<std::streamsize>(size));
}

void put(const fs::path& file, const std::string& content) {
  put(file, content.data(), content.size());
}

// The recording with these bytes in the part.
fs::path recordingOf(Part part, const std::uint8_t* data, std::size_t size) {
  static const std::string kMcap = mcapFile();
  static const std::string kPlain = metadataOf(""), kFile = metadataOf("FILE"),
                           kMessage = metadataOf("MESSAGE");
  const auto* const text = reinterpret_cast<const char*>(data);
  const bool is_file = part == Part::kDatabase || part == Part::kMcapFile;
  fs::path bag = directory() / (part == Part::kDatabase   ? "motion.db3"
                                : part == Part::kMcapFile ? "motion.mcap"
                                                          : "bag");
  if (is_file) {
    put(bag, text, size);
    return bag;
  }
  fs::create_directories(bag);
  const fs::path metadata = bag / "metadata.yaml";
  if (part == Part::kMetadata) {
    put(bag / kMcapName, kMcap);
    put(metadata, text, size);
  } else {
    put(metadata, part == Part::kCompressedFile ? kFile : kMessage);
    put(bag / (part == Part::kCompressedFile ? kPackedName : kMcapName), text, size);
  }
  return bag;
}

// Whether a call ends without an error of the recording.
template <class Call>
bool succeeds(const std::string& path, Call call) {
  try {
    call();
  } catch (const RecordingError& error) {
    requireText(error.what(), path);
    return false;
  }
  return true;
}

// Messages, each as a block.
std::vector<JointStateBlock> blocksOf(JointStateSource& source) {
  std::vector<JointStateBlock> blocks;
  std::int64_t messages = 0;
  for (JointSample sample; source.next(sample); ++messages) {
    require(sample.message == messages, "number of a message");
    if (messages < kMost) blocks.emplace_back().add(sample);
  }
  require(messages == source.expectedMessages(), "number of messages");
  return blocks;
}

// Within the years that are allowed, and in one file in their order, unless the recorder's clock was set back.
void requireStamps(const std::vector<JointStateBlock>& blocks) {
  std::int64_t previous = 0;
  std::size_t steps = 0;
  for (const JointStateBlock& block : blocks) {
    const std::int64_t stamp = block.receive_stamps[0];
    require(stamp >= 0 && stamp <= kLatestReception, "time of reception", std::to_string(stamp));
    steps += stamp < previous ? 1 : 0;
    previous = stamp;
  }
  require(2 * steps <= blocks.size(), "order of reception", std::to_string(steps));
}

void requireSame(const std::vector<JointStateBlock>& a, const std::vector<JointStateBlock>& b,
                 const char* what) {
  require(std::equal(a.begin(), a.end(), b.begin(), b.end(), isSame), what);
}

// Samples of a recording that was accepted can be evaluated.
void requireSamples(JointStateSource& source) {
  SampleTable table;
  readTable(source, {}, table);
  for (const auto* numbers : {&table.q, &table.qd, &table.effort}) {
    require(numbers->cols() == table.size() && numbers->rows() == table.q.rows(),
            "shape of samples");
    require(numbers->allFinite(), "a sample that isn't finite");
  }
}

bool isWritable(const JointStateBlock& block) {
  constexpr std::int64_t kLatest = (std::int64_t{INT_MAX} + 1) * 1'000'000'000;
  const std::size_t n = block.joint_names.size();
  return block.position.columns == n && block.velocity.columns == n && block.effort.columns == n &&
         block.header_stamps[0] < kLatest;
}

// The first message, written and read again, is the same.
void requireCopy(const JointStateBlock& block) {
  if (!isWritable(block)) return;
  const fs::path copy = directory() / "copy";
  fs::remove_all(copy);
  JointStateWriter writer(copy, Storage::kMcap, {{"/copy", block.joint_names, block.frame_id}});
  writer.write(
      {{block.size(), block.header_stamps.data(), block.receive_stamps.data(),
        block.position.values.data(), block.velocity.values.data(), block.effort.values.data()}});
  writer.finish();
  requireSame(blocksOf(*Recording(copy).jointStates()), {block}, "a copy");
}

void read(const std::string& path) {
  const Recording recording(path);
  succeeds(path, [&] {
    Message message;
    [[maybe_unused]] volatile unsigned sum = 0;
    for (const auto source = recording.allMessages(); source->next(message);) {
      sum = std::accumulate(message.data, message.data + message.size, 0U);
    }
  });
  succeeds(path, [&] {
    const auto source = recording.jointStates("/joint_states");
    const auto blocks = blocksOf(*source);
    if (fs::is_regular_file(path)) requireStamps(blocks);
    source->rewind();
    requireSame(blocksOf(*source), blocks, "a second pass");
    if (!blocks.empty()) requireCopy(blocks.front());
    source->rewind();
    requireSamples(*source);
  });
}

}  // namespace
}  // namespace inverse_dynamics_evaluation::fuzz

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  using namespace inverse_dynamics_evaluation::fuzz;
  writeSeedsIfAsked(*argc, *argv, &recordingSeeds);
  ::setenv("IDS_UNPACK_LIMIT_MB", "1", 1);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace inverse_dynamics_evaluation::fuzz;
  if (size == 0) return 0;
  const auto part = static_cast<Part>(data[0] % kParts);
  const std::string path = recordingOf(part, data + 1, size - 1);
  succeeds(path, [&] { read(path); });
  return 0;
}

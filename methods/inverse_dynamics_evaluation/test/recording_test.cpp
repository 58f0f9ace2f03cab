// SPDX-License-Identifier: Apache-2.0

#include "inverse_dynamics_evaluation/recording.hpp"

#include <gmock/gmock.h>
#include <sqlite3.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <inverse_dynamics_evaluation/error.hpp>
#include <ios>
#include <iterator>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "error_of.hpp"
#include "inverse_dynamics_evaluation/joint_state_writer.hpp"
#include "joint_state_block.hpp"
#include "mcap_format.hpp"

namespace inverse_dynamics_evaluation::recording_test {

namespace fs = std::filesystem;
using inverse_dynamics_evaluation::RecordingError;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Stamps = std::vector<std::int64_t>;

const std::vector<std::string> kNames = {"joint_1", "joint_2"};

std::string storageName(const ::testing::TestParamInfo<Storage>& storage) {
  return name(storage.param);
}

std::string contentOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void put(const fs::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << content;
}

void replace(const fs::path& file, const std::string& old, const std::string& instead) {
  std::string content = contentOf(file);
  std::size_t at = content.find(old);
  ASSERT_NE(at, std::string::npos) << old;
  for (; at != std::string::npos; at = content.find(old, at + instead.size())) {
    content.replace(at, old.size(), instead);
  }
  put(file, content);
}

// The content of an MCAP file whose first chunk may be changed.
std::string withoutChecksum(std::string content) {
  std::uint64_t header = 0;
  std::memcpy(&header, &content[sizeof kMcapMagic + 1], 8);
  const std::size_t chunk = sizeof kMcapMagic + kMcapRecordHead + header;
  return content.replace(chunk + kMcapRecordHead + 24, 4, 4, '\0');
}

// What a test writes goes with it.
class RecordingTest : public ::testing::TestWithParam<Storage> {
 protected:
  void SetUp() override {
    std::string pattern = fs::temp_directory_path() / "recording_test_XXXXXX";
    directory_ = ::mkdtemp(pattern.data());
  }
  void TearDown() override { fs::remove_all(directory_); }

  fs::path file(const std::string& bag) const {
    return directory_ / bag / (bag + (GetParam() == Storage::kMcap ? ".mcap" : ".db3"));
  }

  // Compresses the file of a recording, as rosbag2 does with the mode FILE.
  void pack(const std::string& bag) const {
    const std::string raw = contentOf(file(bag));
    std::string packed(ZSTD_compressBound(raw.size()), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), 3));
    const std::string name = file(bag).filename();
    put(file(bag).string() + ".zstd", packed);
    fs::remove(file(bag));
    const fs::path metadata = directory_ / bag / "metadata.yaml";
    replace(metadata, name + "\n", name + ".zstd\n");
    replace(metadata, "compression_format: ''", "compression_format: zstd");
    replace(metadata, "compression_mode: ''", "compression_mode: FILE");
  }

  // Messages received at these times; the k-th has position k and 2k, velocity 3k, effort 4k.
  std::string write(const std::string& bag, const Stamps& received,
                    const std::vector<std::string>& topics = {"/joint_states"}) const {
    std::vector<JointStateTopic> about;
    for (const std::string& topic : topics) about.push_back({topic, kNames, "base"});
    JointStateWriter writer(directory_ / bag, GetParam(), about);
    for (std::size_t k = 0; k < received.size(); ++k) {
      const double x = static_cast<double>(k);
      const double q[] = {x, 2 * x}, qd[] = {3 * x, 3 * x}, effort[] = {4 * x, 4 * x};
      const std::int64_t header = received[k] - 5;
      const JointStateRows rows{1, &header, &received[k], q, qd, effort};
      writer.write(std::vector<JointStateRows>(topics.size(), rows));
    }
    writer.finish();
    return directory_ / bag;
  }

  fs::path directory_;
};

Stamps evenly(std::size_t count) {
  Stamps stamps;
  for (std::size_t k = 0; k < count; ++k) {
    stamps.push_back(1'700'000'000'000'000'000 + static_cast<std::int64_t>(k) * 1'000'000);
  }
  return stamps;
}

std::string errorOfReading(const std::string& path, const std::string& topic = "") {
  return errorOf<RecordingError>([&] { rest(*Recording(path).jointStates(topic)); });
}

TEST_P(RecordingTest, GivesBackWhatWasWritten) {
  const Stamps received = evenly(9000);  // several blocks, and several chunks
  const std::string bag = write("bag", received);
  for (const std::string& path : {bag, file("bag").string()}) {
    const Recording recording(path);
    EXPECT_EQ(recording.storage(), GetParam());
    ASSERT_EQ(recording.topics().size(), 1U);
    EXPECT_EQ(recording.topics()[0].name, "/joint_states");
    EXPECT_EQ(recording.topics()[0].type, kJointState);
    EXPECT_EQ(recording.topics()[0].messages, 9000);
    const auto source = recording.jointStates();
    EXPECT_EQ(source->expectedMessages(), 9000);
    EXPECT_EQ(source->where(), path + ": /joint_states");
    const JointStateBlock all = rest(*source);
    EXPECT_EQ(all.joint_names, kNames);
    EXPECT_EQ(all.frame_id, "base");
    EXPECT_EQ(all.receive_stamps, received);
    EXPECT_EQ(all.header_stamps[8999], received[8999] - 5);
    EXPECT_EQ(all.position.values[2 * 8999 + 1], 2.0 * 8999);
    EXPECT_EQ(all.velocity.values[2 * 8999], 3.0 * 8999);
    EXPECT_EQ(all.effort.values[2 * 4096], 4.0 * 4096);
  }
}

TEST_P(RecordingTest, StartsAgainAfterRewind) {
  const auto source = Recording(write("bag", evenly(5000))).jointStates();
  JointSample sample;
  for (int k = 0; k < 3; ++k) source->next(sample);
  EXPECT_EQ(sample.message, 2);
  source->rewind();
  EXPECT_EQ(rest(*source).receive_stamps, evenly(5000));
  EXPECT_FALSE(source->next(sample));
  source->rewind();
  EXPECT_EQ(rest(*source).receive_stamps, evenly(5000));
}

TEST_P(RecordingTest, GivesMessagesInTheOrderOfReceptionAndEqualTimesAsWritten) {
  Stamps received;
  for (int k = 0; k < 20'000; ++k) received.push_back(1'000'000 + (k * 7919) % 5003);
  const JointStateBlock all = rest(*Recording(write("bag", received)).jointStates());
  ASSERT_EQ(all.size(), received.size());
  EXPECT_TRUE(std::is_sorted(all.receive_stamps.begin(), all.receive_stamps.end()));
  for (std::size_t k = 1; k < all.size(); ++k) {
    if (all.receive_stamps[k] == all.receive_stamps[k - 1]) {
      ASSERT_GT(all.position.values[2 * k], all.position.values[2 * k - 2]) << k;
    }
  }
}

TEST_P(RecordingTest, GivesMessagesAsStoredWhereTheRecordersClockWasSetBack) {
  for (const std::size_t count : {200U, 30'000U}) {  // within a chunk and over several
    Stamps received = evenly(count);
    for (std::size_t k = count / 2; k < count; ++k) {
      received[k] -= static_cast<std::int64_t>(count) * 400'000;
    }
    const std::string bag = write("bag_" + std::to_string(count), received);
    EXPECT_EQ(rest(*Recording(bag).jointStates()).receive_stamps, received);
    if (GetParam() != Storage::kMcap) continue;
    constexpr std::ptrdiff_t kFooter = 20, kMagic = 8;  // bytes
    const std::string part = file("bag_" + std::to_string(count));
    std::string content = contentOf(part);  // then without a summary
    std::fill(content.end() - kMagic - kFooter, content.end() - kMagic, '\0');
    put(part, content);
    EXPECT_EQ(rest(*Recording(bag).jointStates()).receive_stamps, received);
  }
}

TEST_P(RecordingTest, TellsTopicsApart) {
  const std::string bag = write("bag", evenly(3000), {"/torques", "/torques_gt"});
  const Recording recording(bag);
  EXPECT_EQ(rest(*recording.jointStates("/torques_gt")).size(), 3000U);
  EXPECT_THAT(errorOfReading(bag),
              HasSubstr("expected one topic of type sensor_msgs/msg/JointState, got 2; name it "
                        "with --topic. The recording has\n  /torques  sensor_msgs/msg/JointState  "
                        "3000 messages\n  /torques_gt"));
  EXPECT_THAT(errorOfReading(bag, "/other"), HasSubstr("has no topic /other; name one it has"));
  Message message;
  std::vector<std::string> topics;
  const auto all = recording.allMessages();
  while (all->next(message)) topics.push_back(*message.topic);
  ASSERT_EQ(topics.size(), 6000U);
  for (std::size_t k = 0; k < topics.size(); ++k) {
    ASSERT_EQ(topics[k], k % 2 == 0 ? "/torques" : "/torques_gt");
  }
}

TEST_P(RecordingTest, ReadsFilesWithoutMetadataInTheOrderOfTheirNumbers) {
  const Stamps all = evenly(1200);
  fs::create_directory(directory_ / "run");
  const std::string kind = file("bag").extension();
  for (int i = 0; i < 12; ++i) {
    const std::string part = "part" + std::to_string(i);
    write(part, Stamps(all.begin() + 100 * i, all.begin() + 100 * (i + 1)));
    fs::rename(file(part), directory_ / "run" / ("run_" + std::to_string(i) + kind));
  }
  const std::string run = directory_ / "run";
  const auto source = Recording(run).jointStates();
  EXPECT_EQ(source->expectedMessages(), 1200);
  EXPECT_EQ(rest(*source).receive_stamps, all);
  EXPECT_THAT(source->note(), HasSubstr("metadata.yaml is missing: 12 files found in " + run));

  const auto alone = Recording(run + "/run_3" + kind).jointStates();
  EXPECT_EQ(rest(*alone).size(), 100U);
  EXPECT_THAT(
      alone->note(),
      HasSubstr("is read alone; 11 other files beside it may be of the same recording: give " +
                run));

  fs::rename(run + "/run_3" + kind, run + "/other" + kind);
  EXPECT_THAT(errorOfReading(run), HasSubstr("has no metadata.yaml; give one of its files"));
}

TEST_P(RecordingTest, ReadsRenamedFilesAsTheErrorSays) {
  const std::string bag = write("bag", evenly(10));
  const std::string other = bag + "/other" + file("bag").extension().string();
  fs::rename(file("bag"), other);
  EXPECT_THAT(errorOfReading(bag), EndsWith("; if it was renamed, give " + other + " itself"));
  EXPECT_EQ(rest(*Recording(other).jointStates()).size(), 10U);
  const std::string confused = bag + (GetParam() == Storage::kMcap ? "/bag.db3" : "/bag.mcap");
  fs::rename(other, confused);
  EXPECT_EQ(rest(*Recording(confused).jointStates()).size(), 10U);
}

TEST_P(RecordingTest, ReadsMcapWhateverItsProfile) {
  if (GetParam() != Storage::kMcap) GTEST_SKIP() << "only MCAP has profiles";
  const std::string bag = write("bag", evenly(10));
  std::string content = withoutChecksum(contentOf(file("bag")));
  const std::size_t at = content.find("ros2");
  put(file("bag"), content.replace(at, 4, "mine"));
  EXPECT_EQ(rest(*Recording(bag).jointStates()).size(), 10U);
  // Without a profile; the library's name takes its place.
  const std::string length(1, static_cast<char>(content[at + 4] + 4));
  put(file("bag"),
      content.replace(at - 4, 8, std::string(4, '\0') + length + std::string(3, '\0')));
  EXPECT_EQ(rest(*Recording(bag).jointStates()).size(), 10U);
}

TEST_P(RecordingTest, ReadsMetadataOfNewerVersions) {
  const std::string bag = write("bag", evenly(10));
  replace(directory_ / "bag/metadata.yaml", "version: 9", "version: 12\n  new_key: [1, 2]");
  EXPECT_EQ(rest(*Recording(bag).jointStates()).size(), 10U);
}

TEST_P(RecordingTest, ReadsFilesOfASplitRecordingOneAfterAnother) {
  const std::string bag = write("bag", evenly(300));
  write("more", evenly(200));
  const std::string name = "more" + file("bag").extension().string();
  fs::copy(file("more"), directory_ / "bag" / name);
  replace(directory_ / "bag/metadata.yaml", "relative_file_paths:\n",
          "relative_file_paths:\n  - " + name + "\n");
  EXPECT_THAT(errorOfReading(bag),
              HasSubstr("expected 300 messages, as its metadata say, got more"));
  replace(directory_ / "bag/metadata.yaml", "message_count: 300", "message_count: 500");
  Stamps both = evenly(200);
  for (const std::int64_t stamp : evenly(300)) both.push_back(stamp);
  EXPECT_EQ(rest(*Recording(bag).jointStates()).receive_stamps, both);
}

TEST_P(RecordingTest, NamesTheMessageThatCantBeDecoded) {
  const std::string bag = write("bag", evenly(1));
  std::string content = contentOf(file("bag"));
  if (GetParam() == Storage::kMcap) content = withoutChecksum(content);
  content[content.find("joint_1") - 4] = '\x7f';  // the length of the name
  put(file("bag"), content);
  EXPECT_THAT(errorOfReading(bag),
              StartsWith(bag + ": /joint_states, message 1: can't be decoded as "
                               "sensor_msgs/msg/JointState (expected 127 bytes at offset "));
}

TEST_P(RecordingTest, WritesNothingOverWhatThereIs) {
  const std::string bag = write("bag", evenly(3));
  EXPECT_THAT(
      errorOf<RecordingError>([&] { write("bag", evenly(3)); }),
      StartsWith(bag + ": can't be written (" + bag + " exists already, not overwriting); "));
  put(directory_ / "file", "");
  EXPECT_THAT(errorOf<RecordingError>([&] { write("file/bag", evenly(3)); }),
              HasSubstr("can't be written ("));
}

TEST_P(RecordingTest, IsNamedAfterItsDirectoryAlsoWithASlash) {
  JointStateWriter(directory_ / "bag/", GetParam(), {}).finish();
  EXPECT_TRUE(fs::exists(file("bag")));
}

TEST_P(RecordingTest, OfNothingIsReadable) {
  EXPECT_THAT(errorOfReading(write("empty", {}, {})),
              HasSubstr("is an empty recording: it has no topic; record it again"));
  EXPECT_EQ(rest(*Recording(write("bag", {})).jointStates()).size(), 0U);
  EXPECT_EQ(rest(*Recording(file("bag")).jointStates()).size(), 0U);
}

TEST_P(RecordingTest, NamesOddTopicsAndFilesAsTheyAre) {
  const std::string topic = "/a \"b\" \\ #:- \n\xc3\xa9";
  const std::string bag = write("b%20 ?#\"\xc3\xa9\n", evenly(3), {topic});
  EXPECT_EQ(Recording(bag).topics()[0].name, topic);
  EXPECT_EQ(rest(*Recording(bag).jointStates(topic)).size(), 3U);
  EXPECT_EQ(rest(*Recording(file("b%20 ?#\"\xc3\xa9\n")).jointStates()).size(), 3U);
}

TEST_P(RecordingTest, OfACompressedFileIsRead) {
  const std::string bag = write("bag", evenly(9000));
  pack("bag");
  EXPECT_EQ(rest(*Recording(bag).jointStates()).receive_stamps, evenly(9000));
}

// Where temporary files go, for the time of a test.
class Scratch {
 public:
  explicit Scratch(const std::string& directory) {
    if (const char* const before = std::getenv("TMPDIR")) before_ = before;
    setenv("TMPDIR", directory.c_str(), 1);
  }
  ~Scratch() { before_ ? setenv("TMPDIR", before_->c_str(), 1) : unsetenv("TMPDIR"); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

 private:
  std::optional<std::string> before_;
};

TEST_P(RecordingTest, NothingWithANameIsLeftOfACompressedFileOnceItIsOpen) {
  const std::string bag = write("bag", evenly(9000));
  pack("bag");
  const fs::path scratch = directory_ / "scratch";
  fs::create_directory(scratch);
  const Scratch there(scratch);
  const auto source = Recording(bag).jointStates();
  JointSample sample;
  ASSERT_TRUE(source->next(sample));
  EXPECT_TRUE(fs::is_empty(scratch));
  source->rewind();
  EXPECT_EQ(rest(*source).receive_stamps, evenly(9000));
  EXPECT_TRUE(fs::is_empty(scratch));
}

TEST_P(RecordingTest, NamesTheDirectoryThatCompressedFilesCantBeUnpackedInto) {
  const std::string bag = write("bag", evenly(3));
  pack("bag");
  const Scratch nowhere("/proc");
  const std::string text = errorOfReading(bag);
  EXPECT_THAT(text, StartsWith(bag + ": can't be unpacked into '/proc': "));
  EXPECT_THAT(text, HasSubstr("name another directory with TMPDIR"));
  EXPECT_THAT(text, Not(HasSubstr("damaged")));
}

TEST_P(RecordingTest, IsRefusedWhereItIsCutOff) {
  const std::string bag = write("bag", evenly(500));
  const std::string whole = contentOf(file("bag"));
  for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 97) {
    put(file("bag"), whole.substr(0, size));
    EXPECT_THAT(errorOfReading(bag), StartsWith(bag)) << size;
    EXPECT_THAT(errorOfReading(file("bag")), StartsWith(file("bag").string())) << size;
  }
}

TEST_P(RecordingTest, OfAnyBytesIsReadOrRefused) {
  write("bag", evenly(300), {"/torques", "/torques_gt"});
  const std::string whole = contentOf(file("bag"));
  std::mt19937 random(1);
  int read = 0, refused = 0;
  for (int k = 0; k < 800; ++k) {
    std::string damaged = whole;
    // The ends of a file hold its structure.
    const std::size_t range =
        k % 2 == 0 ? damaged.size() : std::min<std::size_t>(2000, damaged.size());
    const std::size_t begin = k % 4 == 1 ? damaged.size() - range : 0;
    for (unsigned changes = 1 + random() % 8; changes > 0; --changes) {
      damaged[begin + random() % range] = static_cast<char>(random());
    }
    put(directory_ / file("bag").filename(), damaged);
    try {
      const Recording recording(directory_ / file("bag").filename());
      JointSample sample;
      const auto source = recording.jointStates("/torques");
      while (source->next(sample)) ASSERT_LT(sample.effort.size, damaged.size());
      ++read;
    } catch (const RecordingError&) {
      ++refused;
    }
  }
  EXPECT_GT(read, 50);
  EXPECT_GT(refused, 50);
}

TEST_P(RecordingTest, OfAnyMetadataIsReadOrRefused) {
  const std::string bag = write("bag", evenly(10));
  const fs::path metadata = directory_ / "bag/metadata.yaml";
  const std::string whole = contentOf(metadata);
  std::mt19937 random(1);
  for (int k = 0; k < 300; ++k) {
    std::string damaged = whole;
    for (unsigned changes = 1 + random() % 4; changes > 0; --changes) {
      const std::size_t at = random() % damaged.size();
      if (random() % 2 == 0) {
        damaged[at] = static_cast<char>(random());
      } else {
        damaged.erase(at, random() % 20);
      }
    }
    put(metadata, damaged);
    try {
      rest(*Recording(bag).jointStates());
    } catch (const RecordingError& error) {
      ASSERT_THAT(error.what(), StartsWith(bag));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Storages, RecordingTest,
                         ::testing::Values(Storage::kSqlite3, Storage::kMcap), storageName);

// ---- of one kind of storage

class McapTest : public RecordingTest {
 protected:
  // The footer: where the summary begins.
  std::string withSummaryAt(std::uint64_t offset) const {
    std::string content = contentOf(file("bag"));
    content.replace(content.size() - 8 - 20, 8, reinterpret_cast<const char*>(&offset), 8);
    return content;
  }

  // Calls a function for each record of a kind in the summary.
  template <class Change>
  static void changeSummary(std::string& content, McapRecord kind, Change change) {
    const auto number = [&](std::size_t at) {
      std::uint64_t value = 0;
      std::memcpy(&value, &content[at], 8);
      return value;
    };
    const std::size_t end = content.size() - sizeof kMcapMagic - kMcapFooterSize - kMcapRecordHead;
    for (std::size_t at = number(end + kMcapRecordHead); at < end;) {
      const std::size_t next = at + kMcapRecordHead + number(at + 1);
      if (content[at] == kind) change(&content[at]);
      at = next;
    }
  }
};

TEST_P(McapTest, WithoutSummaryIsReadFromItsBeginning) {
  write("bag", evenly(9000), {"/torques", "/torques_gt"});
  put(file("bag"), withSummaryAt(0));
  const Recording recording(file("bag"));
  EXPECT_EQ(recording.expectedMessages("/torques"), 9000);
  EXPECT_EQ(rest(*recording.jointStates("/torques")).receive_stamps, evenly(9000));
}

TEST_P(McapTest, WithoutIndexIsReadInTheOrderOfReception) {
  write("bag", {3'000, 2'000, 1'000});
  put(file("bag"), withSummaryAt(0));
  EXPECT_THAT(rest(*Recording(file("bag")).jointStates()).receive_stamps,
              ElementsAre(1'000, 2'000, 3'000));
}

TEST_P(McapTest, OfMessagesOutsideOfChunksIsReadInTheOrderOfReception) {
  write("bag", {3'000, 2'000, 1'000});
  const std::string content = withSummaryAt(0);
  const auto number = [&](std::size_t at) {
    std::uint64_t value = 0;
    std::memcpy(&value, &content[at], 8);
    return value;
  };
  constexpr std::size_t kChunkHead = 8 + 8 + 8 + 4 + 4 + 8;  // times, sizes, checksum, compression
  const std::size_t chunk = sizeof kMcapMagic + kMcapRecordHead + number(sizeof kMcapMagic + 1);
  const std::string records =
      content.substr(chunk + kMcapRecordHead + kChunkHead, number(chunk + 1) - kChunkHead);
  const std::size_t end = kMcapRecordHead + kMcapFooterSize + sizeof kMcapMagic;
  put(file("bag"), content.substr(0, chunk) + records + content.substr(content.size() - end));
  EXPECT_THAT(rest(*Recording(file("bag")).jointStates()).receive_stamps,
              ElementsAre(1'000, 2'000, 3'000));
}

TEST_P(McapTest, WithAnotherBeginningEndOrSummaryIsRefused) {
  write("bag", evenly(10));
  const std::string whole = contentOf(file("bag"));
  put(file("bag"), withSummaryAt(1));
  EXPECT_THAT(errorOfReading(file("bag")), HasSubstr("the summary lies outside of the file"));
  put(file("bag"), withSummaryAt(~std::uint64_t{0}));
  EXPECT_THAT(errorOfReading(file("bag")), HasSubstr("the summary lies outside of the file"));
  put(file("bag"), "x" + whole.substr(1));
  EXPECT_THAT(errorOfReading(file("bag")), HasSubstr("expected an MCAP file"));
  for (const std::size_t missing : {1U, 100U}) {
    put(file("bag"), whole.substr(0, whole.size() - missing));
    EXPECT_THAT(
        errorOfReading(file("bag")),
        AllOf(HasSubstr("the file has no end"), HasSubstr("`mcap recover` saves what is there")));
  }
}

TEST_P(McapTest, WithoutSchemasOrChannelsInTheSummaryIsRead) {
  write("bag", evenly(9000));
  std::string content = contentOf(file("bag"));
  for (const McapRecord kind : {kMcapSchema, kMcapChannel}) {
    changeSummary(content, kind, [](char* record) { *record = '\x80'; });
    put(file("bag"), content);
    EXPECT_EQ(rest(*Recording(file("bag")).jointStates()).receive_stamps, evenly(9000)) << kind;
  }
}

TEST_P(McapTest, WithChunksOfOtherSizesThanTheIndexSaysIsRefused) {
  write("bag", evenly(9000));
  std::string content = contentOf(file("bag"));
  changeSummary(content, kMcapChunkIndex, [](char* record) { --record[kMcapRecordHead + 24]; });
  put(file("bag"), content);
  EXPECT_THAT(errorOfReading(file("bag")), HasSubstr("a chunk isn't where the index says"));
}

TEST_P(McapTest, WithANumberThatWasDamagedIsRefused) {
  write("bag", evenly(10));
  std::string content = contentOf(file("bag"));
  content[content.find("joint_2") + 30] ^= 1;
  put(file("bag"), content);
  EXPECT_THAT(errorOfReading(file("bag")), HasSubstr("a chunk's checksum doesn't fit its content"));
  put(file("bag"), withoutChecksum(content));
  EXPECT_EQ(errorOfReading(file("bag")), "no error");
}

INSTANTIATE_TEST_SUITE_P(Storages, McapTest, ::testing::Values(Storage::kMcap), storageName);

class SqliteTest : public RecordingTest {
 protected:
  void run(const std::string& statement) const {
    sqlite3* database = nullptr;
    sqlite3_open(file("bag").c_str(), &database);
    EXPECT_EQ(sqlite3_exec(database, statement.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
  }
};

TEST_P(SqliteTest, IsWholeByTheLibrarysOwnCheck) {
  write("bag", evenly(5000), {"/torques", "/torques_gt"});
  sqlite3* database = nullptr;
  sqlite3_open(file("bag").c_str(), &database);
  std::string result;
  sqlite3_exec(
      database, "PRAGMA integrity_check",
      [](void* to, int, char** values, char**) {
        *static_cast<std::string*>(to) += values[0];
        return 0;
      },
      &result, nullptr);
  sqlite3_close(database);
  EXPECT_EQ(result, "ok");
}

TEST_P(SqliteTest, IsRefusedWithoutTheLastByteOfItsLastPage) {
  const std::string bag = write("bag", evenly(500));
  std::string whole = contentOf(file("bag"));
  for (const bool counts_pages : {true, false}) {
    if (!counts_pages) {                   // as a writer before SQLite 3.7 leaves the header
      whole.replace(28, 4, {0, 0, 0, 1});  // pages, when a newer one wrote ...
      whole[95] = static_cast<char>(whole[27] - 1);  // ... before this change
    }
    put(file("bag"), whole);
    EXPECT_EQ(rest(*Recording(bag).jointStates()).size(), 500U);
    for (const std::size_t missing : {1U, 1000U, 32767U}) {
      put(file("bag"), whole.substr(0, whole.size() - missing));
      const std::string got = std::to_string(whole.size() - missing);
      EXPECT_THAT(errorOfReading(bag),
                  HasSubstr("the file is cut off: expected " + std::to_string(whole.size()) +
                            " bytes, as many as its pages have, got " + got));
      EXPECT_THAT(errorOfReading(file("bag")), HasSubstr("the file is cut off"));
    }
  }
}

TEST_P(SqliteTest, IsReadWithBytesBehindItsLastPage) {
  const std::string bag = write("bag", evenly(500));
  put(file("bag"), contentOf(file("bag")) + std::string(100'000, '\0'));
  EXPECT_EQ(rest(*Recording(bag).jointStates()).size(), 500U);
}

TEST_P(SqliteTest, IsReadWithoutItsIndexAndOutOfOrder) {
  const std::string bag = write("bag", {3'000, 1'000, 2'000});
  run("DROP INDEX timestamp_idx");
  EXPECT_THAT(rest(*Recording(bag).jointStates()).receive_stamps, ElementsAre(1'000, 2'000, 3'000));
}

TEST_P(SqliteTest, OfOlderVersionsIsRead) {
  write("bag", evenly(10));
  run("DROP TABLE message_definitions; ALTER TABLE topics DROP COLUMN type_description_hash; "
      "ALTER TABLE topics DROP COLUMN offered_qos_profiles; DROP TABLE schema; DROP TABLE "
      "metadata");
  EXPECT_EQ(rest(*Recording(file("bag")).jointStates()).size(), 10U);
}

TEST_P(SqliteTest, WithAViewInsteadOfATableIsRefused) {
  const std::string bag = write("bag", evenly(10));
  run("ALTER TABLE messages RENAME TO m; CREATE VIEW messages AS SELECT * FROM m");
  EXPECT_THAT(errorOfReading(bag), HasSubstr("expected the table messages, got a view"));
  pack("bag");
  EXPECT_THAT(errorOfReading(bag), StartsWith(bag + ": can't be read as a rosbag2 recording ("
                                                    "expected the table messages, got a view)"));
}

TEST_P(SqliteTest, WithAVirtualTableIsRefused) {
  const std::string bag = write("bag", evenly(10));
  run("DROP TABLE messages; CREATE VIRTUAL TABLE messages USING rtree(topic_id, timestamp, data)");
  EXPECT_THAT(errorOfReading(bag), HasSubstr("expected the table messages, got a virtual table"));
}

TEST_P(SqliteTest, TakesNoMoreMemoryForAValueThanTheFileHas) {
  const std::string bag = write("bag", evenly(10));
  run("ALTER TABLE messages RENAME TO m; CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, "
      "timestamp, data AS (zeroblob(500000000))); "
      "INSERT INTO messages SELECT id, topic_id, timestamp FROM m");
  EXPECT_THAT(errorOfReading(bag), HasSubstr("string or blob too big"));
}

TEST_P(SqliteTest, WithAnInterruptedChangeIsRefused) {
  write("bag", evenly(5000));
  sqlite3* database = nullptr;
  sqlite3_open(file("bag").c_str(), &database);
  sqlite3_exec(database,
               "PRAGMA cache_size=2; BEGIN; UPDATE messages SET timestamp = timestamp + 5e9",
               nullptr, nullptr, nullptr);
  const std::string killed = directory_ / "killed.db3";  // what a process that was killed leaves
  fs::copy(file("bag"), killed);
  fs::copy(file("bag").string() + "-journal", killed + "-journal");
  sqlite3_close(database);
  EXPECT_THAT(errorOfReading(killed),
              StartsWith(killed + ": is incomplete: a change of it was interrupted; undo it with"));
  fs::resize_file(killed + "-journal", 0);  // as the mode TRUNCATE leaves it
  EXPECT_THAT(errorOfReading(killed), Not(HasSubstr("is incomplete")));
}

TEST_P(SqliteTest, WithAnotherSerializationOfAnotherTopicIsRead) {
  write("bag", evenly(10));
  run("INSERT INTO topics VALUES (7, '/scan', 'a/msg/B', 'protobuf', '', '')");
  const Recording recording(file("bag"));
  EXPECT_EQ(rest(*recording.jointStates()).size(), 10U);
  EXPECT_THAT(errorOf<RecordingError>([&] { recording.messages("/scan"); }),
              HasSubstr("topic /scan: serialization: expected cdr, got 'protobuf'"));
  EXPECT_THAT(errorOf<RecordingError>([&] { recording.allMessages(); }), HasSubstr("/scan"));
}

INSTANTIATE_TEST_SUITE_P(Storages, SqliteTest, ::testing::Values(Storage::kSqlite3), storageName);

// ---- what isn't a recording

TEST(NoRecording, IsToldByWhatItIs) {
  EXPECT_THAT(errorOfReading("/nowhere"),
              StartsWith("/nowhere: no such file or directory; expected a rosbag2 recording"));
  EXPECT_THAT(errorOfReading("/usr"),
              HasSubstr("it has no metadata.yaml; is it another directory?"));
  EXPECT_THAT(errorOfReading("/etc/passwd"), HasSubstr("got 'passwd'"));
}

}  // namespace inverse_dynamics_evaluation::recording_test

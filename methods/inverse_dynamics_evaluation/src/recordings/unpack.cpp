// SPDX-License-Identifier: Apache-2.0

#include "unpack.hpp"

#include <fcntl.h>
#include <lz4frame.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <new>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>

namespace inverse_dynamics_evaluation {
inline namespace v2 {
namespace {

constexpr char kVariable[] = "IDS_UNPACK_LIMIT_MB";
constexpr std::uint64_t kMegabyte = 1'000'000;
constexpr std::size_t kStep = 1 << 20;

// Room for more bytes behind the first `done`, up to the limit and one byte beyond it.
void makeRoom(Bytes& out, std::size_t done, std::uint64_t most) {
  if (done < out.size()) return;
  const std::uint64_t wanted = std::max<std::uint64_t>(kStep, out.size() + out.size() / 2);
  out.resize(std::min<std::uint64_t>(wanted, most + 1));
}

// A compressed file, piece by piece.
void unpackFile(const InputFile& packed, const std::string& what, OutputFile& unpacked) {
  const std::uint64_t most = mostUnpacked(packed.size());
  const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(),
                                                                             &ZSTD_freeDStream);
  if (!stream) throw std::bad_alloc();
  Bytes in, out(kStep);
  std::size_t unfinished = 0;
  for (std::uint64_t read = 0; read < packed.size(); read += in.size()) {
    packed.read(read, std::min<std::uint64_t>(kStep, packed.size() - read), in);
    ZSTD_inBuffer from{in.data(), in.size(), 0};
    for (bool full = true; from.pos < from.size || (unfinished != 0 && full);) {
      ZSTD_outBuffer to{out.data(), out.size(), 0};
      unfinished = ZSTD_decompressStream(stream.get(), &to, &from);
      if (ZSTD_isError(unfinished) != 0) throw DamageError(ZSTD_getErrorName(unfinished));
      full = to.pos == to.size;
      if (unpacked.size() + to.pos > most) throw beyondLimit(what, packed.size(), most);
      unpacked.write(out.data(), to.pos);
    }
  }
  if (unfinished != 0) throw DamageError("compressed data ended before the end of its frame");
}

constexpr char kOpenFiles[] = "/proc/self/fd/";

// A new file, and its name; none where the file system has files without one, which are gone with
// the program however that ends.
std::pair<int, std::string> newFile(const std::string& directory) {
  if (::access(kOpenFiles, X_OK) == 0) {
    const int file = ::open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
    if (file >= 0) return {file, ""};
  }
  std::string path = directory + "/recording_XXXXXX";
  const int file = ::mkostemp(path.data(), O_CLOEXEC);
  if (file < 0) throw std::system_error(errno, std::generic_category());
  return {file, path};
}

// Gives a file without a name one of its own.
std::string named(int file, const std::string& directory) {
  static std::atomic<unsigned> number{0};
  const std::string place = kOpenFiles + std::to_string(file);
  while (true) {
    std::string path =
        directory + "/recording_" + std::to_string(::getpid()) + "_" + std::to_string(number++);
    if (::linkat(AT_FDCWD, place.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      return path;
    }
    if (errno != EEXIST) throw std::system_error(errno, std::generic_category());
  }
}

}  // namespace

ReadingError beyondLimit(const std::string& what, std::uint64_t packed, std::uint64_t most) {
  return ReadingError(what + " of " + std::to_string(packed) + " bytes unpacks to more than " +
                      std::to_string((most + kMegabyte / 2) / kMegabyte) +
                      " MB: it is damaged, or made to fill memory or disk; if you trust it, raise "
                      "the limit with " +
                      kVariable);
}

std::uint64_t mostUnpacked(std::uint64_t packed) {
  constexpr std::uint64_t kMegabytes = 256;
  constexpr std::uint64_t kTimes = 50;  // joint states shrink to a third, at rest to a tenth
  constexpr std::size_t kMostDigits = 12;
  const char* const variable = std::getenv(kVariable);
  std::uint64_t megabytes = kMegabytes;
  if (variable != nullptr && *variable != '\0') {
    const std::string text = variable;
    if (text.size() > kMostDigits || text.find_first_not_of("0123456789") != std::string::npos) {
      throw ReadingError(
          std::string(kVariable) + ": expected a whole number of megabytes, got " +
          quoted(text.size() > kMostDigits ? text.substr(0, kMostDigits) + "..." : text));
    }
    megabytes = std::stoull(text);
  }
  return std::max(megabytes * kMegabyte, kTimes * packed);
}

void ZstdUnpacker::Free::operator()(ZSTD_DCtx_s* context) const { ZSTD_freeDCtx(context); }

ZstdUnpacker::ZstdUnpacker() : context_(ZSTD_createDCtx()) {
  if (!context_) throw std::bad_alloc();
}

void ZstdUnpacker::unpack(const std::uint8_t* packed, std::size_t size, const std::string& what,
                          Bytes& out) {
  const std::uint64_t most = mostUnpacked(size);
  ZSTD_DCtx_reset(context_.get(), ZSTD_reset_session_only);
  // The size that the first frame states, if it may be that large; both unknown cases are larger.
  const std::uint64_t stated = ZSTD_getFrameContentSize(packed, size);
  out.resize(stated <= most ? static_cast<std::size_t>(stated) : 0);
  ZSTD_inBuffer in{packed, size, 0};
  std::size_t done = 0, unfinished = 0;
  bool full = true;
  while (in.pos < in.size || (unfinished != 0 && full)) {
    makeRoom(out, done, most);
    ZSTD_outBuffer to{out.data(), out.size(), done};
    unfinished = ZSTD_decompressStream(context_.get(), &to, &in);
    if (ZSTD_isError(unfinished) != 0) throw DamageError(ZSTD_getErrorName(unfinished));
    full = to.pos == to.size;
    done = to.pos;
    if (done > most) throw beyondLimit(what, size, most);
  }
  if (unfinished != 0) throw DamageError("compressed data ended before the end of its frame");
  out.resize(done);
}

void unpackLz4(const std::uint8_t* packed, std::size_t size, Bytes& out) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0) {
    throw std::bad_alloc();
  }
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(
      made, &LZ4F_freeDecompressionContext);
  const std::uint64_t most = mostUnpacked(size);
  std::size_t read = 0, done = 0, unfinished = 0;
  bool full = true;
  out.clear();
  while (read < size || (unfinished != 0 && full)) {
    makeRoom(out, done, most);
    std::size_t room = out.size() - done, taken = size - read;
    unfinished =
        LZ4F_decompress(context.get(), out.data() + done, &room, packed + read, &taken, nullptr);
    if (LZ4F_isError(unfinished) != 0) throw DamageError(LZ4F_getErrorName(unfinished));
    done += room;
    read += taken;
    full = done == out.size();
    if (done > most) throw beyondLimit("a chunk", size, most);
  }
  if (unfinished != 0) throw DamageError("compressed data ended before the end of its frame");
  out.resize(done);
}

UnpackedFile::UnpackedFile(const std::string& packed_path) {
  namespace fs = std::filesystem;
  const InputFile packed(packed_path);
  std::error_code none;
  const std::string directory = fs::temp_directory_path(none);
  try {
    int file = -1;
    std::tie(file, path_) = newFile(directory);
    OutputFile unpacked(file);
    unpackFile(packed, fs::path(packed_path).filename(), unpacked);
    if (path_.empty()) path_ = named(file, directory);
    unpacked.close();
  } catch (const std::system_error& error) {
    removeName();
    throw ReadingError("can't be unpacked into " + quoted(directory) + ": " + error.what() +
                       "; free some space, or name another directory with TMPDIR");
  } catch (...) {
    removeName();
    throw;
  }
}

UnpackedFile::~UnpackedFile() { removeName(); }

void UnpackedFile::removeName() const {
  if (!path_.empty()) ::unlink(path_.c_str());
}

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

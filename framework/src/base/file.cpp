#include "lumivox/base/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "lumivox/base/error.h"

namespace lumivox {
namespace {

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return value_; }

 private:
  int value_;
};

[[noreturn]] void fail(const std::filesystem::path& path, const char* action) {
  throw Error(fmt::format("{}: cannot {}: {}", path.string(), action, std::strerror(errno)));
}

void writeAll(int descriptor, std::span<const std::byte> bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(path, "write");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  // The data must be on the disk before the name points to it.
  if (fsync(descriptor) != 0 && errno != EINVAL) fail(path, "write");
}

/// A name beside the target that no other process or thread uses.
std::filesystem::path besideName(const std::filesystem::path& path) {
  static std::atomic<unsigned> counter{0};
  return path.parent_path() / fmt::format(".{}.{}.{}.new", path.filename().string(), getpid(), counter++);
}

}  // namespace

std::string readFile(const std::filesystem::path& path, std::uint64_t limitBytes) {
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) fail(path, "read");
  struct stat status {};
  if (fstat(file.get(), &status) != 0) fail(path, "read");
  if (S_ISDIR(status.st_mode)) throw Error(fmt::format("{}: is a directory; expected a file", path.string()));
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (size > limitBytes) {
    throw Error(fmt::format("{}: is too large ({}); expected at most {}", path.string(), formatBytes(size),
                            formatBytes(limitBytes)));
  }
  std::string content;
  content.reserve(static_cast<std::size_t>(size) + 1);
  char block[1 << 16];
  for (;;) {
    const ssize_t count = read(file.get(), block, sizeof(block));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(path, "read");
    if (count == 0) break;
    content.append(block, static_cast<std::size_t>(count));
    if (content.size() > limitBytes) {
      throw Error(
          fmt::format("{}: is too large; expected at most {}", path.string(), formatBytes(limitBytes)));
    }
  }
  return content;
}

std::string readFileMaybeGzip(const std::filesystem::path& path, std::uint64_t limitBytes) {
  std::string packed = readFile(path, limitBytes);
  if (path.extension() != ".gz") return packed;
  constexpr int kWindowBits = 15 + 16;  // zlib: the largest window, gzip framing
  z_stream stream{};
  if (inflateInit2(&stream, kWindowBits) != Z_OK)
    throw Error(fmt::format("{}: cannot start to unpack", path.string()));
  stream.next_in = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  std::string content;
  std::vector<char> block(1 << 20);
  int result = Z_OK;
  while (result == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(block.data());
    stream.avail_out = static_cast<uInt>(block.size());
    result = inflate(&stream, Z_NO_FLUSH);
    content.append(block.data(), block.size() - stream.avail_out);
    if (content.size() > limitBytes) break;
    if (result == Z_STREAM_END && stream.avail_in > 0)
      result = inflateReset(&stream);  // concatenated members
  }
  inflateEnd(&stream);
  if (content.size() > limitBytes) {
    throw Error(fmt::format("{}: is too large when unpacked; expected at most {}", path.string(),
                            formatBytes(limitBytes)));
  }
  if (result != Z_STREAM_END) {
    throw Error(fmt::format("{}: is not a whole gzip file ({}); expected RFC 1952 data", path.string(),
                            result == Z_DATA_ERROR ? "corrupt" : "truncated"));
  }
  return content;
}

void createParentDirectories(const std::filesystem::path& file) {
  const auto parent = file.parent_path();
  if (parent.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(parent, error);
  if (error) throw Error(fmt::format("{}: cannot make this directory: {}", parent.string(), error.message()));
}

void writeFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  const std::filesystem::path parent =
      path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (std::filesystem::is_directory(path))
    throw Error(fmt::format("{}: cannot write: is a directory", path.string()));
  const std::filesystem::path beside = besideName(path);
  constexpr mode_t kMode = 0666;
  // An unnamed file vanishes by itself when this process is killed; only a whole one ever gets a name.
  if (const Descriptor file(open(parent.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, kMode)); file.get() >= 0) {
    writeAll(file.get(), bytes, path);
    const std::string self = fmt::format("/proc/self/fd/{}", file.get());
    if (linkat(AT_FDCWD, self.c_str(), AT_FDCWD, beside.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      if (rename(beside.c_str(), path.c_str()) == 0) return;
      const int reason = errno;
      unlink(beside.c_str());
      errno = reason;
      fail(path, "write");
    }
  }
  const Descriptor file(open(beside.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, kMode));
  if (file.get() < 0) fail(path, "write");
  try {
    writeAll(file.get(), bytes, path);
    if (rename(beside.c_str(), path.c_str()) != 0) fail(path, "write");
  } catch (...) {
    unlink(beside.c_str());
    throw;
  }
}

void writeFileAtomically(const std::filesystem::path& path, std::string_view text) {
  writeFileAtomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

std::uint64_t availableMemory() {
  std::ifstream information("/proc/meminfo");
  for (std::string line; std::getline(information, line);) {
    unsigned long long kibibytes = 0;
    if (std::sscanf(line.c_str(), "MemAvailable: %llu kB", &kibibytes) == 1)
      return std::uint64_t{kibibytes} * 1024;
  }
  return ~std::uint64_t{0};
}

void requireMemory(std::uint64_t bytes, std::string_view what) {
  const std::uint64_t availableBytes = availableMemory();
  if (bytes > availableBytes) {
    throw Error(fmt::format("{} needs {}, but only {} of memory are available", what, formatBytes(bytes),
                            formatBytes(availableBytes)));
  }
}

std::string formatBytes(std::uint64_t bytes) {
  constexpr const char* kUnits[] = {"B", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  auto value = static_cast<double>(bytes);
  int unit = 0;
  while (value >= 1024.0 && unit < 6) {
    value /= 1024.0;
    ++unit;
  }
  return unit == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.1f} {}", value, kUnits[unit]);
}

std::filesystem::path cacheDirectory() {
  std::filesystem::path directory;
  if (const char* own = std::getenv("LUMIVOX_CACHE"); own != nullptr && *own != '\0') {
    directory = own;
  } else if (const char* shared = std::getenv("XDG_CACHE_HOME"); shared != nullptr && *shared != '\0') {
    directory = std::filesystem::path(shared) / "lumivox";
  } else if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') {
    directory = std::filesystem::path(home) / ".cache" / "lumivox";
  } else {
    directory = std::filesystem::temp_directory_path() / "lumivox-cache";
  }
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error)
    throw Error(fmt::format("{}: cannot make the cache directory: {}", directory.string(), error.message()));
  return directory;
}

}  // namespace lumivox

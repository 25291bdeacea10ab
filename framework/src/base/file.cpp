#include "lumivox/base/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <mutex>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "base/file_set.h"
#include "lumivox/base/error.h"

namespace lumivox {
namespace {

/// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) close(value_);
  }
  Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  int get() const { return value_; }

 private:
  int value_;
};

[[noreturn]] void fail(const std::filesystem::path& path, const char* action) {
  throw Error(fmt::format("{}: cannot {}: {}", path.string(), action, std::strerror(errno)));
}

const char* kindOf(mode_t mode) {
  if (S_ISREG(mode)) return "a regular file";
  if (S_ISDIR(mode)) return "a directory";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "a device";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISSOCK(mode)) return "a socket";
  return "no regular file";
}

/// The files that this process has read, by device, inode and, if the system tells it, time of creation: the
/// inode of a deleted file may be reused.
class ReadFiles {
 public:
  void add(const struct stat& status, const std::filesystem::path& path) {
    const std::lock_guard lock(mutex_);
    files_.insert(identityOf(status, path));
  }
  void remove(const struct stat& status, const std::filesystem::path& path) {
    const std::lock_guard lock(mutex_);
    files_.erase(identityOf(status, path));
  }
  bool contains(const struct stat& status, const std::filesystem::path& path) {
    const std::lock_guard lock(mutex_);
    return files_.count(identityOf(status, path)) > 0;
  }

 private:
  using Identity = std::tuple<dev_t, ino_t, std::int64_t, std::uint32_t>;
  static Identity identityOf(const struct stat& status, const std::filesystem::path& path) {
    struct statx more {};
    const bool told =
        statx(AT_FDCWD, path.c_str(), 0, STATX_BTIME, &more) == 0 && (more.stx_mask & STATX_BTIME) != 0;
    return {status.st_dev, status.st_ino, told ? more.stx_btime.tv_sec : 0,
            told ? more.stx_btime.tv_nsec : 0};
  }

  std::mutex mutex_;
  std::set<Identity> files_;
};
ReadFiles& filesRead() {
  static ReadFiles files;
  return files;
}

/// Opens a regular file for reading. O_NONBLOCK keeps open() from waiting for the writer of a FIFO; for
/// regular files it has no effect.
Descriptor openRegular(const std::filesystem::path& path, struct stat& status) {
  Descriptor file(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (file.get() < 0) fail(path, "read");
  if (fstat(file.get(), &status) != 0) fail(path, "read");
  if (!S_ISREG(status.st_mode)) {
    throw Error(fmt::format("{}: is {}; expected a regular file", path.string(), kindOf(status.st_mode)));
  }
  filesRead().add(status, path);
  return file;
}

/// Reads up to `most` bytes.
std::string readSome(const Descriptor& file, std::uint64_t expected, std::uint64_t most,
                     const std::filesystem::path& path) {
  std::string content;
  // Reads a little more than the stated size, to see the end; files of /proc state no size.
  constexpr std::uint64_t kAtLeast = 1 << 12;
  content.resize(std::min(std::max(expected + 1, kAtLeast), most));
  std::size_t size = 0;
  while (size < most) {
    if (size == content.size()) content.resize(std::min<std::uint64_t>(2 * content.size(), most));
    const ssize_t count = read(file.get(), content.data() + size, content.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(path, "read");
    if (count == 0) break;
    size += static_cast<std::size_t>(count);
  }
  content.resize(size);
  return content;
}

void writeAll(int descriptor, std::span<const std::byte> bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(path, "write");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

/// The data must be on the disk before the name points to it.
void writeToDisk(int descriptor, std::span<const std::byte> bytes, const std::filesystem::path& path) {
  writeAll(descriptor, bytes, path);
  if (fsync(descriptor) != 0 && errno != EINVAL) fail(path, "write");
}

/// The target of a path to be written, after symbolic links.
struct Target {
  std::filesystem::path path;
  std::optional<struct stat> status;  ///< absent: the target does not exist yet
  /// True for links to open files (/dev/stdout, /dev/fd/3), which have no path.
  bool isOpenFile = false;

  bool isWrittenThrough() const {
    return isOpenFile || (status && (S_ISCHR(status->st_mode) || S_ISFIFO(status->st_mode)));
  }
};

bool isOfKernel(const std::filesystem::path& folder) {
  struct statfs system {};
  return statfs(folder.empty() ? "." : folder.c_str(), &system) == 0 && system.f_type == PROC_SUPER_MAGIC;
}

Target targetOf(const std::filesystem::path& path) {
  constexpr int kMostLinks = 40;  // the kernel's own limit
  Target target{path, std::nullopt, false};
  for (int links = 0;; ++links) {
    struct stat status {};
    if (lstat(target.path.c_str(), &status) != 0) {
      if (errno != ENOENT) fail(path, "write");
      return target;
    }
    if (!S_ISLNK(status.st_mode)) {
      target.status = status;
      break;
    }
    if (isOfKernel(target.path.parent_path())) {
      target.isOpenFile = true;
      return target;
    }
    if (links == kMostLinks)
      throw Error(fmt::format("{}: cannot write: its symbolic links are cyclic", path.string()));
    std::error_code error;
    const std::filesystem::path named = std::filesystem::read_symlink(target.path, error);
    if (error) throw Error(fmt::format("{}: cannot write: {}", path.string(), error.message()));
    target.path = named.is_absolute() ? named : target.path.parent_path() / named;
  }
  if (!S_ISREG(target.status->st_mode) && !target.isWrittenThrough()) {
    throw Error(fmt::format("{}: cannot write: is {}; expected a file", path.string(),
                            kindOf(target.status->st_mode)));
  }
  return target;
}

/// Writes to a target that is no regular file: an open file of this process continues at its position, others
/// are opened.
void writeThrough(const Target& target, std::span<const std::byte> bytes, const std::filesystem::path& path) {
  std::cout.flush();
  std::fflush(stdout);
  const std::filesystem::path table = "/proc/self/fd";
  std::error_code error;
  int number = -1;
  if (target.isOpenFile && std::filesystem::equivalent(target.path.parent_path(), table, error)) {
    const std::string name = target.path.filename().string();
    std::from_chars(name.data(), name.data() + name.size(), number);
  }
  const Descriptor file(number >= 0
                            ? fcntl(number, F_DUPFD_CLOEXEC, 0)
                            : open(target.path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (file.get() < 0 && errno == ENXIO)
    throw Error(fmt::format("{}: cannot write: is a FIFO without a reader", path.string()));
  if (file.get() < 0) fail(path, "write");
  // Only the opening must not wait.
  if (number < 0) fcntl(file.get(), F_SETFL, fcntl(file.get(), F_GETFL) & ~O_NONBLOCK);
  writeAll(file.get(), bytes, path);
}

/// A name beside the target that no other process or thread uses. It begins like the target's name, and is
/// short enough for the file system.
std::filesystem::path besideName(const std::filesystem::path& path) {
  static std::atomic<unsigned> counter{0};
  constexpr std::size_t kKept = 64;  // bytes
  std::string name = path.filename().string();
  if (name.size() > kKept) {
    std::size_t end = kKept;  // at a character boundary
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0u) == 0x80u) --end;
    name.resize(end);
  }
  return path.parent_path() / fmt::format(".{}.{}.{}.new", name, getpid(), counter++);
}

std::filesystem::path folderOf(const Target& target) {
  return target.path.has_parent_path() ? target.path.parent_path() : std::filesystem::path(".");
}

/// The new content of a file, whole and on the disk before it takes the file's name.
class StagedFile {
 public:
  /// Writes the content beside the target, as an unnamed file where the file system supports it: such a file
  /// vanishes if this process is killed.
  StagedFile(const std::filesystem::path& path, std::span<const std::byte> bytes)
      : path_(path), target_(targetOf(path)), bytes_(bytes) {
    if (target_.isWrittenThrough()) return;
    const std::filesystem::path folder = folderOf(target_);
    unnamed_.emplace(open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, kMode));
    if (unnamed_->get() >= 0)
      write(*unnamed_);
    else
      writeNamed();
  }
  ~StagedFile() {
    if (!beside_.empty()) unlink(beside_.c_str());
  }
  StagedFile(StagedFile&& other) noexcept
      : path_(std::move(other.path_)),
        target_(std::move(other.target_)),
        bytes_(other.bytes_),
        unnamed_(std::move(other.unnamed_)),
        beside_(std::exchange(other.beside_, {})) {}
  StagedFile& operator=(StagedFile&&) = delete;

  /// Gives an unnamed file a name beside the target.
  void nameBeside() {
    if (target_.isWrittenThrough() || !beside_.empty()) return;
    const std::filesystem::path beside = besideName(target_.path);
    const std::string self = fmt::format("/proc/self/fd/{}", unnamed_->get());
    if (linkat(AT_FDCWD, self.c_str(), AT_FDCWD, beside.c_str(), AT_SYMLINK_FOLLOW) == 0)
      beside_ = beside;
    else
      writeNamed();
  }
  void writeThroughNow() const {
    if (target_.isWrittenThrough()) writeThrough(target_, bytes_, path_);
  }
  void take() {
    if (target_.isWrittenThrough()) return;
    if (rename(beside_.c_str(), target_.path.c_str()) != 0) fail(path_, "write");
    beside_.clear();
    // Its inode may be that of a deleted file that was read.
    struct stat status {};
    if (stat(target_.path.c_str(), &status) == 0) filesRead().remove(status, target_.path);
  }

 private:
  static constexpr mode_t kMode = 0666;

  void write(const Descriptor& file) const {
    constexpr mode_t kPermissions = 0777;  // without the set-user-ID bit and similar
    if (target_.status && fchmod(file.get(), target_.status->st_mode & kPermissions) != 0)
      fail(path_, "write");
    writeToDisk(file.get(), bytes_, path_);
  }
  void writeNamed() {
    const std::filesystem::path beside = besideName(target_.path);
    const Descriptor file(open(beside.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, kMode));
    if (file.get() < 0) fail(path_, "write");
    try {
      write(file);
    } catch (...) {
      unlink(beside.c_str());
      throw;
    }
    beside_ = beside;
  }

  std::filesystem::path path_;
  Target target_;
  std::span<const std::byte> bytes_;
  std::optional<Descriptor> unnamed_;
  std::filesystem::path beside_;  ///< empty: unnamed, or already renamed to the target
};

}  // namespace

std::string readFile(const std::filesystem::path& path, std::uint64_t limitBytes) {
  struct stat status {};
  const Descriptor file = openRegular(path, status);
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (size > limitBytes) {
    throw Error(fmt::format("{}: is too large ({}); expected at most {}", path.string(), formatBytes(size),
                            formatBytes(limitBytes)));
  }
  constexpr std::uint64_t kSmall = std::uint64_t{16} << 20;  // too small to query the available memory
  if (size > kSmall) requireMemory(size, path.string());
  std::string content = readSome(file, size, limitBytes + 1, path);
  if (content.size() > limitBytes) {
    throw Error(fmt::format("{}: is too large; expected at most {}", path.string(), formatBytes(limitBytes)));
  }
  return content;
}

std::string readFilePart(const std::filesystem::path& path, std::uint64_t offset, std::uint64_t bytes) {
  struct stat status {};
  const Descriptor file = openRegular(path, status);
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (offset > size || bytes > size - offset)
    throw Error(fmt::format("{}: ends at byte {}; expected {} bytes from byte {} on", path.string(), size,
                            bytes, offset));
  requireMemory(bytes, path.string());
  if (lseek(file.get(), static_cast<off_t>(offset), SEEK_SET) < 0) fail(path, "read");
  std::string content = readSome(file, bytes, bytes, path);
  if (content.size() != bytes) throw Error(fmt::format("{}: cannot read: it became shorter", path.string()));
  return content;
}

std::string readFileStart(const std::filesystem::path& path, std::uint64_t limitBytes) {
  struct stat status {};
  const Descriptor file = openRegular(path, status);
  return readSome(file, std::min(static_cast<std::uint64_t>(status.st_size), limitBytes), limitBytes, path);
}

void requireRegularFile(const std::filesystem::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return;
  if (S_ISREG(status.st_mode)) return filesRead().add(status, path);
  throw Error(fmt::format("{}: is {}; expected a regular file", path.string(), kindOf(status.st_mode)));
}

bool wasRead(const std::filesystem::path& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 && filesRead().contains(status, path);
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
  // The last four bytes claim the size (RFC 1952, Sec. 2.3.1), at most what deflate can hold: room that is
  // not used is never touched, but a text that grows is copied.
  if (packed.size() >= 4) {
    constexpr std::uint64_t kMostExpansion = 1032;
    std::uint64_t claimed = 0;
    for (std::size_t i = 0; i < 4; ++i)
      claimed |= std::uint64_t{static_cast<unsigned char>(packed[packed.size() - 4 + i])} << (8 * i);
    content.reserve(std::min({claimed, kMostExpansion * packed.size(), limitBytes}));
  }
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

void requireWritable(const std::filesystem::path& file) {
  if (file.empty() || file.filename().empty())
    throw Error(fmt::format("{}: not the name of a file to write", file.empty() ? "''" : file.string()));
  createParentDirectories(file);
  const Target target = targetOf(file);
  if (target.isWrittenThrough()) {
    if (access(target.path.c_str(), W_OK) != 0) fail(file, "write");
    return;
  }
  const std::filesystem::path parent = folderOf(target);
  std::error_code failure;
  if (!std::filesystem::is_directory(parent, failure))
    throw Error(fmt::format("{}: {} is not a directory", file.string(), parent.string()));
  // Permissions are not sufficient (/proc, read-only mounts), so a file is made and removed.
  const std::filesystem::path beside = besideName(target.path);
  constexpr mode_t kOwnerOnly = 0600;
  const Descriptor made(open(beside.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, kOwnerOnly));
  if (made.get() < 0)
    throw Error(
        fmt::format("{}: cannot write into {}: {}", file.string(), parent.string(), std::strerror(errno)));
  unlink(beside.c_str());
}

void writeFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  const NewFile file{path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}};
  writeFilesAtomically({&file, 1});
}

void writeFilesAtomically(std::span<const NewFile> files) {
  std::vector<StagedFile> staged;
  staged.reserve(files.size());
  for (const NewFile& file : files)
    staged.emplace_back(file.path, std::as_bytes(std::span(file.content.data(), file.content.size())));
  // All steps that may still fail come before the first rename.
  for (StagedFile& file : staged) file.nameBeside();
  for (StagedFile& file : staged) file.writeThroughNow();
  for (StagedFile& file : staged) file.take();
}

void writeFileAtomically(const std::filesystem::path& path, std::string_view text) {
  writeFileAtomically(path, std::as_bytes(std::span(text.data(), text.size())));
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
  bool isFallback = false;
  if (const char* own = std::getenv("LUMIVOX_CACHE"); own != nullptr && *own != '\0') {
    directory = own;
  } else if (const char* shared = std::getenv("XDG_CACHE_HOME"); shared != nullptr && *shared != '\0') {
    directory = std::filesystem::path(shared) / "lumivox";
  } else if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') {
    directory = std::filesystem::path(home) / ".cache" / "lumivox";
  } else {
    directory = std::filesystem::temp_directory_path() / fmt::format("lumivox-cache-{}", geteuid());
    isFallback = true;
  }
  const auto refuse = [&](std::string_view why) {
    throw Error(fmt::format("{}: cannot be the cache directory: {}", directory.string(), why));
  };
  std::error_code error;
  if (directory.has_parent_path()) std::filesystem::create_directories(directory.parent_path(), error);
  constexpr mode_t kOwnerOnly = 0700;
  if (mkdir(directory.c_str(), kOwnerOnly) != 0 && errno != EEXIST) refuse(std::strerror(errno));
  struct stat status {};
  if ((isFallback ? lstat : stat)(directory.c_str(), &status) != 0) refuse(std::strerror(errno));
  if (!S_ISDIR(status.st_mode))
    refuse(fmt::format("is {}; expected a folder",
                       S_ISLNK(status.st_mode) ? "a symbolic link" : kindOf(status.st_mode)));
  if (isFallback && status.st_uid != geteuid())
    refuse("it belongs to another user; name a folder of your own in LUMIVOX_CACHE");
  if (isFallback && (status.st_mode & 0077) != 0 && chmod(directory.c_str(), kOwnerOnly) != 0)
    refuse(std::strerror(errno));
  return directory;
}

}  // namespace lumivox

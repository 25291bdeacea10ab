// Whole files: atomic writes, gzip, limits.
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <thread>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "support/facts.h"
#include "support/gzip.h"
#include "support/support.h"

using namespace lumivox;
using lumivox::test::gzip;
using lumivox::test::messageOf;
using lumivox::test::Tells;
using lumivox::test::TemporaryDirectory;

namespace {

std::size_t entriesIn(const std::filesystem::path& directory) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(directory), {}));
}

/// Fails the test when `work` takes longer than a thing that waits for nobody may.
template <class Work>
void requireNoWaiting(Work&& work) {
  constexpr unsigned kSeconds = 20;
  alarm(kSeconds);  // a call that waits for ever ends the program, and so the test
  work();
  alarm(0);
}

/// A device of its own that takes everything, as /dev/null does; nothing where this user may make none.
std::optional<std::filesystem::path> ownNullDevice(const TemporaryDirectory& directory) {
  const auto path = directory.path() / "null";
  if (mknod(path.c_str(), S_IFCHR | 0666, makedev(1, 3)) != 0) return std::nullopt;
  if (const int opened = open(path.c_str(), O_WRONLY); opened >= 0) {
    close(opened);
    return path;
  }
  return std::nullopt;  // devices do not work on this file system
}

mode_t kindAt(const std::filesystem::path& path) {
  struct stat status {};
  REQUIRE(lstat(path.c_str(), &status) == 0);
  return status.st_mode & S_IFMT;
}

}  // namespace

TEST_CASE("what is not a regular file is refused by its kind, without waiting and without reading") {
  const TemporaryDirectory directory;
  const auto fifo = directory.path() / "fifo", link = directory.path() / "link to fifo";
  REQUIRE(mkfifo(fifo.c_str(), 0600) == 0);
  const auto socketFile = directory.path() / "socket";
  const int server = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  REQUIRE(socketFile.string().size() < sizeof(address.sun_path));
  socketFile.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
  REQUIRE(bind(server, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0);
  std::filesystem::create_symlink(fifo, link);
  requireNoWaiting([&] {
    CHECK_THROWS_MATCHES(readFile(fifo), Error, Tells("fifo", "FIFO", "regular file"));
    CHECK_THROWS_MATCHES(readFile(link), Error, Tells("FIFO"));
    CHECK_THROWS_MATCHES(readFile("/dev/zero"), Error, Tells("/dev/zero", "device"));
    CHECK_THROWS_MATCHES(readFile(directory.path()), Error, Tells(directory.path(), "directory"));
    CHECK_THROWS_MATCHES(readFile(socketFile), Error, Tells("socket"));
    CHECK_THROWS_MATCHES(readFileMaybeGzip("/dev/zero", kLargestModelFile), Error, Tells("device"));
    CHECK_THROWS_MATCHES(readFileStart(fifo, 10), Error, Tells("FIFO"));
    CHECK_THROWS_MATCHES(requireRegularFile(fifo), Error, Tells("FIFO"));
  });
  close(server);
  CHECK_NOTHROW(requireRegularFile(directory.write("file", "x")));
  CHECK_NOTHROW(requireRegularFile(directory.path() / "absent"));
}

TEST_CASE("symbolic links are read through, and a file whose size is not known is read to its end") {
  const TemporaryDirectory directory;
  directory.write("file", "content");
  std::filesystem::create_symlink("file", directory.path() / "link");
  CHECK(readFile(directory.path() / "link") == "content");
  CHECK(readFileStart(directory.path() / "link", 4) == "cont");
  CHECK(readFileStart(directory.path() / "link", 400) == "content");
  CHECK_THAT(readFile("/proc/self/status"), Tells("Name:"));
}

TEST_CASE("a file larger than its kind may be is refused by its size before a byte of it is read") {
  const TemporaryDirectory directory;
  const auto huge = directory.write("huge.obj", "");
  std::filesystem::resize_file(huge, std::uint64_t{40} << 30);  // all hole
  requireNoWaiting([&] {
    CHECK_THROWS_MATCHES(readFile(huge, kLargestModelFile), Error, Tells("huge.obj", "40.0 GiB", "4.0 GiB"));
  });
  std::filesystem::resize_file(huge, kLargestTextFile + 1);
  CHECK_THROWS_MATCHES(readFile(huge), Error, Tells("64.0 MiB"));
}

TEST_CASE("writing to a device or a FIFO writes through it and leaves it what it is") {
  const TemporaryDirectory directory;
  const auto before = entriesIn(directory.path());
  if (const auto device = ownNullDevice(directory)) {
    writeFileAtomically(*device, std::string_view("gone"));
    CHECK(kindAt(*device) == S_IFCHR);
    std::filesystem::create_symlink(*device, directory.path() / "link");
    requireWritable(directory.path() / "link");
    writeFileAtomically(directory.path() / "link", std::string_view("gone too"));
    CHECK(kindAt(*device) == S_IFCHR);
    CHECK(entriesIn(directory.path()) == before + 2);
  } else if (geteuid() != 0) {
    writeFileAtomically("/dev/null", std::string_view("gone"));  // may not be replaced, so nothing is at risk
    CHECK(kindAt("/dev/null") == S_IFCHR);
  }
  CHECK_THROWS_MATCHES(writeFileAtomically("/dev/full", std::string_view("x")), Error,
                       Tells("/dev/full", "No space"));

  const auto fifo = directory.path() / "fifo";
  REQUIRE(mkfifo(fifo.c_str(), 0600) == 0);
  requireNoWaiting([&] {
    CHECK_THROWS_MATCHES(writeFileAtomically(fifo, std::string_view("x")), Error, Tells("FIFO", "without"));
    const int reader = open(fifo.c_str(), O_RDONLY | O_NONBLOCK);
    writeFileAtomically(fifo, std::string_view("through"));
    char bytes[16] = {};
    CHECK(read(reader, bytes, sizeof(bytes)) == 7);
    CHECK(std::string(bytes) == "through");
    close(reader);
  });
  CHECK(kindAt(fifo) == S_IFIFO);
}

TEST_CASE("writing to an open file of this process goes on where that file stands") {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "log";
  const int opened = open(path.c_str(), O_CREAT | O_RDWR, 0600);
  REQUIRE(write(opened, "before ", 7) == 7);
  requireWritable(std::filesystem::path("/dev/fd") / std::to_string(opened));
  writeFileAtomically(std::filesystem::path("/dev/fd") / std::to_string(opened),
                      std::string_view("written "));
  REQUIRE(write(opened, "after", 5) == 5);
  close(opened);
  CHECK(readFile(path) == "before written after");
}

TEST_CASE("writing to a symbolic link writes the file that it names, and the link stays") {
  const TemporaryDirectory directory;
  std::filesystem::create_directory(directory.path() / "other");
  const auto file = directory.write("other/file", "old");
  std::filesystem::create_symlink("other/file", directory.path() / "near");
  std::filesystem::create_symlink(directory.path() / "near", directory.path() / "far");
  writeFileAtomically(directory.path() / "far", std::string_view("new"));
  CHECK(readFile(file) == "new");
  CHECK(kindAt(directory.path() / "near") == S_IFLNK);
  CHECK(kindAt(directory.path() / "far") == S_IFLNK);

  std::filesystem::create_symlink("other/not yet", directory.path() / "dangling");
  requireWritable(directory.path() / "dangling");
  writeFileAtomically(directory.path() / "dangling", std::string_view("made"));
  CHECK(readFile(directory.path() / "other" / "not yet") == "made");
  CHECK(kindAt(directory.path() / "dangling") == S_IFLNK);

  std::filesystem::create_symlink("no such folder/file", directory.path() / "lost");
  CHECK_THROWS_MATCHES(writeFileAtomically(directory.path() / "lost", std::string_view("x")), Error,
                       Tells("lost"));
  CHECK_THROWS_AS(requireWritable(directory.path() / "lost"), Error);
  std::filesystem::create_symlink("circle", directory.path() / "circle");
  CHECK_THROWS_MATCHES(writeFileAtomically(directory.path() / "circle", std::string_view("x")), Error,
                       Tells("circle"));
}

TEST_CASE("a file that is replaced hands on who may read it") {
  const TemporaryDirectory directory;
  const auto file = directory.write("private", "old");
  REQUIRE(chmod(file.c_str(), 0600) == 0);
  writeFileAtomically(file, std::string_view("new"));
  struct stat status {};
  REQUIRE(stat(file.c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0600);
}

TEST_CASE("a written file is read back byte for byte and replaces the earlier one") {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "data.bin";
  std::string bytes;
  for (int i = 0; i < 300000; ++i) bytes += static_cast<char>(i * 131 >> 3);
  writeFileAtomically(path, bytes);
  REQUIRE(readFile(path) == bytes);
  writeFileAtomically(path, std::string_view("short"));
  REQUIRE(readFile(path) == "short");
  writeFileAtomically(path, std::string_view());
  REQUIRE(readFile(path).empty());
  REQUIRE(entriesIn(directory.path()) == 1);
}

TEST_CASE("a file that cannot be written is an error that names it, and leaves nothing behind") {
  const TemporaryDirectory directory;
  const auto missing = directory.path() / "missing" / "file.txt";
  REQUIRE_THROWS_MATCHES(writeFileAtomically(missing, std::string_view("x")), Error, Tells(missing.string()));
  REQUIRE_THROWS_AS(writeFileAtomically(directory.path(), std::string_view("x")), Error);
  REQUIRE(entriesIn(directory.path()) == 0);
}

TEST_CASE("a process killed while it writes leaves the old file or the new one") {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "result.txt";
  const std::string old(1 << 20, 'o'), fresh(1 << 20, 'n');
  for (int round = 0; round < 8; ++round) {
    writeFileAtomically(path, old);
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      for (;;) {
        try {
          writeFileAtomically(path, fresh);
        } catch (...) {
          _exit(1);
        }
      }
    }
    std::this_thread::sleep_for(std::chrono::microseconds(500 + 700 * round));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const std::string content = readFile(path);
    const bool whole = content == old || content == fresh;
    REQUIRE(whole);
  }
}

TEST_CASE("a missing file and a file over the limit are errors that name them") {
  const TemporaryDirectory directory;
  REQUIRE_THROWS_MATCHES(readFile(directory.path() / "none.txt"), Error, Tells("none.txt"));
  const auto path = directory.write("ten.txt", "0123456789");
  REQUIRE(readFile(path, 10) == "0123456789");
  REQUIRE_THROWS_MATCHES(readFile(path, 9), Error, Tells("ten.txt", "10 B", "9 B"));
}

TEST_CASE("a gzip file is unpacked, also when it has several members; another name is read as it is") {
  const TemporaryDirectory directory;
  std::string text;
  for (int i = 0; i < 200000; ++i) text += static_cast<char>('a' + i % 1009 * i % 26);
  REQUIRE(readFileMaybeGzip(directory.write("t.obj.gz", gzip(text)), kLargestTextFile) == text);
  REQUIRE(readFileMaybeGzip(directory.write("two.gz", gzip("first ") + gzip("second")), kLargestTextFile) ==
          "first second");
  REQUIRE(readFileMaybeGzip(directory.write("plain.obj", "v 0 0 0"), kLargestTextFile) == "v 0 0 0");
  REQUIRE(readFileMaybeGzip(directory.write("nothing.gz", gzip("")), kLargestTextFile).empty());
}

TEST_CASE("a gzip file that is cut, corrupt, empty or not one at all is an error that names it") {
  const TemporaryDirectory directory;
  const std::string whole = gzip("the text that was packed, long enough to have something to lose");
  const auto refuse = [&](const std::string& content) {
    const auto path = directory.write("bad.gz", content);
    REQUIRE_THROWS_MATCHES(readFileMaybeGzip(path, kLargestTextFile), Error, Tells("bad.gz"));
  };
  for (std::size_t size = 0; size < whole.size(); ++size) refuse(whole.substr(0, size));
  std::string corrupt = whole;
  corrupt[corrupt.size() - 6] = static_cast<char>(corrupt[corrupt.size() - 6] ^ 1);  // in the checksum
  refuse(corrupt);
  refuse("v 0 0 0\n");
}

TEST_CASE("a gzip file that unpacks beyond the limit is refused") {
  const TemporaryDirectory directory;
  const auto path = directory.write("bomb.gz", gzip(std::string(50'000'000, '0')));
  REQUIRE(std::filesystem::file_size(path) < 100'000);
  REQUIRE_THROWS_MATCHES(readFileMaybeGzip(path, 1'000'000), Error, Tells("bomb.gz", "too large"));
}

TEST_CASE("memory that this machine does not have is refused with what for, needed and available") {
  REQUIRE_NOTHROW(requireMemory(1000, "a small grid"));
  REQUIRE_THROWS_MATCHES(requireMemory(std::uint64_t{1} << 60, "the radiance grid"), Error,
                         Tells("the radiance grid", "1.0 EiB", "available"));
}

TEST_CASE("bytes are written with binary units") {
  CHECK(formatBytes(0) == "0 B");
  CHECK(formatBytes(1023) == "1023 B");
  CHECK(formatBytes(1536) == "1.5 KiB");
  CHECK(formatBytes(std::uint64_t{3} << 20) == "3.0 MiB");
  CHECK(formatBytes(~std::uint64_t{0}) == "16.0 EiB");
}

TEST_CASE("parent directories are made, and a file in their way is an error") {
  const TemporaryDirectory directory;
  createParentDirectories(directory.path() / "a" / "b" / "c.txt");
  REQUIRE(std::filesystem::is_directory(directory.path() / "a" / "b"));
  REQUIRE_NOTHROW(createParentDirectories("bare_name.txt"));
  const auto file = directory.write("file", "old");
  REQUIRE_THROWS_MATCHES(createParentDirectories(file / "x.txt"), Error, Tells("file"));
  // What may be written later is asked for without a trace but its folder.
  requireWritable(file);
  CHECK(readFile(file) == "old");
  requireWritable(directory.path() / "new/folder/page.html");
  CHECK(std::filesystem::is_directory(directory.path() / "new/folder"));
  CHECK_FALSE(std::filesystem::exists(directory.path() / "new/folder/page.html"));
  for (const std::filesystem::path& wrong : {directory.path(), file / "page.html", std::filesystem::path()})
    CHECK_THROWS_AS(requireWritable(wrong), Error);
}

TEST_CASE("the cache lies where the environment says, and a file there is refused as what it is") {
  const TemporaryDirectory directory;
  const auto wanted = directory.path() / "my" / "cache";
  setenv("LUMIVOX_CACHE", wanted.c_str(), 1);
  CHECK(cacheDirectory() == wanted);
  CHECK(std::filesystem::is_directory(wanted));
  setenv("LUMIVOX_CACHE", directory.write("file", "content").c_str(), 1);
  CHECK_THROWS_MATCHES(cacheDirectory(), Error, Tells("file", "regular file", "folder"));
}

TEST_CASE("without a home the cache is a folder of this user that nobody else may enter") {
  const TemporaryDirectory directory;
  for (const char* name : {"LUMIVOX_CACHE", "XDG_CACHE_HOME", "HOME"}) unsetenv(name);
  setenv("TMPDIR", directory.path().c_str(), 1);
  const auto modeOf = [](const std::filesystem::path& path) {
    struct stat status {};
    REQUIRE(stat(path.c_str(), &status) == 0);
    return status.st_mode & 0777;
  };
  const auto made = cacheDirectory();
  CHECK(made.parent_path() == directory.path());
  CHECK_THAT(made.filename().string(), Tells(std::to_string(geteuid())));
  CHECK(modeOf(made) == 0700);
  // Another user may have been quicker: with a folder that is open, a link, or a folder of their own.
  REQUIRE(chmod(made.c_str(), 0777) == 0);
  CHECK(modeOf(cacheDirectory()) == 0700);
  std::filesystem::remove(made);
  std::filesystem::create_directory(directory.path() / "trap");
  std::filesystem::create_directory_symlink(directory.path() / "trap", made);
  CHECK_THROWS_MATCHES(cacheDirectory(), Error, Tells("symbolic link"));
  std::filesystem::remove(made);
  std::filesystem::create_directory(made);
  if (chown(made.c_str(), 12345, 12345) == 0)
    CHECK_THROWS_MATCHES(cacheDirectory(), Error, Tells("belongs to another user", "LUMIVOX_CACHE"));
}

TEST_CASE("a name as long as a file system allows is written, and nothing stays beside it") {
  const TemporaryDirectory directory;
  const std::string longest = std::string(251, 'n') + ".csv";
  requireWritable(directory.path() / longest);
  writeFileAtomically(directory.path() / longest, "content");
  CHECK(readFile(directory.path() / longest) == "content");
  std::string umlauts = "x";
  while (umlauts.size() + 2 <= 255) umlauts += "\xC3\xA4";
  writeFileAtomically(directory.path() / umlauts, "content");
  CHECK(readFile(directory.path() / umlauts) == "content");
  CHECK(std::distance(std::filesystem::directory_iterator(directory.path()), {}) == 2);
  CHECK_THROWS_MATCHES(requireWritable(directory.path() / std::string(256, 'n')), Error,
                       Tells("cannot write"));
}

TEST_CASE("a folder in which no file can be made is refused before the work, whatever its permissions say") {
  for (const char* file : {"/proc/a.csv", "/proc/self/fdinfo/a.csv"}) {
    CAPTURE(file);
    CHECK_THROWS_MATCHES(requireWritable(file), Error, Tells("cannot write into"));
  }
}

TEST_CASE("a file that was read is known by every name that leads to it, one that was not by none") {
  const TemporaryDirectory directory;
  const auto read = directory.write("read.txt", "content"), unread = directory.write("unread.txt", "content");
  std::filesystem::create_symlink("read.txt", directory.path() / "link.txt");
  std::filesystem::create_hard_link(read, directory.path() / "hard.txt");
  CHECK_FALSE(wasRead(unread));
  readFile(read);
  for (const char* name : {"read.txt", "link.txt", "hard.txt"}) CHECK(wasRead(directory.path() / name));
  CHECK_FALSE(wasRead(unread));
  CHECK_FALSE(wasRead(directory.path() / "absent.txt"));
  writeFileAtomically(read, "of this process");
  CHECK_FALSE(wasRead(read));
}

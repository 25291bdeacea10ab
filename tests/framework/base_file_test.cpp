// Whole files: atomic writes, gzip, limits.
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Matchers::Contains;
using lumivox::test::messageOf;
using lumivox::test::TemporaryDirectory;

namespace {

std::string gzip(const std::string& text) {
  z_stream stream{};
  constexpr int kWindowBits = 15 + 16, kMemory = 8;
  REQUIRE(deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kWindowBits, kMemory, Z_DEFAULT_STRATEGY) ==
          Z_OK);
  std::string packed(deflateBound(&stream, text.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

std::size_t entriesIn(const std::filesystem::path& directory) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(directory), {}));
}

}  // namespace

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
  REQUIRE_THAT(messageOf<Error>([&] { writeFileAtomically(missing, std::string_view("x")); }),
               Contains(missing.string()));
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

TEST_CASE("a missing file, a directory and a file over the limit are errors that name them") {
  const TemporaryDirectory directory;
  REQUIRE_THAT(messageOf<Error>([&] { readFile(directory.path() / "none.txt"); }), Contains("none.txt"));
  REQUIRE_THAT(messageOf<Error>([&] { readFile(directory.path()); }), Contains(directory.path().string()));
  const auto path = directory.write("ten.txt", "0123456789");
  REQUIRE(readFile(path, 10) == "0123456789");
  REQUIRE_THAT(messageOf<Error>([&] { readFile(path, 9); }),
               Contains("ten.txt") && Contains("10 B") && Contains("9 B"));
}

TEST_CASE("a gzip file is unpacked, also when it has several members; another name is read as it is") {
  const TemporaryDirectory directory;
  std::string text;
  for (int i = 0; i < 200000; ++i) text += static_cast<char>('a' + i % 1009 * i % 26);
  REQUIRE(readFileMaybeGzip(directory.write("t.obj.gz", gzip(text))) == text);
  REQUIRE(readFileMaybeGzip(directory.write("two.gz", gzip("first ") + gzip("second"))) == "first second");
  REQUIRE(readFileMaybeGzip(directory.write("plain.obj", "v 0 0 0")) == "v 0 0 0");
  REQUIRE(readFileMaybeGzip(directory.write("nothing.gz", gzip(""))).empty());
}

TEST_CASE("a gzip file that is cut, corrupt, empty or not one at all is an error that names it") {
  const TemporaryDirectory directory;
  const std::string whole = gzip("the text that was packed, long enough to have something to lose");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto path = directory.write("cut.gz", whole.substr(0, size));
    REQUIRE_THAT(messageOf<Error>([&] { readFileMaybeGzip(path); }), Contains("cut.gz"));
  }
  std::string corrupt = whole;
  corrupt[corrupt.size() - 6] = static_cast<char>(corrupt[corrupt.size() - 6] ^ 1);  // in the checksum
  const auto path = directory.write("corrupt.gz", corrupt);
  REQUIRE_THAT(messageOf<Error>([&] { readFileMaybeGzip(path); }), Contains("corrupt"));
  const auto text = directory.write("text.gz", "v 0 0 0\n");
  REQUIRE_THAT(messageOf<Error>([&] { readFileMaybeGzip(text); }), Contains("text.gz"));
}

TEST_CASE("a gzip file that unpacks beyond the limit is refused") {
  const TemporaryDirectory directory;
  const auto path = directory.write("bomb.gz", gzip(std::string(50'000'000, '0')));
  REQUIRE(std::filesystem::file_size(path) < 100'000);
  REQUIRE_THAT(messageOf<Error>([&] { readFileMaybeGzip(path, 1'000'000); }),
               Contains("bomb.gz") && Contains("too large"));
}

TEST_CASE("memory that this machine does not have is refused with what for, needed and available") {
  REQUIRE_NOTHROW(requireMemory(1000, "a small grid"));
  REQUIRE_THAT(messageOf<Error>([] { requireMemory(std::uint64_t{1} << 60, "the radiance grid"); }),
               Contains("the radiance grid") && Contains("1.0 EiB") && Contains("available"));
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
  const auto file = directory.write("file", "");
  REQUIRE_THAT(messageOf<Error>([&] { createParentDirectories(file / "x.txt"); }), Contains("file"));
}

TEST_CASE("the cache lies where the environment says") {
  const TemporaryDirectory directory;
  const char* before = std::getenv("LUMIVOX_CACHE");
  const std::string kept = before != nullptr ? before : "";
  const auto wanted = directory.path() / "my" / "cache";
  setenv("LUMIVOX_CACHE", wanted.c_str(), 1);
  CHECK(cacheDirectory() == wanted);
  CHECK(std::filesystem::is_directory(wanted));
  if (before != nullptr) {
    setenv("LUMIVOX_CACHE", kept.c_str(), 1);
  } else {
    unsetenv("LUMIVOX_CACHE");
  }
}

// Files written beside the main thread: in order, few at a time, and no failure is lost.
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

#include "lumivox/base/background_writer.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("files are written in the order in which they were given, on another thread, all by the end") {
  std::vector<int> order;
  std::thread::id writing;
  BackgroundWriter writer;
  for (int i = 0; i < 50; ++i) {
    writer.submit([&, i] {
      order.push_back(i);
      writing = std::this_thread::get_id();
    });
  }
  writer.finish();
  REQUIRE(order.size() == 50);
  for (int i = 0; i < 50; ++i) CHECK(order[static_cast<std::size_t>(i)] == i);
  CHECK(writing != std::this_thread::get_id());
  writer.submit([&] { order.push_back(50); });
  writer.finish();
  CHECK(order.back() == 50);
}

TEST_CASE("giving a file does not wait for its writing, and few wait at a time") {
  std::mutex gate;
  std::atomic<int> begun{0}, given{0};
  BackgroundWriter writer;
  std::unique_lock closed(gate);
  const auto slow = [&] {
    ++begun;
    const std::lock_guard pass(gate);
  };
  writer.submit(slow);  // returns while the writing of it stands still
  writer.submit(slow);
  std::thread more([&] {
    for (int i = 0; i < 8; ++i) {
      writer.submit(slow);
      ++given;
    }
  });
  while (begun == 0) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  CHECK(begun == 1);
  CHECK(given <= 1);  // beside the one that is written and the one that waits
  closed.unlock();
  more.join();
  writer.finish();
  CHECK(begun == 10);
}

TEST_CASE("a failure is thrown at the next file or at the end, and ends the writing") {
  const TemporaryDirectory directory;
  const auto bad = directory.path() / "no folder" / "two.txt";
  const auto write = [](const std::filesystem::path& file) {
    return [file] { writeFileAtomically(file, std::string_view("content")); };
  };
  BackgroundWriter writer;
  writer.submit(write(directory.path() / "one.txt"));
  std::string message;
  try {
    writer.submit(write(bad));
    for (int i = 0; i < 20; ++i) writer.submit(write(directory.path() / ("later" + std::to_string(i))));
    writer.finish();
  } catch (const Error& error) {
    message = error.what();
  }
  CHECK_THAT(message, Tells("two.txt"));
  CHECK(readFile(directory.path() / "one.txt") == "content");
  CHECK_FALSE(std::filesystem::exists(directory.path() / "later19"));
  CHECK_NOTHROW(writer.finish());  // told once
}

TEST_CASE("a writer that goes writes what it was given, and logs a failure that nobody asked for") {
  const TemporaryDirectory directory;
  {
    BackgroundWriter writer;
    for (const char* name : {"a", "b", "c"})
      writer.submit([&, name] { writeFileAtomically(directory.path() / name, std::string_view(name)); });
  }
  CHECK(readFile(directory.path() / "c") == "c");
  const LogCapture log;
  {
    BackgroundWriter writer;
    writer.submit([] { throw Error("frame.png: cannot write"); });
  }
  CHECK_THAT(log.text(), Tells("frame.png"));
}

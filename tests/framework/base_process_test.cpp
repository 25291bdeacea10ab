// Processes that wait for each other while times are taken.
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "base/child.h"
#include "base/process.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/start_process.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

/// A process that holds the lock for a time, from its construction on.
class Holder {
 public:
  Holder(MachineLock::For purpose, std::chrono::milliseconds time) {
    int ready[2];
    REQUIRE(pipe(ready) == 0);
    process_ = fork();
    REQUIRE(process_ >= 0);
    if (process_ == 0) {
      const MachineLock lock(purpose);
      if (write(ready[1], "r", 1) != 1) _exit(1);
      usleep(static_cast<useconds_t>(std::chrono::microseconds(time).count()));
      _exit(0);
    }
    char answer = 0;
    REQUIRE(read(ready[0], &answer, 1) == 1);
    close(ready[0]);
    close(ready[1]);
  }
  ~Holder() { end(); }
  void end() {
    if (process_ <= 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = -1;
  }
  int process() const { return process_; }

 private:
  pid_t process_ = -1;
};

/// How long it takes to get the lock.
std::chrono::milliseconds waitFor(MachineLock::For purpose) {
  const auto start = Clock::now();
  const MachineLock lock(purpose);
  return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - start);
}

/// A cache of its own, so that nobody else on this machine is waited for.
struct OwnCache {
  TemporaryDirectory directory;
  OwnCache() { setenv("LUMIVOX_CACHE", directory.path().c_str(), 1); }
};

constexpr auto kHeld = 700ms, kAtOnce = 500ms;

}  // namespace

TEST_CASE("whoever takes times is alone, and those who only work go on side by side") {
  const OwnCache cache;
  {
    const Holder works(MachineLock::For::work, 60s);
    CHECK(waitFor(MachineLock::For::work) < kAtOnce);
  }
  {
    const Holder works(MachineLock::For::work, kHeld);
    CHECK(waitFor(MachineLock::For::timing) > kHeld / 2);
  }
  for (const auto purpose : {MachineLock::For::work, MachineLock::For::timing}) {
    const Holder times(MachineLock::For::timing, kHeld);
    CHECK(waitFor(purpose) > kHeld / 2);
  }
  CHECK(waitFor(MachineLock::For::timing) < kAtOnce);
}

TEST_CASE("a lock ends with its process, however that ends, and names it until then") {
  const OwnCache cache;
  Holder times(MachineLock::For::timing, 60s);
  if (!MachineLock::holders().empty()) {  // a system may hide it
    CHECK(MachineLock::holders() == std::vector<int>{times.process()});
    CHECK_THAT(commandOf(times.process()), Tells("base_tests"));
  }
  times.end();
  CHECK(waitFor(MachineLock::For::timing) < kAtOnce);
  CHECK(MachineLock::holders().empty());
}

TEST_CASE("whoever waits is told for whom in one line of the terminal, and not again for the same process") {
  const OwnCache cache;
  setenv("COLUMNS", "70", 1);
  const std::string command = "lumivox report " + std::string(800, 'x');
  CHECK(processText(7, "") == "process 7");
  CHECK(processText(7, "lumivox\nlist") == "process 7 (lumivox list)");
  CHECK(("waiting for " + processText(7, command, 12)).size() == 70);
  CHECK(processText(7, command, 12).find("process 7 (lumivox report xxx") == 0);
  Holder times(MachineLock::For::timing, 60s);
  if (!MachineLock::holders().empty()) {  // a system may hide it
    // Processes that wait twice: each time as long as it takes until the holder is told.
    const std::string told = cache.directory.path() / "told.txt";
    const auto waits = [&] {
      const pid_t waiting = fork();
      if (waiting != 0) return waiting;
      dup2(open(told.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600), 2);
      std::thread([] { const MachineLock lock(MachineLock::For::work); }).detach();
      std::this_thread::sleep_for(1s);
      std::thread([] { const MachineLock lock(MachineLock::For::work); }).detach();
      std::this_thread::sleep_for(1s);
      _exit(0);
    };
    waitpid(waits(), nullptr, 0);
    const std::string line = readFile(told);
    CHECK(line.find("waiting for process " + std::to_string(times.process()) + " (") == 0);
    CHECK(std::count(line.begin(), line.end(), '\n') == 1);
  }
}

TEST_CASE("where no file can be locked nobody is waited for") {
  const OwnCache cache;
  const auto file = cache.directory.write("file", "no folder");
  setenv("LUMIVOX_CACHE", (file / "cache").c_str(), 1);
  CHECK(waitFor(MachineLock::For::timing) < kAtOnce);
}

TEST_CASE("a process is told by its number and its start, and one that has ended has none") {
  const std::uint64_t own = startOf(static_cast<int>(getpid()));
  CHECK(own > 0);
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0)
    for (;;) pause();
  CHECK(startOf(static_cast<int>(child)) >= own);
  kill(child, SIGKILL);
  // Ended, but not yet waited for.
  siginfo_t information{};
  REQUIRE(waitid(P_PID, static_cast<id_t>(child), &information, WEXITED | WNOWAIT) == 0);
  CHECK(startOf(static_cast<int>(child)) == 0);
  waitpid(child, nullptr, 0);
  CHECK(startOf(static_cast<int>(child)) == 0);
  CHECK_FALSE(machineIdentity().empty());
}

TEST_CASE("a program that a thread started outlives the thread and ends with its process") {
  int numbers[2];
  REQUIRE(pipe(numbers) == 0);
  const pid_t parent = fork();
  REQUIRE(parent >= 0);
  if (parent == 0) {
    Child* child = nullptr;
    std::thread([&] { child = new Child({"/bin/sh", "-c", "echo $$; exec sleep 600"}, {}); }).join();
    const int number = std::stoi(child->receive(60.0).line);
    if (write(numbers[1], &number, sizeof(number)) != sizeof(number)) _exit(1);
    for (;;) pause();
  }
  int program = 0;
  REQUIRE(read(numbers[0], &program, sizeof(program)) == sizeof(program));
  close(numbers[0]);
  close(numbers[1]);
  std::this_thread::sleep_for(kAtOnce);  // the signal of a thread that ended would have come
  CHECK(startOf(program) > 0);
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  bool ended = false;
  for (int i = 0; i < 500 && !ended; ++i) {
    ended = startOf(program) == 0;
    if (!ended) std::this_thread::sleep_for(20ms);
  }
  CHECK(ended);
  if (!ended) kill(program, SIGKILL);
}

TEST_CASE("a program gets its words, environment and streams, and one that cannot be started is named") {
  Child shell({"/bin/sh", "-c", "read line; echo \"$line $GREETING\"; echo aside >&2; exit 3"},
              {"GREETING=hello"});
  shell.send("world:");
  CHECK(shell.receive(10.0).line == "world: hello");
  CHECK(shell.receive(10.0).state == Child::State::ended);
  CHECK(shell.ending() == "ended with exit code 3");
  CHECK(shell.lastWords() == "aside");
  CHECK_THROWS_MATCHES(startProcess({{"/no/such/program"}, {}}), Error,
                       Tells("/no/such/program", "No such file"));
  const TemporaryDirectory directory;
  const std::string text = directory.write("text", "no program").string();  // nobody may execute it
  CHECK_THROWS_MATCHES(startProcess({{text}, {}}), Error, Tells(text, "Permission denied"));
  // Standard streams that are closed here are none of its troubles.
  int status[2];
  REQUIRE(pipe(status) == 0);
  const pid_t bare = fork();
  REQUIRE(bare >= 0);
  if (bare == 0) {
    for (const int stream : {0, 1, 2}) close(stream);
    Child cat({"/bin/cat"}, {});
    cat.send("through");
    const char good = cat.receive(10.0).line == "through" ? 'y' : 'n';
    _exit(write(status[1], &good, 1) == 1 ? 0 : 1);
  }
  char good = 0;
  CHECK(read(status[0], &good, 1) == 1);
  CHECK(good == 'y');
  waitpid(bare, nullptr, 0);
  close(status[0]);
  close(status[1]);
}

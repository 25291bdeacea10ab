#include "base/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>
#include <utility>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

/// Files of /proc have no size to be read by.
std::string contentOf(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// A file that is locked while it is open.
class OpenFile {
 public:
  explicit OpenFile(const fs::path& file) {
    createParentDirectories(file);
    handle_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (handle_ < 0)
      throw Error(
          fmt::format("{}: cannot be opened as a lock file: {}", file.string(), std::strerror(errno)));
  }
  ~OpenFile() {
    if (handle_ >= 0) close(handle_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  bool tryLock(int kind) const {
    while (flock(handle_, kind | LOCK_NB) != 0)
      if (errno != EINTR) return false;
    return true;
  }
  void lock(int kind) const {
    while (flock(handle_, kind) != 0)
      if (errno != EINTR) throw Error(fmt::format("a lock file cannot be locked: {}", std::strerror(errno)));
  }
  int take() { return std::exchange(handle_, -1); }

 private:
  int handle_ = -1;
};

std::string holdersText() {
  std::string text;
  for (const int process : MachineLock::holders()) {
    if (process == getpid()) continue;
    const std::string command = commandOf(process);
    text += fmt::format("{}process {}{}", text.empty() ? "" : ", ", process,
                        command.empty() ? "" : " (" + command + ")");
  }
  return text.empty() ? "another process of this user" : text;
}

}  // namespace

std::string machineIdentity() {
  std::string boot = contentOf("/proc/sys/kernel/random/boot_id");
  boot.erase(std::remove(boot.begin(), boot.end(), '\n'), boot.end());
  std::error_code ignored;
  return boot + " " + fs::read_symlink("/proc/self/ns/pid", ignored).string();
}

std::uint64_t startOf(int process) {
  // proc(5): field 22, behind the name in brackets, which may hold anything.
  const std::string stat = contentOf(fmt::format("/proc/{}/stat", process));
  const std::size_t bracket = stat.rfind(')');
  if (bracket == std::string::npos) return 0;
  constexpr int kBetween = 18;  // fields 4 to 21
  std::istringstream fields(stat.substr(bracket + 1));
  std::string state, word;
  fields >> state;
  if (state == "Z" || state == "X") return 0;  // ended, and nobody has looked yet
  for (int i = 0; i < kBetween; ++i) fields >> word;
  std::uint64_t started = 0;
  fields >> started;
  return started;
}

std::string commandOf(int process) {
  std::string command = contentOf(fmt::format("/proc/{}/cmdline", process));
  while (!command.empty() && command.back() == '\0') command.pop_back();
  std::replace(command.begin(), command.end(), '\0', ' ');
  return command;
}

fs::path MachineLock::file() {
  return cacheDirectory() / "timing.lock";
}

std::vector<int> MachineLock::holders() {
  struct stat information {};
  std::vector<int> processes;
  if (stat(file().c_str(), &information) != 0) return processes;
  // proc(5), /proc/locks: "1: FLOCK  ADVISORY  WRITE 708 08:02:262239 0 EOF"; waiting ones have "->".
  std::istringstream lines(contentOf("/proc/locks"));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string number, kind, advisory, mode, place;
    int process = 0;
    words >> number >> kind >> advisory >> mode >> process >> place;
    if (!words || kind != "FLOCK" || process <= 0) continue;
    if (place.substr(place.rfind(':') + 1) == std::to_string(information.st_ino))
      processes.push_back(process);
  }
  return processes;
}

MachineLock::MachineLock(For purpose) {
  try {
    lock_ = lockedFor(purpose);
  } catch (const Error& error) {
    // Measuring is possible all the same.
    static std::atomic<bool> told = false;
    if (!told.exchange(true))
      logWarning("not waiting for other processes, which may disturb the times: {}", error.what());
  }
}

int MachineLock::lockedFor(For purpose) {
  // Everybody passes the gate; who wants to take times keeps it shut until those who work are through, so
  // that they do not come in one after the other for ever.
  const OpenFile gate(fs::path(file()) += ".gate");
  OpenFile lock(file());
  bool told = false;
  const auto take = [&](const OpenFile& one, int kind) {
    constexpr int kTries = 25;
    constexpr std::chrono::milliseconds kPause{20};
    for (int i = 0; i < kTries; ++i) {
      if (one.tryLock(kind)) return;
      std::this_thread::sleep_for(kPause);
    }
    if (!std::exchange(told, true))
      logInformation(
          "waiting for {}{}", holdersText(),
          purpose == For::timing ? ", whose work would disturb the times" : ", which is taking times");
    one.lock(kind);
  };
  take(gate, LOCK_EX);
  take(lock, purpose == For::timing ? LOCK_EX : LOCK_SH);
  return lock.take();
}

MachineLock::~MachineLock() {
  if (lock_ >= 0) close(lock_);
}

// ---- interruptions
// ------------------------------------------------------------------------------------------------

namespace {

constexpr int kInterruptions[] = {SIGINT, SIGTERM, SIGHUP};

std::atomic<const std::string*> lastWord{nullptr};
static_assert(std::atomic<const std::string*>::is_always_lock_free);

/// Texts that were said. None is freed, since a signal may be reading it.
std::deque<std::string> wordsSaid;
int notes = 0;

/// Calls only what may be called from a signal handler.
void endWithWord(int signal) {
  if (const std::string* word = lastWord.load()) [[maybe_unused]]
    const ssize_t written = write(STDERR_FILENO, word->data(), word->size());
  std::signal(signal, SIG_DFL);
  raise(signal);
}

void replaceHandler(int signal, void (*from)(int), void (*to)(int)) {
  struct sigaction current {};
  sigaction(signal, nullptr, &current);
  // Who was started to ignore it goes on ignoring it.
  if (current.sa_handler == from) std::signal(signal, to);
}

}  // namespace

InterruptionNote::InterruptionNote() {
  if (notes++ > 0) return;
  for (const int signal : kInterruptions) replaceHandler(signal, SIG_DFL, endWithWord);
}

InterruptionNote::~InterruptionNote() {
  if (--notes > 0) return;
  for (const int signal : kInterruptions) replaceHandler(signal, endWithWord, SIG_DFL);
  lastWord = nullptr;
}

void InterruptionNote::say(const std::string& text) {
  // A line of its own, since "^C" or a progress bar may stand in this one.
  wordsSaid.push_back("\n" + text + "\n");
  lastWord = &wordsSaid.back();
}

}  // namespace lumivox

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
#include <cstring>
#include <fstream>
#include <iterator>
#include <mutex>
#include <sstream>
#include <thread>
#include <utility>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/base/terminal.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

/// Files of /proc state no size.
std::string contentOf(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// Opens a file and locks it.
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

/// Reports the processes that hold the lock, unless they are those of the last report.
void tellHolders(const std::string& why) {
  static std::mutex mutex;
  static std::vector<int> told;
  std::vector<int> processes = MachineLock::holders();
  processes.erase(std::remove(processes.begin(), processes.end(), static_cast<int>(getpid())),
                  processes.end());
  std::sort(processes.begin(), processes.end());
  const std::lock_guard guard(mutex);
  if (!processes.empty() && processes == told) return;
  told = processes;
  const std::string before = "waiting for ";
  if (processes.empty()) return logInformation("{}another process of this user{}", before, why);
  const std::string more = processes.size() > 1 ? fmt::format(" and {} more", processes.size() - 1) : "";
  const std::size_t others = shownWidth(before + more + why);
  logInformation("{}{}{}{}", before, processText(processes[0], commandOf(processes[0]), others), more, why);
}

}  // namespace

std::string machineIdentity() {
  std::string boot = contentOf("/proc/sys/kernel/random/boot_id");
  boot.erase(std::remove(boot.begin(), boot.end(), '\n'), boot.end());
  std::error_code ignored;
  return boot + " " + fs::read_symlink("/proc/self/ns/pid", ignored).string();
}

std::uint64_t startOf(int process) {
  // proc(5): field 22. The name in brackets before it may contain anything.
  const std::string stat = contentOf(fmt::format("/proc/{}/stat", process));
  const std::size_t bracket = stat.rfind(')');
  if (bracket == std::string::npos) return 0;
  constexpr int kBetween = 18;  // fields 4 to 21
  std::istringstream fields(stat.substr(bracket + 1));
  std::string state, word;
  fields >> state;
  if (state == "Z" || state == "X") return 0;  // ended, and not yet reaped
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

std::string processText(int process, const std::string& command, std::size_t before) {
  std::string text = fmt::format("process {}", process);
  if (command.empty()) return text;
  constexpr std::size_t kLeast = 20;  // least columns that identify a command
  const std::size_t taken = before + text.size() + 3;
  const auto columns = static_cast<std::size_t>(terminalColumns(STDERR_FILENO));
  // Line breaks in a command would break the message.
  std::string line = command;
  std::replace(line.begin(), line.end(), '\n', ' ');
  return text + " (" + cutTo(line, columns > taken + kLeast ? columns - taken : kLeast) + ")";
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
    // Measuring works without a lock, too.
    static std::atomic<bool> told = false;
    if (!told.exchange(true))
      logWarning("not waiting for other processes, which may disturb the times: {}", error.what());
  }
}

int MachineLock::lockedFor(For purpose) {
  // All processes pass the gate. A process that waits to take times holds it closed until those at work have
  // finished, so that new ones cannot keep it waiting for ever.
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
      tellHolders(purpose == For::timing ? ", whose work would disturb the times"
                                         : ", which is taking times");
    one.lock(kind);
  };
  take(gate, LOCK_EX);
  take(lock, purpose == For::timing ? LOCK_EX : LOCK_SH);
  return lock.take();
}

MachineLock::~MachineLock() {
  if (lock_ >= 0) close(lock_);
}

}  // namespace lumivox

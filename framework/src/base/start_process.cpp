#include "lumivox/base/start_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstring>
#include <future>
#include <mutex>
#include <optional>
#include <thread>

#include "lumivox/base/error.h"

extern char** environ;

namespace lumivox {
namespace {

std::vector<char*> pointersTo(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::vector<std::string> environmentWith(const std::vector<std::string>& settings) {
  std::vector<std::string> all = settings;
  for (char** one = environ; *one != nullptr; ++one) {
    const std::string name = std::string(*one).substr(0, std::strcspn(*one, "=")) + "=";
    if (std::none_of(settings.begin(), settings.end(),
                     [&](const std::string& setting) { return setting.rfind(name, 0) == 0; }))
      all.emplace_back(*one);
  }
  return all;
}

/// Everything that a child needs between fork() and exec(): there it must not allocate or lock.
struct Prepared {
  std::vector<std::string> words, variables;
  std::vector<char*> arguments, environment;
  std::array<int, 3> streams{};  ///< standard input, output, errors
  bool ownGroup = false;
  sigset_t signals{};  ///< signals blocked in the calling thread
  pid_t parent = -1;
  int failure = -1;  ///< pipe that receives errno; exec() closes it
};

[[noreturn]] void becomeProgram(const Prepared& program) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // If the parent ended before this call, its death signal never comes.
  if (getppid() != program.parent) _exit(1);
  if (program.ownGroup) setpgid(0, 0);
  // Moves descriptors away from the numbers 0 to 2.
  constexpr int kFirstOther = 3;
  std::array<int, 3> streams{};
  bool good = true;
  for (std::size_t i = 0; i < streams.size(); ++i)
    good = good && (streams[i] = fcntl(program.streams[i], F_DUPFD_CLOEXEC, kFirstOther)) >= 0;
  for (std::size_t i = 0; i < streams.size(); ++i) good = good && dup2(streams[i], static_cast<int>(i)) >= 0;
  if (good) {
    sigprocmask(SIG_SETMASK, &program.signals, nullptr);
    execve(program.arguments[0], program.arguments.data(), program.environment.data());
  }
  const int reason = errno;
  [[maybe_unused]] const ssize_t written = write(program.failure, &reason, sizeof(reason));
  _exit(1);
}

/// 0, or errno of what failed.
int forked(Prepared& program, pid_t& process) {
  int failure[2];
  if (pipe2(failure, O_CLOEXEC) != 0) return errno;
  program.failure = failure[1];
  program.parent = getpid();
  process = fork();
  if (process == 0) becomeProgram(program);
  int reason = process < 0 ? errno : 0;
  close(failure[1]);
  if (process > 0) {
    while (read(failure[0], &reason, sizeof(reason)) < 0 && errno == EINTR) {
    }
    if (reason != 0) waitpid(process, nullptr, 0);
  }
  close(failure[0]);
  return reason;
}

/// The thread that starts all programs. The death signal follows the thread that called fork(), so a thread
/// is needed that lives as long as the process.
class Starter {
 public:
  /// The starter of this process: a forked process has none of its parent's threads.
  static Starter& ofThisProcess() {
    static std::mutex mutex;
    static Starter* starter = nullptr;
    const std::lock_guard lock(mutex);
    if (starter == nullptr || starter->owner_ != getpid()) starter = new Starter;
    return *starter;
  }
  /// 0, or errno of what failed.
  int start(Prepared& program, pid_t& process) {
    const std::lock_guard turn(turns_);
    std::packaged_task<int()> task([&] { return forked(program, process); });
    std::future<int> result = task.get_future();
    {
      const std::lock_guard lock(mutex_);
      task_ = std::move(task);
    }
    news_.notify_one();
    return result.get();
  }

 private:
  Starter() {
    // The thread receives no signals of the process.
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    std::thread([this] { run(); }).detach();
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }
  [[noreturn]] void run() {
    for (;;) {
      std::unique_lock lock(mutex_);
      news_.wait(lock, [this] { return task_.has_value(); });
      std::packaged_task<int()> task = std::move(*task_);
      task_.reset();
      lock.unlock();
      task();
    }
  }

  const pid_t owner_ = getpid();
  std::mutex turns_, mutex_;
  std::condition_variable news_;
  std::optional<std::packaged_task<int()>> task_;
};

}  // namespace

pid_t startProcess(const ProcessStart& start) {
  Prepared program;
  program.words = start.words;
  program.variables = environmentWith(start.environment);
  program.arguments = pointersTo(program.words);
  program.environment = pointersTo(program.variables);
  program.ownGroup = start.ownGroup;
  pthread_sigmask(SIG_SETMASK, nullptr, &program.signals);
  const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
  program.streams = {start.input, start.output, start.errors};
  for (int& stream : program.streams)
    if (stream < 0) stream = nowhere;
  pid_t process = -1;
  const int failure = Starter::ofThisProcess().start(program, process);
  if (nowhere >= 0) close(nowhere);
  if (failure != 0)
    throw Error(fmt::format("cannot start '{}': {}", start.words.at(0), std::strerror(failure)));
  return process;
}

}  // namespace lumivox

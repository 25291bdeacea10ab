// The command line in a process of its own, for tests that interrupt it or run it twice at once.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "support/support.h"

namespace lumivox::test {

/// A command in a process of its own that can be sent a signal. What it says on standard error goes to a file
/// where one is named.
class Started {
 public:
  explicit Started(std::vector<std::string> arguments, const std::string& errors = {}) {
    const std::string program = (binaryDirectory() / "bin/lumivox").string();
    pid_ = fork();
    if (pid_ != 0) return;
    const int nowhere = open("/dev/null", O_RDWR);
    for (const int descriptor : {0, 1, 2}) dup2(nowhere, descriptor);
    if (!errors.empty()) dup2(open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 2);
    std::vector<char*> pointers{const_cast<char*>(program.c_str())};
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    execv(program.c_str(), pointers.data());
    _exit(127);
  }
  ~Started() {
    if (!ended_) {
      kill(pid_, SIGKILL);
      wait();
    }
  }
  void signalAfter(std::chrono::milliseconds delay, int signal) {
    std::this_thread::sleep_for(delay);
    kill(pid_, signal);
  }
  /// The status as waitpid gives it.
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    ended_ = true;
    return status;
  }

 private:
  pid_t pid_ = -1;
  bool ended_ = false;
};

/// Waits until something holds, at most a minute, which is far more than any step of a test takes.
template <class Condition>
bool becomes(const Condition& condition) {
  for (int i = 0; i < 600; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return false;
}

}  // namespace lumivox::test

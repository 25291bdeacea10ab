#include "viewer/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <utility>

#include "lumivox/base/error.h"
#include "lumivox/base/installation.h"
#include "lumivox/base/start_process.h"

namespace lumivox::viewer {

ProgramResult runProgram(const std::vector<std::string>& words, const std::atomic<bool>* stop) {
  int messages[2];
  if (pipe2(messages, O_CLOEXEC) != 0)
    throw Error(fmt::format("{}: {}", words.front(), std::strerror(errno)));
  pid_t process = -1;
  try {
    process = startProcess({words, {}, -1, -1, messages[1]});
  } catch (const Error&) {
    close(messages[0]);
    close(messages[1]);
    throw;
  }
  close(messages[1]);
  ProgramResult result;
  std::array<char, 4096> buffer;
  bool stopped = false;
  for (;;) {
    if (stop != nullptr && *stop && !std::exchange(stopped, true)) kill(process, SIGTERM);
    pollfd waits{messages[0], POLLIN, 0};
    constexpr int kLookMs = 100;
    if (stop != nullptr && poll(&waits, 1, kLookMs) == 0) continue;
    const ssize_t count = read(messages[0], buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    result.errors.append(buffer.data(), static_cast<std::size_t>(count));
  }
  close(messages[0]);
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

std::filesystem::path programBeside(const std::string& name) {
  const auto here = programFile();
  std::error_code ignored;
  if (here) {
    const std::filesystem::path file = here->parent_path() / name;
    if (std::filesystem::is_regular_file(file, ignored)) return file;
  }
  throw AbsentError(fmt::format("the program {} is not beside {}", name, here ? here->string() : "this one"));
}

}  // namespace lumivox::viewer

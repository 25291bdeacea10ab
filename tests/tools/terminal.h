// A command in a terminal of its own, to see what a person sees.
#pragma once

#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "lumivox/base/terminal.h"
#include "support/support.h"

namespace lumivox::test {

struct TerminalResult {
  int exitCode = 0;
  std::string written;  ///< everything, with its control sequences
};

/// Runs a shell command in a pseudo-terminal that is so wide; `lumivox` in it is the built program.
inline TerminalResult runInTerminal(const std::string& command, int columns) {
  const winsize size{24, static_cast<unsigned short>(columns), 0, 0};
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  if (child == 0) {
    unsetenv("COLUMNS");
    setenv("TERM", "xterm", 1);
    setenv("PATH", ((binaryDirectory() / "bin").string() + ":" + std::getenv("PATH")).c_str(), 1);
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  TerminalResult result;
  char buffer[4096];
  for (ssize_t count = 0; (count = read(terminal, buffer, sizeof buffer)) > 0;)
    result.written.append(buffer, static_cast<std::size_t>(count));
  close(terminal);
  int status = 0;
  waitpid(child, &status, 0);
  result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace lumivox::test

// Started programs end with this process, even when it is killed.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace lumivox {

struct ProcessStart {
  std::vector<std::string> words;            ///< program and arguments; found without a search path
  std::vector<std::string> environment;      ///< "NAME=value", over that of this process
  int input = -1, output = -1, errors = -1;  ///< descriptors that it gets as standard streams; -1: /dev/null
  bool ownGroup = false;                     ///< a process group of its own, with its number
};

/// Its number, for waitpid. The kernel kills it with SIGKILL when this process ends, but not what it starts
/// in its turn. Thread-safe; the calling thread may end before the program. Error naming the program when it
/// cannot be started.
pid_t startProcess(const ProcessStart& start);

}  // namespace lumivox

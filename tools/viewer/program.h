// Other programs of Lumivox, run to their end.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace lumivox::viewer {

struct ProgramResult {
  int exitCode = -1;   ///< 128 and the signal's number of one that a signal ended
  std::string errors;  ///< what it wrote to standard error
};

/// Runs the words as a command line, without a shell, and ends it early when `stop` becomes true. Error when
/// it cannot be started.
ProgramResult runProgram(const std::vector<std::string>& words, const std::atomic<bool>* stop = nullptr);

/// The file of a program that lies beside this one; AbsentError that names it otherwise.
std::filesystem::path programBeside(const std::string& name);

}  // namespace lumivox::viewer

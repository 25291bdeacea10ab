// Other programs of Lumivox, run to their end.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace lumivox::viewer {

struct ProgramResult {
  int exitCode = -1;   ///< 128 plus the signal's number if a signal ended it
  std::string errors;  ///< its standard error
};

/// Runs a command line without a shell, and ends it early once `stop` becomes true. Error if it cannot be
/// started.
ProgramResult runProgram(const std::vector<std::string>& words, const std::atomic<bool>* stop = nullptr);

/// The file of a program beside this one. AbsentError, naming the program, if it is not there.
std::filesystem::path programBeside(const std::string& name);

}  // namespace lumivox::viewer

// Identifies processes of one machine, and lets one run alone while it takes times.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lumivox {

/// Identifies the boot and the process namespace: process numbers of others mean nothing here.
std::string machineIdentity();
/// Start time of a process in clock ticks since boot; 0 if there is none or it has ended.
std::uint64_t startOf(int process);
/// Command line of a process; empty if there is none, or it belongs to another user.
std::string commandOf(int process);
/// Describes a process: "process 708 (lumivox report ..)". The command is cut so that it fits into a terminal
/// line behind `before` columns.
std::string processText(int process, const std::string& command, std::size_t before = 0);

/// A lock among the processes of this user on this machine. Several processes may work at once; while one
/// takes times, no other works. A waiting process reports for whom it waits. Locks end with their process. If
/// no file can be locked, that is reported once and nobody waits.
class MachineLock {
 public:
  enum class For { work, timing };
  explicit MachineLock(For purpose);
  ~MachineLock();
  MachineLock(const MachineLock&) = delete;
  MachineLock& operator=(const MachineLock&) = delete;

  /// The lock file, in a folder of the user.
  static std::filesystem::path file();
  /// Processes that hold the lock now, if the system tells.
  static std::vector<int> holders();

 private:
  static int lockedFor(For purpose);
  int lock_ = -1;
};

}  // namespace lumivox

// Processes told apart on one machine, and one at a time while times are taken.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lumivox {

/// Start of the machine and name space of process numbers: on another one a number means nothing here.
std::string machineIdentity();
/// When a process was started, in clock ticks since the machine was; 0: there is none, or it has ended.
std::uint64_t startOf(int process);
/// Its command line; empty: there is none, or it is none of ours.
std::string commandOf(int process);
/// What is said of a process that is waited for: "process 708 (lumivox report ..)", the command cut so that
/// the terminal shows it in a line behind `before` columns.
std::string processText(int process, const std::string& command, std::size_t before = 0);

/// Holds back other processes of this user on this machine. Work that keeps the processors or the device busy
/// goes on in several processes at once; while one takes times, no other works. Whoever must wait says for
/// whom. Locks end with their process. Where no file can be locked, that is told once and nobody is waited
/// for.
class MachineLock {
 public:
  enum class For { work, timing };
  explicit MachineLock(For purpose);
  ~MachineLock();
  MachineLock(const MachineLock&) = delete;
  MachineLock& operator=(const MachineLock&) = delete;

  /// The file that is locked, in a folder of the user's own.
  static std::filesystem::path file();
  /// Processes that hold a lock on it now, as far as this system tells.
  static std::vector<int> holders();

 private:
  static int lockedFor(For purpose);
  int lock_ = -1;
};

}  // namespace lumivox

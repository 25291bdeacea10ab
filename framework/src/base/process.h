// Processes told apart on one machine, one at a time while times are taken, and what they say when they are
// interrupted.
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

/// While it lives, SIGINT (Ctrl-C), SIGTERM and SIGHUP end the process as ever, but with a word on stderr
/// about what is kept. Of several the last to speak is heard.
class InterruptionNote {
 public:
  InterruptionNote();
  ~InterruptionNote();
  InterruptionNote(const InterruptionNote&) = delete;
  InterruptionNote& operator=(const InterruptionNote&) = delete;
  void say(const std::string& text);
};

}  // namespace lumivox

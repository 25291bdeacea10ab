// A child process that reads requests from standard input and answers line by line. It ends with this process
// (lumivox/base/start_process.h).
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lumivox {

class Child {
 public:
  /// Starts a command line; its first word is a path, not searched for. `environment`: "NAME=value" entries
  /// that override the present ones. Error if it cannot be started.
  Child(const std::vector<std::string>& words, const std::vector<std::string>& environment);
  ~Child();  ///< kills it and everything that it started
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Writing to a dead child is no error: receive() finds out.
  void send(const std::string& line);
  /// Writes to its standard input and waits until it has read. False if it no longer reads.
  bool write(std::span<const std::byte> bytes);
  /// Closes its standard input.
  void closeInput();

  enum class State { answered, ended, silent };
  struct Answer {
    State state = State::silent;
    std::string line;
  };
  /// Waits for a line, at most `seconds`.
  Answer receive(double seconds);
  /// After `ended`: "killed by signal 6 (Aborted)", "ended with exit code 3".
  std::string ending();
  /// After `ended`: whether it ended by itself with exit code 0.
  bool succeeded();
  /// The last lines that it wrote to standard error.
  std::string lastWords() const;
  /// Drops the kept standard error.
  void forgetWords() { errors_.clear(); }

 private:
  void read(int file, std::string& into, bool& open);
  void readMessages();
  void waitForEnd();
  pid_t process_ = -1;
  int requests_ = -1, answers_ = -1, messages_ = -1;
  bool answersOpen_ = true, messagesOpen_ = true;
  std::string pending_, errors_;
  std::optional<int> status_;
};

/// The first executable of this name in the folders of PATH. AbsentError: "NAME, PURPOSE, is not on the PATH;
/// install it (Debian: apt-get install PACKAGE), or OTHERWISE".
std::filesystem::path programOnPath(const std::string& name, const std::string& purpose,
                                    const std::string& package, const std::string& otherwise);

}  // namespace lumivox

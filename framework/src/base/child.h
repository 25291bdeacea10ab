// A process of its own that is fed through its standard input and answers line by line. It ends with this one
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
  /// Starts the words as a command line, found without a search path, with these "NAME=value" over the
  /// environment. Error when that fails.
  Child(const std::vector<std::string>& words, const std::vector<std::string>& environment);
  ~Child();  ///< kills it and everything that it started
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// A child that is gone does not answer; that is found out by receive().
  void send(const std::string& line);
  /// Bytes for its standard input; waits while it does not read them. False when it reads no more.
  bool write(std::span<const std::byte> bytes);
  /// The end of its standard input.
  void closeInput();

  enum class State { answered, ended, silent };
  struct Answer {
    State state = State::silent;
    std::string line;
  };
  /// Waits for a line at most so long, in s.
  Answer receive(double seconds);
  /// After `ended`: "killed by signal 6 (Aborted)", "ended with exit code 3".
  std::string ending();
  /// After `ended`: by itself, with exit code 0.
  bool succeeded();
  /// The last lines that it wrote to standard error.
  std::string lastWords() const;
  /// Standard error from here on.
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

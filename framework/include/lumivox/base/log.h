// Messages for the person at the terminal. They go to stderr, so that stdout holds results only.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace lumivox {

enum class LogLevel { quiet, warnings, information, details };

void setLogLevel(LogLevel level);
LogLevel logLevel();

void logMessage(LogLevel level, std::string_view text);

template <class... Args>
void logWarning(fmt::format_string<Args...> format, Args&&... args) {
  logMessage(LogLevel::warnings, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void logInformation(fmt::format_string<Args...> format, Args&&... args) {
  logMessage(LogLevel::information, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void logDetails(fmt::format_string<Args...> format, Args&&... args) {
  logMessage(LogLevel::details, fmt::format(format, std::forward<Args>(args)...));
}

/// Warnings logged so far in this process; `--strict` refuses to go on when there are any.
std::uint64_t warningCount();

/// Called with every message in place of stderr while it lives; for tests.
class LogCapture {
 public:
  LogCapture();
  ~LogCapture();
  LogCapture(const LogCapture&) = delete;
  LogCapture& operator=(const LogCapture&) = delete;
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// Repeated warnings are written once; this writes how often each was repeated. Called at the end of a
/// program.
void logRepeatedWarnings();

/// The progress of a command, on stderr. In a terminal: one line that fits it and stays below the messages.
/// Elsewhere: plain lines for the first step, then at intervals, and for the last step. Nothing when quiet.
/// Of several objects the one that advanced last is shown. Thread-safe.
class Progress {
 public:
  /// `unit`: the plural of what is counted, such as "points"; without one only the share is shown, and lines
  /// outside of a terminal come at intervals alone. `total` 0: not known yet.
  Progress(std::string what, std::uint64_t total, std::string unit = {});
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void advance(std::uint64_t steps = 1);
  /// `done` of `total` steps are there; the rest takes about `secondsLeft`, NaN: as the steps so far.
  /// `doing`: the latest or next of them.
  void show(std::uint64_t done, std::uint64_t total, double secondsLeft, const std::string& doing = {});

 private:
  struct State;
  State* state_;
};

/// Takes the line of progress off the terminal, before something else is written there. It returns with the
/// next step or message.
void clearProgressLine();

}  // namespace lumivox

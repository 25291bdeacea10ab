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

/// A progress bar with the remaining time on stderr; silent when stderr is no terminal (then one line at the
/// end) or when quiet. Thread-safe.
class Progress {
 public:
  Progress(std::string what, std::uint64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void advance(std::uint64_t steps = 1);

 private:
  struct State;
  State* state_;
};

}  // namespace lumivox

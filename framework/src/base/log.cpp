#include "lumivox/base/log.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <set>

#include "lumivox/base/findings.h"

namespace lumivox {
namespace {

std::atomic<LogLevel> currentLevel{LogLevel::information};
std::atomic<std::uint64_t> warnings{0};
std::mutex outputMutex;
std::string* captured = nullptr;
bool barOnScreen = false;
thread_local WarningCollector* collector = nullptr;

void clearBar() {
  if (barOnScreen) std::fputs("\r\x1b[K", stderr);
  barOnScreen = false;
}

/// Writes a line as it is; whoever calls holds `outputMutex`.
void writeLine(LogLevel level, const std::string& line) {
  if (captured != nullptr) {
    *captured += line;
    return;
  }
  if (level > currentLevel.load()) return;
  clearBar();
  std::fputs(line.c_str(), stderr);
}

std::string formatSeconds(double seconds) {
  if (seconds < 60) return fmt::format("{:.0f} s", seconds);
  return fmt::format("{:.0f} min {:02.0f} s", std::floor(seconds / 60), std::fmod(seconds, 60.0));
}

}  // namespace

void setLogLevel(LogLevel level) {
  currentLevel = level;
}
LogLevel logLevel() {
  return currentLevel;
}
std::uint64_t warningCount() {
  return warnings;
}

void logMessage(LogLevel level, std::string_view text) {
  if (level == LogLevel::warnings) {
    ++warnings;
    if (collector != nullptr) {
      Diagnostic finding;
      finding.severity = Diagnostic::Severity::warning;
      finding.what = text;
      return collector->add(std::move(finding));
    }
  }
  const std::lock_guard lock(outputMutex);
  writeLine(level, fmt::format("{}{}\n", level == LogLevel::warnings ? "warning: " : "", text));
}

void logFinding(const Diagnostic& finding) {
  ++warnings;
  if (collector != nullptr) return collector->add(finding);
  static std::set<std::string> told;
  const std::lock_guard lock(outputMutex);
  const std::string text = finding.text();
  if (captured == nullptr && !told.insert(text).second) return;
  writeLine(LogLevel::warnings, text + "\n");
}

WarningCollector::WarningCollector() : outer_(collector) {
  collector = this;
}

WarningCollector::~WarningCollector() {
  collector = outer_;
}

LogCapture::LogCapture() {
  const std::lock_guard lock(outputMutex);
  captured = &text_;
}

LogCapture::~LogCapture() {
  const std::lock_guard lock(outputMutex);
  captured = nullptr;
}

struct Progress::State {
  using Clock = std::chrono::steady_clock;
  std::string what;
  std::uint64_t total;
  std::atomic<std::uint64_t> done{0};
  Clock::time_point start = Clock::now();
  std::atomic<Clock::rep> lastShown{0};
  bool terminal = isatty(STDERR_FILENO) != 0;

  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start).count(); }

  void show() {
    const double share = total > 0 ? static_cast<double>(done) / static_cast<double>(total) : 1.0;
    const double remaining = share > 0 ? elapsed() * (1.0 - share) / share : 0.0;
    constexpr int kWidth = 30;
    const int filled = static_cast<int>(share * kWidth);
    const std::lock_guard lock(outputMutex);
    if (captured != nullptr) return;
    std::fprintf(stderr, "\r\x1b[K%s [%s%s] %3.0f %%, %s left", what.c_str(),
                 std::string(static_cast<std::size_t>(filled), '#').c_str(),
                 std::string(static_cast<std::size_t>(kWidth - filled), ' ').c_str(), share * 100,
                 formatSeconds(remaining).c_str());
    barOnScreen = true;
  }
};

Progress::Progress(std::string what, std::uint64_t total) : state_(new State{std::move(what), total}) {}

Progress::~Progress() {
  if (state_->terminal) {
    const std::lock_guard lock(outputMutex);
    clearBar();
  }
  logInformation("{}: {:.1f} s", state_->what, state_->elapsed());
  delete state_;
}

void Progress::advance(std::uint64_t steps) {
  state_->done += steps;
  if (!state_->terminal || currentLevel.load() < LogLevel::information) return;
  // At most ten updates a second; whoever gets the slot draws.
  const auto now = State::Clock::now().time_since_epoch().count();
  auto last = state_->lastShown.load();
  const auto period = State::Clock::duration(std::chrono::milliseconds(100)).count();
  if (now - last < period || !state_->lastShown.compare_exchange_strong(last, now)) return;
  state_->show();
}

}  // namespace lumivox

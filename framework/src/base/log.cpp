#include "lumivox/base/log.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

#include "lumivox/base/findings.h"
#include "lumivox/base/terminal.h"

namespace lumivox {
namespace {

std::atomic<LogLevel> currentLevel{LogLevel::information};
std::atomic<std::uint64_t> warnings{0};
std::mutex outputMutex;
std::string* captured = nullptr;
/// The status line below the messages; empty for none.
std::string statusLine;
bool statusOnScreen = false;
/// Warnings with their counts in order of first appearance, and the index of each.
std::vector<std::pair<std::string, std::uint64_t>> toldWarnings;
std::unordered_map<std::string, std::size_t> toldAt;
thread_local WarningCollector* collector = nullptr;

void clearStatus() {
  if (statusOnScreen) std::fputs("\r\x1b[K", stderr);
  statusOnScreen = false;
}

/// The last column stays free, since some terminals wrap there.
void drawStatus() {
  if (statusLine.empty()) return;
  clearStatus();
  std::fputs(cutTo(statusLine, static_cast<std::size_t>(terminalColumns(STDERR_FILENO) - 1)).c_str(), stderr);
  statusOnScreen = true;
}

/// Whether the warning is new.
bool isNews(const std::string& warning) {
  const auto [at, isNew] = toldAt.emplace(warning, toldWarnings.size());
  if (isNew)
    toldWarnings.emplace_back(warning, 1);
  else
    ++toldWarnings[at->second].second;
  return isNew;
}

void writeLine(std::string_view line) {
  clearStatus();
  std::fputs(fmt::format("{}\n", line).c_str(), stderr);
  drawStatus();
}

/// Writes a warning if it is new; `head` precedes its text.
void tell(const std::string& head, const std::string& text) {
  const std::lock_guard lock(outputMutex);
  if (captured != nullptr) {
    *captured += head + text + "\n";
  } else if (LogLevel::warnings <= currentLevel.load() && isNews(head + text)) {
    writeLine(painted(Paint::warning, head, takesColour(STDERR_FILENO) && !head.empty()) + text);
  }
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
    if (collector == nullptr) return tell("warning: ", std::string(text));
    Diagnostic finding;
    finding.severity = Diagnostic::Severity::warning;
    finding.what = text;
    return collector->add(std::move(finding));
  }
  const std::lock_guard lock(outputMutex);
  if (captured != nullptr)
    *captured += fmt::format("{}\n", text);
  else if (level <= currentLevel.load())
    writeLine(text);
}

void logFinding(const Diagnostic& finding) {
  ++warnings;
  if (collector != nullptr) return collector->add(finding);
  tell("", finding.text());
}

void logRepeatedWarnings() {
  const std::lock_guard lock(outputMutex);
  // Source lines were shown with the first occurrence.
  for (const auto& [text, times] : toldWarnings)
    if (times > 1) writeLine(fmt::format("{} ({} times)", text.substr(0, text.find('\n')), times));
  toldWarnings.clear();
  toldAt.clear();
}

void clearProgressLine() {
  const std::lock_guard lock(outputMutex);
  clearStatus();
  std::fflush(stderr);
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
  std::string what, unit;
  std::uint64_t total;
  std::atomic<std::uint64_t> done{0};
  Clock::time_point start = Clock::now();
  std::atomic<Clock::rep> lastShown{0};
  bool terminal = isatty(STDERR_FILENO) != 0, told = false, finished = false;

  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start).count(); }

  /// "rendering: 12 of 48 images, about 5 s left".
  std::string text(double secondsLeft) const { return text(what, secondsLeft); }

  /// With another label for the work, such as a shorter one.
  std::string text(const std::string& label, double secondsLeft) const {
    const double share = total > 0 ? static_cast<double>(done) / static_cast<double>(total) : 0.0;
    std::string line = unit.empty() ? fmt::format("{}: {:.0f} %", label, share * 100)
                       : total == 0 ? fmt::format("{}: {} {}", label, done.load(), unit)
                                    : fmt::format("{}: {} of {} {}", label, done.load(), total, unit);
    if (!std::isfinite(secondsLeft)) secondsLeft = share > 0.0 ? elapsed() * (1.0 - share) / share : -1.0;
    if (secondsLeft >= 0.0 && done < total) line += ", about " + durationText(secondsLeft) + " left";
    return line;
  }

  /// With a bar before it and the current item behind it, if there is room.
  std::string line(double secondsLeft, const std::string& doing) const {
    std::string line = text(secondsLeft);
    const auto columns = static_cast<std::size_t>(terminalColumns(STDERR_FILENO) - 1);
    // The remaining time matters more than the end of a long name.
    if (const std::size_t wide = shownWidth(line), named = shownWidth(what);
        wide > columns && named > wide - columns)
      line = text(cutTo(what, named - (wide - columns)), secondsLeft);
    constexpr std::size_t kLeastBar = 8, kMostBar = 30, kFrame = 3;  // "[", "] "
    const std::size_t used = shownWidth(line);
    if (total > 0 && used + kLeastBar + kFrame <= columns) {
      const std::size_t bar = std::min(kMostBar, columns - used - kFrame);
      const auto filled = static_cast<std::size_t>(
          static_cast<double>(bar) * std::min(1.0, static_cast<double>(done) / static_cast<double>(total)));
      line = "[" + std::string(filled, '#') + std::string(bar - filled, ' ') + "] " + line;
    }
    return doing.empty() ? line : cutTo(line + "; " + doing, columns);
  }

  /// Whether enough time has passed since the last line. Only the caller that gets true writes.
  bool isDue(std::chrono::milliseconds period) {
    const auto now = Clock::now().time_since_epoch().count();
    auto last = lastShown.load();
    return now - last >= Clock::duration(period).count() && lastShown.compare_exchange_strong(last, now);
  }

  void show(double secondsLeft, const std::string& doing) {
    const std::lock_guard lock(outputMutex);
    if (captured != nullptr) return;
    if (terminal) {
      statusLine = line(secondsLeft, doing);
      drawStatus();
    } else {
      writeLine(text(secondsLeft));
    }
    told = true;
  }

  /// Removes the status line and logs the total time.
  void finish() {
    if (std::exchange(finished, true)) return;
    {
      const std::lock_guard lock(outputMutex);
      if (terminal) clearStatus();
      if (terminal) statusLine.clear();
    }
    if (done > 0) logInformation("{}, {:.1f} s", unit.empty() ? what : text(-1.0), elapsed());
  }
};

namespace {

constexpr std::chrono::milliseconds kRedraw{100}, kInterval{10000};  // in a terminal; between plain lines

}  // namespace

Progress::Progress(std::string what, std::uint64_t total, std::string unit)
    : state_(new State{std::move(what), std::move(unit), total}) {
  if (!state_->terminal) state_->lastShown = State::Clock::now().time_since_epoch().count();
}

Progress::~Progress() {
  state_->finish();
  delete state_;
}

void Progress::advance(std::uint64_t steps) {
  state_->done += steps;
  if (currentLevel.load() < LogLevel::information) return;
  if (state_->isDue(state_->terminal ? kRedraw : kInterval))
    state_->show(std::numeric_limits<double>::quiet_NaN(), {});
}

void Progress::show(std::uint64_t done, std::uint64_t total, double secondsLeft, const std::string& doing) {
  state_->done = done;
  state_->total = total;
  if (currentLevel.load() < LogLevel::information) return;
  // Steps that take seconds each are all shown in a terminal.
  if (total > 0 && done >= total) return state_->finish();
  const bool due = state_->isDue(kInterval), first = !state_->told && done > 0;
  if (state_->terminal || due || first) state_->show(secondsLeft, doing);
}

}  // namespace lumivox

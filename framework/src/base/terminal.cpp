#include "lumivox/base/terminal.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>

namespace lumivox {
namespace {

constexpr int kLeastColumns = 20;

/// The position behind the current UTF-8 character or colour sequence.
std::size_t next(std::string_view text, std::size_t at) {
  if (text[at] == '\x1b') {
    const std::size_t end = text.find('m', at);
    return end == std::string_view::npos ? text.size() : end + 1;
  }
  for (++at; at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80;) ++at;
  return at;
}

}  // namespace

int terminalColumns(int descriptor) {
  if (const char* said = std::getenv("COLUMNS")) {
    int columns = 0;
    const char* end = said + std::strlen(said);
    const auto read = std::from_chars(said, end, columns);
    if (read.ec == std::errc() && read.ptr == end && columns > 0) return std::max(columns, kLeastColumns);
  }
  winsize size{};
  if (isatty(descriptor) != 0 && ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
    return std::max<int>(size.ws_col, kLeastColumns);
  return kUsualColumns;
}

bool takesColour(int descriptor) {
  const char *refused = std::getenv("NO_COLOR"), *terminal = std::getenv("TERM");
  return isatty(descriptor) != 0 && (refused == nullptr || *refused == '\0') &&
         (terminal == nullptr || std::strcmp(terminal, "dumb") != 0);
}

std::string painted(Paint paint, std::string_view text, bool colour) {
  if (!colour) return std::string(text);
  const char* code = paint == Paint::heading ? "1"
                     : paint == Paint::good  ? "32"
                     : paint == Paint::bad   ? "31"
                                             : "33";
  return fmt::format("\x1b[{}m{}\x1b[0m", code, text);
}

std::size_t shownWidth(std::string_view text) {
  std::size_t columns = 0;
  for (std::size_t at = 0; at < text.size(); at = next(text, at)) columns += text[at] != '\x1b';
  return columns;
}

std::string cutTo(std::string_view text, std::size_t columns) {
  if (shownWidth(text) <= columns) return std::string(text);
  std::size_t end = 0;
  for (std::size_t shown = 0; shown + 2 < columns; ++shown) end = next(text, end);
  return std::string(text.substr(0, end)) + "..";
}

std::string wrapped(std::string_view text, std::size_t columns, std::size_t indent) {
  std::string result, line;
  for (std::size_t at = text.find_first_not_of(' '); at != std::string_view::npos;) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string_view word = text.substr(at, end - at);
    if (!line.empty() && shownWidth(line) + 1 + shownWidth(word) > columns) {
      result += line + "\n";
      line.assign(indent, ' ');
      line += word;
    } else {
      line += line.empty() ? "" : " ";
      line += word;
    }
    at = text.find_first_not_of(' ', end);
  }
  return result + line;
}

std::string durationText(double seconds) {
  if (seconds < 90.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 5400.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

}  // namespace lumivox

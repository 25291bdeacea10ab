// A parsed text: values as written, lines, and findings.
#include "lumivox/dsl/document.h"

#include <algorithm>
#include <string>

#include "dsl/lexer.h"

namespace lumivox::dsl {
namespace {

/// Counts lines from 1; empty behind the last.
std::string lineOf(const std::string& source, const std::vector<std::size_t>& starts, int number) {
  if (number < 1 || static_cast<std::size_t>(number) > starts.size()) return {};
  const std::size_t start = starts[static_cast<std::size_t>(number) - 1];
  std::string line = source.substr(start, source.find('\n', start) - start);
  while (!line.empty() && line.back() == '\r') line.pop_back();
  return line;
}

}  // namespace

bool Value::isPlainWord() const {
  return kind == ValueKind::word && text.find_first_of("./*?") == std::string::npos;
}

std::string Value::written() const {
  switch (kind) {
    case ValueKind::number:
      return unit ? text + ' ' + unit->name : text;
    case ValueKind::word:
      return text;
    case ValueKind::parameter:
      return '$' + text;
    case ValueKind::text: {
      std::string result = "\"";
      for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += c;
      }
      return result + '"';
    }
    case ValueKind::list: {
      std::string result = "[";
      for (const Value& item : items) result += (result.size() > 1 ? " " : "") + item.written();
      return result + ']';
    }
    case ValueKind::range: {
      // A unit that both ends share is written once, behind the upper end.
      Value low = items.at(0);
      const Value& high = items.at(1);
      if (low.unit && high.unit && low.unit->name == high.unit->name) low.unit.reset();
      return low.written() + ".." + high.written();
    }
  }
  return {};
}

std::string Block::title() const {
  std::string result = word;
  for (const Value& value : header) result += ' ' + value.written();
  return result;
}

std::vector<std::size_t> lineStartsOf(const std::string& source) {
  std::vector<std::size_t> starts{0};
  for (std::size_t end = source.find('\n'); end != std::string::npos; end = source.find('\n', end + 1))
    starts.push_back(end + 1);
  return starts;
}

std::string Document::line(int number) const {
  return lineOf(source, lineStarts, number);
}

std::string Document::line(const SourcePlace& place) const {
  const auto included = includedSources.find(place.file);
  if (included == includedSources.end()) return line(place.line);
  return lineOf(included->second, includedLineStarts.at(place.file), place.line);
}

Diagnostic Document::finding(const SourcePlace& place, int length, std::string what, std::string expected,
                             std::string suggestion) const {
  // Longer lines are cut, since no terminal shows them.
  constexpr int kLongestShownLine = 240;
  Diagnostic result;
  result.place = place;
  result.what = std::move(what);
  result.expected = std::move(expected);
  result.suggestion = std::move(suggestion);
  result.length = std::max(1, length);
  if (place.line > 0 && place.column <= kLongestShownLine) {
    result.sourceLine = line(place).substr(0, kLongestShownLine);  // copied, so that no long line is kept
    result.length =
        std::clamp(static_cast<int>(result.sourceLine.size()) + 1 - place.column, 1, result.length);
  }
  return result;
}

}  // namespace lumivox::dsl

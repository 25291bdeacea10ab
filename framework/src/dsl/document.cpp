// A text as it was parsed: its values as they are written, its lines, and findings in it.
#include "lumivox/dsl/document.h"

#include <algorithm>
#include <string>

namespace lumivox::dsl {
namespace {

std::string lineOf(const std::string& source, int number) {
  std::size_t start = 0;
  for (int i = 1; i < number; ++i) {
    start = source.find('\n', start);
    if (start == std::string::npos) return {};
    ++start;
  }
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
      // A unit of both ends stands once, behind the upper end.
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

std::string Document::line(int number) const {
  return lineOf(source, number);
}

std::string Document::line(const SourcePlace& place) const {
  const auto included = includedSources.find(place.file);
  return lineOf(included != includedSources.end() ? included->second : source, place.line);
}

Diagnostic Document::finding(const SourcePlace& place, int length, std::string what, std::string expected,
                             std::string suggestion) const {
  // A line that no terminal could show helps nobody.
  constexpr int kLongestShownLine = 240;
  Diagnostic result;
  result.place = place;
  result.what = std::move(what);
  result.expected = std::move(expected);
  result.suggestion = std::move(suggestion);
  result.length = std::max(1, length);
  if (place.line > 0 && place.column <= kLongestShownLine) {
    result.sourceLine = line(place);
    if (result.sourceLine.size() > kLongestShownLine) result.sourceLine.resize(kLongestShownLine);
    result.length =
        std::clamp(static_cast<int>(result.sourceLine.size()) + 1 - place.column, 1, result.length);
  }
  return result;
}

}  // namespace lumivox::dsl

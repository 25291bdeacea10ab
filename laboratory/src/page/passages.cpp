#include "page/passages.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "lumivox/base/error.h"

namespace lumivox::page {
namespace {

constexpr std::string_view kOpeningEnd = " -->", kClosing = "<!-- end -->";

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

PassageRequest requestOf(const std::string& text) {
  PassageRequest request;
  std::vector<std::string> parts;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(';', from), text.size());
    parts.push_back(trimmed(text.substr(from, to - from)));
    from = to + 1;
  }
  const std::size_t space = std::min(parts.front().find(' '), parts.front().size());
  request.kind = parts.front().substr(0, space);
  request.id = trimmed(parts.front().substr(space));
  request.names.assign(parts.begin() + 1, parts.end());
  return request;
}

/// Within a fenced block, which shows how something is written.
bool isFenced(const std::string& markdown, std::size_t at) {
  bool fenced = markdown.rfind("```", 0) == 0;
  for (std::size_t fence = markdown.find("\n```"); fence < at; fence = markdown.find("\n```", fence + 1))
    fenced = !fenced;
  return fenced;
}

/// The blanks before a passage that begins its line; none for one within a line.
std::string indentation(const std::string& markdown, std::size_t at) {
  const std::size_t line = at == 0 ? 0 : markdown.rfind('\n', at - 1) + 1;
  const std::string before = markdown.substr(line, at - line);
  return before.find_first_not_of(' ') == std::string::npos ? before : std::string();
}

/// Every line but the first and empty ones begins with these blanks: a table stays in its item of a list.
std::string indented(const std::string& text, const std::string& blanks) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    result += text[i];
    if (text[i] == '\n' && (i + 1 == text.size() || text[i + 1] != '\n')) result += blanks;
  }
  return result;
}

}  // namespace

void refuse(const std::string& what, const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = nearestWord(name, known);
  throw Error(fmt::format("there is no {} '{}'; expected one of {}{}", what, name, fmt::join(known, ", "),
                          nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

void requireNames(const PassageRequest& request, std::size_t least, std::size_t most, const char* expected) {
  if (request.names.size() < least || request.names.size() > most)
    throw Error(fmt::format("'{}' has {} names; expected {}", request.kind, request.names.size(), expected));
}

std::string withPassages(const std::string& markdown, const std::filesystem::path& file,
                         const std::string& word,
                         const std::function<std::string(const PassageRequest&)>& write) {
  const std::string opens = "<!-- " + word + " ";
  std::string text;
  std::size_t at = 0;
  for (;;) {
    std::size_t opening = markdown.find(opens, at);
    while (opening != std::string::npos && isFenced(markdown, opening))
      opening = markdown.find(opens, opening + 1);
    if (opening == std::string::npos) return text + markdown.substr(at);
    const auto lineNumber =
        1 + std::count(markdown.begin(), markdown.begin() + static_cast<std::ptrdiff_t>(opening), '\n');
    const auto fail = [&](const std::string& what) {
      throw Error(fmt::format("{}:{}: {}", file.string(), lineNumber, what));
    };
    const std::size_t words = opening + opens.size(), wordsEnd = markdown.find(kOpeningEnd, words),
                      closing = markdown.find(kClosing, words), next = markdown.find(opens, words);
    if (wordsEnd == std::string::npos || closing == std::string::npos || closing < wordsEnd || next < closing)
      fail(fmt::format("this passage of {} figures has no end; expected {} after it", word, kClosing));
    const std::size_t inside = wordsEnd + kOpeningEnd.size();
    text += markdown.substr(at, inside - at);
    try {
      text += indented(write(requestOf(markdown.substr(words, wordsEnd - words))),
                       indentation(markdown, opening));
    } catch (const Error& error) {
      fail(error.what());
    }
    text += kClosing;
    at = closing + kClosing.size();
  }
}

}  // namespace lumivox::page

// Compares messages by their facts: places, names and numbers. The sentences around them may change.
#pragma once

#include <catch2/catch.hpp>
#include <cctype>
#include <exception>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

namespace lumivox::test {

/// Matches a text or an exception that contains all facts (texts or numbers), each as a whole word or number,
/// in this order: `CHECK_THAT(message, Tells("a.scene:4:15", "n.obj", "m.obj"))`,
/// `CHECK_THROWS_MATCHES(work(), Error, Tells("radius", -1))`.
class Tells : public Catch::MatcherBase<std::string> {
 public:
  template <class... Facts>
  explicit Tells(const Facts&... facts) : facts_{wordOf(facts)...} {}

  bool match(const std::string& text) const override {
    const std::string said = withoutSource(text);
    std::size_t from = 0;
    for (const std::string& fact : facts_) {
      std::size_t at = said.find(fact, from);
      while (at != std::string::npos && !isWhole(said, at, at + fact.size())) at = said.find(fact, at + 1);
      if (at == std::string::npos) return false;
      from = at + fact.size();
    }
    return true;
  }
  bool match(const std::exception& error) const { return match(std::string(error.what())); }

  std::string describe() const override {
    std::string result = "tells in this order";
    for (const std::string& fact : facts_) result += " \"" + fact + "\"";
    return result;
  }

 private:
  template <class Fact>
  static std::string wordOf(const Fact& fact) {
    if constexpr (std::is_convertible_v<const Fact&, std::string>) {
      return fact;
    } else {
      std::ostringstream text;
      text << fact;
      return text.str();
    }
  }

  /// The text without a Diagnostic's source line and caret, which begin with two blanks: the source line
  /// contains every name of the input.
  static std::string withoutSource(const std::string& text) {
    std::istringstream lines(text);
    std::string said;
    for (std::string line; std::getline(lines, line);)
      if (line.rfind("  ", 0) != 0) said += line + "\n";
    return said;
  }

  static bool isWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
  static bool isDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

  /// Whether text[begin, end) is not part of a longer word or number: 5 is not found in 15, -5, 0.5 or 5.2.
  static bool isWhole(const std::string& text, std::size_t begin, std::size_t end) {
    const auto at = [&](std::size_t index) { return index < text.size() ? text[index] : ' '; };
    const char first = at(begin), last = at(end - 1), before = at(begin - 1), twoBefore = at(begin - 2);
    if (isWord(first) && isWord(before)) return false;
    if (isWord(last) && isWord(at(end))) return false;
    if (isDigit(first) && before == '.' && isDigit(twoBefore)) return false;
    if (isDigit(first) && before == '-' && !isWord(twoBefore)) return false;
    return !(isDigit(last) && at(end) == '.' && isDigit(at(end + 1)));
  }

  std::vector<std::string> facts_;
};

}  // namespace lumivox::test

// Messages are compared by their facts: the place, the names and the numbers. The sentences around them may
// change.
#pragma once

#include <catch2/catch.hpp>
#include <cctype>
#include <exception>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

namespace lumivox::test {

/// Matches a text or an exception that tells all facts (texts or numbers), each as a whole word or number, in
/// this order: `CHECK_THAT(message, Tells("a.scene:4:15", "n.obj", "m.obj"))`, `CHECK_THROWS_MATCHES(work(),
/// Error, Tells("radius", -1))`.
class Tells : public Catch::MatcherBase<std::string> {
 public:
  template <class... Facts>
  explicit Tells(const Facts&... facts) : facts_{wordOf(facts)...} {}

  bool match(const std::string& text) const override {
    std::size_t from = 0;
    for (const std::string& fact : facts_) {
      std::size_t at = text.find(fact, from);
      while (at != std::string::npos && !isWhole(text, at, at + fact.size())) at = text.find(fact, at + 1);
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

  static bool isWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
  static bool isDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

  /// Whether text[begin, end) is no part of a longer word or number: 5 stands neither in 15, -5 and 0.5 nor
  /// in 5.2.
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

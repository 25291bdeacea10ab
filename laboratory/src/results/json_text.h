// Reads a JSON text straight into members. A document in memory first takes three times as long, and a store
// may hold 10^5 records.
#pragma once

#include <charconv>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>

namespace lumivox::results {

/// Each function takes the value that stands next. Error for anything else there.
class JsonText {
 public:
  explicit JsonText(std::string_view text) : text_(text) {}

  /// Calls member(key), which takes the value.
  template <class Member>
  void object(Member member) {
    expect('{');
    if (takes('}')) return;
    do {
      const std::string key = string();
      expect(':');
      member(key);
    } while (takes(','));
    expect('}');
  }
  /// Calls item(), which takes the value.
  template <class Item>
  void array(Item item) {
    expect('[');
    if (takes(']')) return;
    do item();
    while (takes(','));
    expect(']');
  }
  std::string string();
  bool boolean();
  bool takesNull();  ///< whether it stands next
  template <class Number>
  Number number() {
    Number value{};
    toNext();
    const auto [end, failure] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (failure != std::errc()) fail("a number");
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }
  void skip();  ///< any value
  void end();   ///< that nothing follows

 private:
  void toNext() {
    while (at_ < text_.size() &&
           (text_[at_] == ' ' || text_[at_] == '\n' || text_[at_] == '\t' || text_[at_] == '\r'))
      ++at_;
  }
  bool takes(char c) {
    toNext();
    if (at_ == text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!takes(c)) fail(std::string(1, c));
  }
  bool takesWord(std::string_view word);
  unsigned hexadecimal();  ///< four digits
  [[noreturn]] void fail(const std::string& expected) const;

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace lumivox::results

// Reads a JSON text straight into members. A document in memory first takes three times as long, and a store
// may hold 10^5 records.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <string>
#include <string_view>

#include "lumivox/base/error.h"

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
  std::string string() {
    expect('"');
    std::string value;
    for (;;) {
      const std::size_t stop = text_.find_first_of("\"\\", at_);
      if (stop == text_.npos) fail("the end of a string");
      value += text_.substr(at_, stop - at_);
      at_ = stop + 1;
      if (text_[stop] == '"') return value;
      constexpr std::string_view kEscapes = "\"\\/bfnrt", kMeant = "\"\\/\b\f\n\r\t";
      unsigned code = 0;
      if (const std::size_t known = kEscapes.find(text_.substr(at_, 1));
          at_ < text_.size() && known != text_.npos) {
        value += kMeant[known];
        ++at_;
      } else if (std::sscanf(std::string(text_.substr(at_, 5)).c_str(), "u%4x", &code) == 1 && code < 0x80) {
        value += static_cast<char>(code);  // other characters are written as they are
        at_ += 5;
      } else {
        fail("an escape");
      }
    }
  }
  bool boolean() {
    if (takesWord("true")) return true;
    if (!takesWord("false")) fail("true or false");
    return false;
  }
  /// Whether null stands next.
  bool takesNull() { return takesWord("null"); }
  template <class Number>
  Number number() {
    Number value{};
    toNext();
    const auto [end, failure] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (failure != std::errc()) fail("a number");
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }
  /// Any value.
  void skip() {
    toNext();
    const char c = at_ < text_.size() ? text_[at_] : '\0';
    if (c == '{') return object([&](const std::string&) { skip(); });
    if (c == '[') return array([&] { skip(); });
    if (c == '"') return static_cast<void>(string());
    if (!takesNull() && !takesWord("true") && !takesWord("false")) number<double>();
  }
  /// That nothing follows.
  void end() {
    toNext();
    if (at_ != text_.size()) fail("the end");
  }

 private:
  void toNext() { at_ = std::min(text_.find_first_not_of(" \n\t\r", at_), text_.size()); }
  bool takesWord(std::string_view word) {
    toNext();
    if (text_.substr(at_, word.size()) != word) return false;
    at_ += word.size();
    return true;
  }
  bool takes(char c) { return takesWord(std::string_view(&c, 1)); }
  void expect(char c) {
    if (!takes(c)) fail(std::string(1, c));
  }
  [[noreturn]] void fail(const std::string& expected) const {
    throw Error(fmt::format("character {} of {}: expected {}", at_ + 1, text_.size(), expected));
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace lumivox::results

#include "results/json_text.h"

#include <fmt/format.h>

#include "lumivox/base/error.h"

namespace lumivox::results {
namespace {

void addUtf8(std::string& text, unsigned code) {
  const auto add = [&](unsigned byte) { text += static_cast<char>(byte); };
  if (code < 0x80) return add(code);
  if (code < 0x800) {
    add(0xC0 | code >> 6);
  } else {
    if (code < 0x10000) {
      add(0xE0 | code >> 12);
    } else {
      add(0xF0 | code >> 18);
      add(0x80 | (code >> 12 & 0x3F));
    }
    add(0x80 | (code >> 6 & 0x3F));
  }
  add(0x80 | (code & 0x3F));
}

}  // namespace

std::string JsonText::string() {
  expect('"');
  std::string value;
  for (;;) {
    const std::size_t stop = text_.find_first_of("\"\\", at_);
    if (stop == std::string_view::npos) fail("the end of a string");
    value += text_.substr(at_, stop - at_);
    at_ = stop + 1;
    if (text_[stop] == '"') return value;
    constexpr std::string_view kEscapes = "\"\\/bfnrt", kMeant = "\"\\/\b\f\n\r\t";
    const char escape = at_ < text_.size() ? text_[at_++] : '\0';
    if (const std::size_t known = kEscapes.find(escape); known != std::string_view::npos) {
      value += kMeant[known];
    } else if (escape == 'u') {
      unsigned code = hexadecimal();
      // Beyond the first 65536 characters two escapes make one.
      if (code >= 0xD800 && code < 0xDC00 && text_.substr(at_, 2) == "\\u") {
        at_ += 2;
        code = 0x10000 + ((code - 0xD800) << 10) + (hexadecimal() - 0xDC00);
      }
      addUtf8(value, code);
    } else {
      fail("an escape");
    }
  }
}

unsigned JsonText::hexadecimal() {
  unsigned code = 0;
  const std::string_view digits = text_.substr(at_, 4);
  const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
  if (failure != std::errc() || end != digits.data() + 4) fail("four hexadecimal digits");
  at_ += 4;
  return code;
}

bool JsonText::takesWord(std::string_view word) {
  toNext();
  if (text_.substr(at_, word.size()) != word) return false;
  at_ += word.size();
  return true;
}

bool JsonText::boolean() {
  if (takesWord("true")) return true;
  if (!takesWord("false")) fail("true or false");
  return false;
}

bool JsonText::takesNull() {
  return takesWord("null");
}

void JsonText::skip() {
  toNext();
  int depth = 0;
  do {
    if (at_ == text_.size()) fail("a value");
    const char c = text_[at_];
    if (c == '"') {
      string();
      continue;
    }
    if (depth == 0 && (c == ',' || c == ':' || c == '}' || c == ']')) fail("a value");
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    ++at_;
    // A number or a word ends before what follows it.
    while (depth == 0 && c != '}' && c != ']' && at_ < text_.size() &&
           text_.find_first_of(",}] \n\t\r", at_) != at_)
      ++at_;
  } while (depth > 0);
}

void JsonText::end() {
  toNext();
  if (at_ != text_.size()) fail("the end");
}

void JsonText::fail(const std::string& expected) const {
  throw Error(fmt::format("character {} of {}: expected {}", at_ + 1, text_.size(), expected));
}

}  // namespace lumivox::results

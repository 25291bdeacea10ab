#include "dsl/lexer.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace lumivox::dsl {
namespace {

bool isLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool isDigit(char c) {
  return c >= '0' && c <= '9';
}
bool isContinuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0u) == 0x80u;
}  // of a UTF-8 character

class Lexer {
 public:
  explicit Lexer(Document& document) : document_(document), source_(document.source) {}

  std::vector<Token> run() {
    if (source_.rfind("\xEF\xBB\xBF", 0) == 0) position_ = 3;  // byte order mark
    while (document_.findings.size() < kMaximumFindings) {
      skipBlanks();
      if (atEnd()) break;
      readToken();
    }
    begin(TokenKind::end);
    finish();
    return std::move(tokens_);
  }

 private:
  bool atEnd() const { return position_ >= source_.size(); }
  char peek(std::size_t ahead = 0) const {
    return position_ + ahead < source_.size() ? source_[position_ + ahead] : '\0';
  }
  bool rangeFollows() const { return peek() == '.' && peek(1) == '.'; }
  /// Columns count characters, not bytes, so that the caret stands under the right one.
  void advance() {
    if (!isContinuation(source_[position_])) ++column_;
    ++position_;
  }

  SourcePlace here() const { return {document_.file.string(), line_, column_}; }

  void report(const SourcePlace& place, int length, std::string what, std::string expected = {},
              std::string suggestion = {}) {
    document_.findings.push_back(
        document_.finding(place, length, std::move(what), std::move(expected), std::move(suggestion)));
  }

  void newLine() {
    ++position_;
    ++line_;
    column_ = 1;
    startsLine_ = true;
    ++lineEnds_;
  }

  void skipBlanks() {
    while (!atEnd()) {
      const char c = peek();
      if (c == '\n') {
        newLine();
      } else if (c == ' ' || c == '\t' || c == '\r') {
        advance();
      } else if (c == '#') {
        readComment();
      } else {
        return;
      }
    }
  }

  void readComment() {
    noteBlankLine();
    std::string text;
    while (!atEnd() && peek() != '\n') {
      text += peek();
      advance();
    }
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r'))
      text.pop_back();
    pending_.comments.push_back({text, startsLine_});
  }

  /// A blank line before the first comment or token of an item belongs to the item; between comments it is an
  /// empty comment.
  void noteBlankLine() {
    const bool blank = lineEnds_ > 1;
    lineEnds_ = 0;
    if (!blank) return;
    if (pending_.comments.empty()) {
      pending_.blankLineBefore = true;
    } else {
      pending_.comments.push_back({});
    }
  }

  void begin(TokenKind kind) {
    noteBlankLine();
    pending_.kind = kind;
    pending_.place = here();
    pending_.startsLine = startsLine_;
  }

  void finish() {
    pending_.length = std::max(1, column_ - pending_.place.column);
    tokens_.push_back(std::move(pending_));
    pending_ = {};
    startsLine_ = false;
  }

  void readToken() {
    const char c = peek();
    switch (c) {
      case '{':
        return readMark(TokenKind::open);
      case '}':
        return readMark(TokenKind::close);
      case '[':
        return readMark(TokenKind::listOpen);
      case ']':
        return readMark(TokenKind::listClose);
      case '"':
        return readText();
      case '$':
        return readParameter();
      default:
        break;
    }
    if (rangeFollows()) {
      begin(TokenKind::range);
      advance();
      advance();
      return finish();
    }
    const std::size_t digitAt =
        (c == '+' || c == '-' ? 1 : 0) + (peek(c == '+' || c == '-' ? 1 : 0) == '.' ? 1 : 0);
    if (isDigit(peek(digitAt))) return readNumber();
    if (isLetter(c)) return readWord();
    if (c == '/' && isLetter(peek(1))) return readUnit();
    readStray();
  }

  void readMark(TokenKind kind) {
    begin(kind);
    advance();
    finish();
  }

  bool wordGoesOn() const {
    const char c = peek();
    return isLetter(c) || isDigit(c) || c == '/' || c == '*' || c == '?' || c == '-' ||
           (c == '.' && peek(1) != '.');
  }

  void readWord() {
    begin(TokenKind::word);
    while (!atEnd() && wordGoesOn()) {
      pending_.text += peek();
      advance();
    }
    finish();
  }

  void readUnit() {
    begin(TokenKind::unit);
    while (!atEnd() && wordGoesOn()) {
      pending_.text += peek();
      advance();
    }
    finish();
  }

  void readParameter() {
    begin(TokenKind::parameter);
    advance();
    while (!atEnd() && (isLetter(peek()) || isDigit(peek()))) {
      pending_.text += peek();
      advance();
    }
    if (pending_.text.empty()) {
      report(pending_.place, 1, "'$' without a name", "a parameter such as $resolution");
      startsLine_ = false;
      return;
    }
    finish();
  }

  void readText() {
    begin(TokenKind::text);
    openingQuote_ = position_;
    advance();
    while (!atEnd() && peek() != '"' && peek() != '\n') {
      if (peek() == '\\' && (peek(1) == '"' || peek(1) == '\\')) advance();
      pending_.text += peek();
      advance();
    }
    if (peek() == '"' && !atEnd()) {
      advance();
    } else {
      report(pending_.place, column_ - pending_.place.column, "the string is not closed",
             "'\"' before the end of the line");
      endBeforeBrace();
    }
    finish();
  }

  /// An unclosed string ends before the first brace behind a blank, so that braces keep their meaning.
  void endBeforeBrace() {
    std::size_t brace = openingQuote_ + 1;
    while (brace < position_ && !((source_[brace] == '{' || source_[brace] == '}') &&
                                  (source_[brace - 1] == ' ' || brace == openingQuote_ + 1)))
      ++brace;
    if (brace < position_) {
      while (position_ > brace)
        if (!isContinuation(source_[--position_])) --column_;
      pending_.text = source_.substr(openingQuote_ + 1, brace - openingQuote_ - 1);
    }
    while (!pending_.text.empty() && (pending_.text.back() == '\r' || pending_.text.back() == ' '))
      pending_.text.pop_back();
  }

  void readDigits() {
    while (isDigit(peek())) {
      pending_.text += peek();
      advance();
    }
  }

  void readNumber() {
    begin(TokenKind::number);
    pending_.integral = true;
    if (peek() == '+' || peek() == '-') {
      pending_.text += peek();
      advance();
    }
    readDigits();
    if (peek() == '.' && !rangeFollows()) {
      pending_.integral = false;
      pending_.text += '.';
      advance();
      readDigits();
    }
    const std::size_t signs = peek(1) == '+' || peek(1) == '-' ? 1 : 0;
    if ((peek() == 'e' || peek() == 'E') && isDigit(peek(1 + signs))) {
      pending_.integral = false;
      for (std::size_t i = 0; i <= signs; ++i) {
        pending_.text += peek();
        advance();
      }
      readDigits();
    }
    convertNumber();
    readAttachedUnit();
    finish();
  }

  void convertNumber() {
    const char* first = pending_.text.data() + (pending_.text.front() == '+' ? 1 : 0);
    const auto result = std::from_chars(first, pending_.text.data() + pending_.text.size(), pending_.number);
    if (result.ec != std::errc() || !std::isfinite(pending_.number)) {
      pending_.number = 0.0;
      report(pending_.place, column_ - pending_.place.column,
             fmt::format("the number {} is out of range", shortened(pending_.text)),
             "a magnitude between 1e-307 and 1e308");
    }
  }

  void readAttachedUnit() {
    const SourcePlace place = here();
    std::string rest;
    while (!atEnd() && wordGoesOn()) {
      rest += peek();
      advance();
    }
    if (rest.empty()) return;
    const int length = column_ - place.column;
    if (!isLetter(rest.front()) && rest.front() != '/') {
      report(pending_.place, column_ - pending_.place.column,
             fmt::format("malformed number '{}{}'", pending_.text, shortened(rest)),
             "a number such as 12, -0.3 or 1e-3");
    } else if (const Unit* unit = findUnit(rest)) {
      pending_.unit = *unit;
    } else if (rest.front() == 'x' && rest.size() > 1 && isDigit(rest[1])) {
      report(pending_.place, column_ - pending_.place.column,
             fmt::format("'{}{}' is one word", pending_.text, shortened(rest)),
             fmt::format("two numbers with a blank between, as in {} {}", pending_.text,
                         shortened(rest.substr(1))));
    } else if (blockFollows()) {
      report(pending_.place, column_ - pending_.place.column,
             fmt::format("'{}{}' is no name", pending_.text, shortened(rest)),
             "a name that begins with a letter");
      pending_.kind = TokenKind::word;
      pending_.text += rest;
    } else {
      report(place, length, fmt::format("unknown unit '{}'", shortened(rest)),
             "one of " + fmt::format("{}", fmt::join(unitNameList(), ", ")),
             nearestWord(rest, unitNameList()));
    }
  }

  /// Whether a '{' follows after blanks.
  bool blockFollows() const {
    std::size_t at = position_;
    while (at < source_.size() && source_[at] == ' ') ++at;
    return at < source_.size() && source_[at] == '{';
  }

  /// Reads a comment or string in the syntax of other languages.
  bool readForeign() {
    const SourcePlace place = here();
    if (peek() == '/' && (peek(1) == '/' || peek(1) == '*')) {
      report(place, 2, fmt::format("unexpected '/{}'", peek(1)), "'#' before a comment");
      const std::size_t end =
          peek(1) == '*' ? source_.find("*/", position_ + 2) : source_.find('\n', position_);
      const std::size_t stop = end == std::string::npos ? source_.size() : end + (peek(1) == '*' ? 2 : 0);
      while (position_ < stop) peek() == '\n' ? newLine() : advance();
      return true;
    }
    // Only a quote starts this search, which ends with the line, so that each line is read once.
    if (peek() != '\'') return false;
    const std::size_t quote = source_.find_first_of("'\n", position_ + 1);
    if (quote == std::string::npos || source_[quote] == '\n') return false;
    begin(TokenKind::text);
    advance();
    while (position_ < quote) {
      pending_.text += peek();
      advance();
    }
    advance();
    report(place, column_ - place.column, "a string in single quotes", fmt::format("\"{}\"", pending_.text));
    finish();
    return true;
  }

  void readStray() {
    if (readForeign()) return;
    const SourcePlace place = here();
    const char c = peek();
    const bool afterDigit = position_ > 0 && isDigit(source_[position_ - 1]);
    startsLine_ = false;
    lineEnds_ = 0;
    std::string character(1, c);
    advance();
    while (!atEnd() && isContinuation(peek())) {
      character += peek();
      advance();
    }
    if (strayLine_ == line_) return;
    strayLine_ = line_;
    if (c == ',' && afterDigit && isDigit(peek())) {
      report(place, 1, "unexpected ','", "'.' in a decimal number, or blanks between values");
    } else if (c == '(' || c == ')') {
      report(place, 1, fmt::format("unexpected '{}'", c), "values separated by blanks, without parentheses");
    } else if (c == '=' || c == ';' || c == ',' || c == ':') {
      report(place, 1, fmt::format("unexpected '{}'", c), "words and values separated by blanks");
    } else if (c == '+' || c == '-') {
      report(place, 1, fmt::format("'{}' without a number", c), "digits right after the sign");
    } else {
      report(place, 1, fmt::format("unexpected character '{}'", character),
             "a word, a number, a string in double quotes, or one of { } [ ] .. $ #");
    }
  }

  static std::string shortened(const std::string& text) {
    constexpr std::size_t kShown = 40;
    return text.size() <= kShown ? text : text.substr(0, kShown) + "...";
  }

  Document& document_;
  const std::string& source_;
  std::vector<Token> tokens_;
  Token pending_;
  std::size_t position_ = 0, openingQuote_ = 0;
  int line_ = 1, column_ = 1;
  int strayLine_ = 0;  ///< line of the last stray character; a line gets one finding for them
  int lineEnds_ = 0;   // since the last token or comment
  bool startsLine_ = true;
};

}  // namespace

std::vector<Token> lex(Document& document) {
  return Lexer(document).run();
}

}  // namespace lumivox::dsl

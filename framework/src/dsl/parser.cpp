#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "dsl/consequences.h"
#include "dsl/lexer.h"

namespace lumivox::dsl {
namespace {

/// Recursive descent over the tokens. After an error it continues at the next word that starts a line, or at
/// a brace.
class Parser {
 public:
  Parser(Document& document, std::vector<Token> tokens)
      : document_(document),
        tokens_(std::move(tokens)),
        ofLexer_(static_cast<std::ptrdiff_t>(document.findings.size())) {}

  void run() {
    document_.items = items(document_.commentsAtEnd, 0);
    if (!unclosed_.empty()) reportUnclosed();
  }

  const Doubts& doubts() const { return doubts_; }

 private:
  const Token& now() const { return tokens_[position_]; }
  bool is(TokenKind kind) const { return now().kind == kind; }
  Token& take() {
    Token& token = tokens_[position_];
    if (position_ + 1 < tokens_.size()) ++position_;
    return token;
  }

  void report(const Token& token, std::string what, std::string expected) {
    if (document_.findings.size() >= kMaximumFindings || onLineOfLexer(token)) return;
    document_.findings.push_back(
        document_.finding(token.place, token.length, std::move(what), std::move(expected)));
  }

  /// Whether the lexer has a finding on the token's line: a finding of the parser would be its consequence.
  bool onLineOfLexer(const Token& token) const {
    return std::any_of(document_.findings.begin(), document_.findings.begin() + ofLexer_,
                       [&](const Diagnostic& finding) { return finding.place.line == token.place.line; });
  }

  void doubtFrom(int line) {
    const auto [first, isNew] = doubts_.from.emplace(document_.file.string(), line);
    if (!isNew) first->second = std::min(first->second, line);
  }

  static bool isPlain(const Token& token) {
    return token.kind == TokenKind::word && token.text.find_first_of("./*?") == std::string::npos;
  }

  /// Whether a block starts here: the words and strings on this line end in '{'. A '{' at the start of the
  /// next line is accepted with a finding.
  bool blockStarts() {
    // All words of a line have the same end, so it is searched for once.
    if (headerEnd_ <= position_) {
      headerEnd_ = position_ + 1;
      while (headerEnd_ + 1 < tokens_.size() &&
             (tokens_[headerEnd_].kind == TokenKind::word || tokens_[headerEnd_].kind == TokenKind::text) &&
             !tokens_[headerEnd_].startsLine)
        ++headerEnd_;
    }
    const Token& end = tokens_[std::min(headerEnd_, tokens_.size() - 1)];
    if (end.kind != TokenKind::open) return false;
    if (end.startsLine) report(end, "'{' starts a line", "'{' on the line of its block's word");
    return true;
  }

  std::vector<Item> items(std::vector<std::string>& commentsAtEnd, int depth) {
    std::vector<Item> result;
    int column = 0;  // column of the first item that starts a line
    while (!is(TokenKind::end)) {
      if (document_.findings.size() >= kMaximumFindings) {
        position_ = tokens_.size() - 1;
      } else if (is(TokenKind::close)) {
        if (depth > 0) break;
        reportSurplus();
        take();
      } else if (!isPlain(now())) {
        reportStray();
      } else {
        noteOutdented();
        if (now().startsLine) {
          if (column == 0) column = now().place.column;
          if (now().place.column > column && !result.empty()) noteIndented(result.back());
        }
        result.push_back(item(depth));
      }
    }
    commentsAtEnd = commentTexts(tokens_[position_], true);
    return result;
  }

  Item item(int depth) {
    Item result;
    Token& first = now_();
    result.blankLineBefore = first.blankLineBefore;
    result.startsLine = first.startsLine;
    result.commentsBefore = commentTexts(first, false);
    if (blockStarts()) {
      result.block = std::make_unique<Block>(block(result, depth));
    } else {
      result.property = property(result);
    }
    result.commentAfter = commentOnLine();
    return result;
  }

  Token& now_() { return tokens_[position_]; }

  Property property(Item& owner) {
    Property result;
    const Token& word = take();
    result.word = word.text;
    result.place = word.place;
    bool first = true;
    while (valueStarts(first, result)) {
      keepComments(owner);
      result.values.push_back(value(owner));
      first = false;
    }
    return result;
  }

  bool valueStarts(bool first, const Property& property) const {
    switch (now().kind) {
      case TokenKind::number:
      case TokenKind::text:
      case TokenKind::parameter:
      case TokenKind::listOpen:
        return true;
      case TokenKind::word: {
        if (!isPlain(now())) return true;
        if (now().text == "in" && !first) return true;
        // `param NAME VALUE`: the value behind a name may be a word too.
        if (property.word == "param" && property.values.size() == 1 && !now().startsLine) return true;
        return first && !now().startsLine;
      }
      default:
        return false;
    }
  }

  Value value(Item& owner) {
    Token& token = take();
    Value result;
    result.place = token.place;
    result.length = token.length;
    result.text = token.text;
    switch (token.kind) {
      case TokenKind::number:
        return number(token, owner);
      case TokenKind::listOpen:
        return list(token, owner);
      case TokenKind::text:
        result.kind = ValueKind::text;
        break;
      case TokenKind::parameter:
        result.kind = ValueKind::parameter;
        if (is(TokenKind::range)) return range(std::move(result), owner);
        break;
      default:
        result.kind = ValueKind::word;
        break;
    }
    return result;
  }

  Value plainNumber(const Token& token) {
    Value result;
    result.kind = ValueKind::number;
    result.place = token.place;
    result.length = token.length;
    result.number = token.number;
    result.integral = token.integral;
    result.text = token.text;
    result.unit = token.unit;
    if (!result.unit) readUnit(result);
    return result;
  }

  Value number(const Token& token, Item& owner) {
    Value result = plainNumber(token);
    if (is(TokenKind::range)) return range(std::move(result), owner);
    return result;
  }

  /// A unit behind a blank: `30 deg`, `40 /m`.
  void readUnit(Value& value) {
    if (now().startsLine) return;
    if (is(TokenKind::unit) || is(TokenKind::word)) {
      if (const Unit* unit = findUnit(now().text)) {
        value.unit = *unit;
        const Token& token = take();
        if (token.place.line == value.place.line) {
          value.length = token.place.column + token.length - value.place.column;
        }
      } else if (is(TokenKind::unit)) {
        reportUnknownUnit(take());
      }
    }
  }

  void reportUnknownUnit(const Token& token) {
    const std::vector<std::string> names = unitNameList();
    report(token, fmt::format("unknown unit '{}'", token.text),
           fmt::format("one of {}", fmt::join(names, ", ")));
    if (!document_.findings.empty()) document_.findings.back().suggestion = nearestWord(token.text, names);
  }

  Value range(Value low, Item& owner) {
    const Token& dots = take();
    Value result;
    result.kind = ValueKind::range;
    result.place = low.place;
    keepComments(owner);
    Value high;
    if (is(TokenKind::number)) {
      high = plainNumber(take());
    } else if (is(TokenKind::parameter)) {
      const Token& token = take();
      high.kind = ValueKind::parameter;
      high.place = token.place;
      high.length = token.length;
      high.text = token.text;
    } else {
      report(dots, "'..' without an upper end", "a range such as 16..512");
      return low;
    }
    if (high.unit && !low.unit) low.unit = high.unit;  // 1..2 m
    if (high.place.line == low.place.line) {
      result.length = high.place.column + high.length - low.place.column;
    }
    result.items = {std::move(low), std::move(high)};
    return result;
  }

  Value list(const Token& bracket, Item& owner) {
    Value result;
    result.kind = ValueKind::list;
    result.place = bracket.place;
    const Token opening = bracket;
    bool tooMany = false;
    for (;;) {
      keepComments(owner);
      if (is(TokenKind::listClose)) break;
      if (is(TokenKind::open) || is(TokenKind::close) || is(TokenKind::end)) {
        report(opening, "the list is not closed", "']' before the end of the block");
        return result;
      }
      if (is(TokenKind::listOpen)) {
        // `resolution [16 32` and `cones [4 6]` in the next line
        if (!result.items.empty() && tokens_[position_ - 1].startsLine && isPlain(tokens_[position_ - 1])) {
          report(opening, "the list is not closed", "']' before the next property");
          result.items.pop_back();
          --position_;
          return result;
        }
        report(take(), "a list in a list", "numbers or words");
        continue;
      }
      if (is(TokenKind::range) || is(TokenKind::unit)) {
        report(now(), fmt::format("unexpected '{}' in a list", is(TokenKind::range) ? ".." : now().text),
               "numbers or words");
        take();
        continue;
      }
      Value item = value(owner);
      if (result.items.size() < kMaximumListItems) {
        result.items.push_back(std::move(item));
      } else if (!tooMany) {
        tooMany = true;
        report(opening, "the list is too long", fmt::format("at most {} items", kMaximumListItems));
      }
    }
    const Token& end = take();
    if (end.place.line == result.place.line) result.length = end.place.column + 1 - result.place.column;
    return result;
  }

  Block block(Item& owner, int depth) {
    Block result;
    const Token& word = take();
    result.word = word.text;
    result.place = word.place;
    while (!is(TokenKind::open)) result.header.push_back(value(owner));
    keepComments(owner);
    const Token& brace = take();
    result.commentAfterOpen = commentOnLine();
    if (depth + 1 > kMaximumNesting) {
      report(brace, "blocks are nested too deeply", fmt::format("at most {} levels", kMaximumNesting));
      skipBlock();
      return result;
    }
    open_.push_back({result.title(), result.place, static_cast<int>(result.word.size())});
    result.items = items(result.commentsAtEnd, depth + 1);
    open_.pop_back();
    if (is(TokenKind::close)) {
      noteEarlyEnd(result);
      take();
    } else {
      result.closed = false;
      unclosed_.push_back({result.title(), result.place, static_cast<int>(result.word.size())});
    }
    return result;
  }

  /// Notes an item that is indented no further than its block: that block may lack its '}'.
  void noteOutdented() {
    if (!unclosedHere_ && !open_.empty() && now().startsLine && now().place.line > open_.back().place.line &&
        now().place.column <= open_.back().place.column)
      unclosedHere_ = open_.back();
  }

  /// Notes items indented further than the first one of their block: the property before them may be meant as
  /// a block.
  void noteIndented(const Item& before) {
    if (missingOpen_ || !before.property) return;
    Block meant;
    meant.word = before.property->word;
    meant.header = before.property->values;
    missingOpen_ = OpenBlock{meant.title(), before.property->place, static_cast<int>(meant.word.size())};
  }

  /// Notes a '}' that ends a block of several lines behind another item on its line: it may belong to another
  /// block. Also notes a '}' indented less than its block: that block may lack its own.
  void noteEarlyEnd(const Block& block) {
    if (!earlyEnd_ && !now().startsLine && now().place.line > block.place.line)
      earlyEnd_ = EarlyEnd{block.title(), block.place.line, now()};
    if (!unclosedHere_ && now().startsLine && now().place.line > block.place.line &&
        now().place.column < block.place.column)
      unclosedHere_ = OpenBlock{block.title(), block.place, static_cast<int>(block.word.size())};
  }

  /// Reports a '}' without a block once, at the brace that ended a block too early, if one was noted.
  void reportSurplus() {
    if (std::exchange(surplusTold_, true)) return;
    if (missingOpen_ && (!earlyEnd_ || missingOpen_->place.line <= earlyEnd_->brace.place.line)) {
      doubtFrom(missingOpen_->place.line);
      document_.findings.push_back(
          document_.finding(missingOpen_->place, missingOpen_->length,
                            fmt::format("'{}' has no '{{', and a '}}' too many follows in line {}",
                                        missingOpen_->title, now().place.line),
                            "'{' on the line of its block's word"));
    } else if (earlyEnd_) {
      doubtFrom(earlyEnd_->brace.place.line);
      report(earlyEnd_->brace,
             fmt::format("this '}}' ends block '{}' of line {}, and another '}}' follows in line {}",
                         earlyEnd_->title, earlyEnd_->line, now().place.line),
             "a '{' before it, or one '}' less");
    } else {
      doubtFrom(now().place.line);
      report(now(), "unexpected '}'", "no '}' here: no block is open");
      doubts_.surplusBrace = now().place;
    }
  }

  /// Skips from behind '{' to behind its '}'.
  void skipBlock() {
    int open = 1;
    while (open > 0 && !is(TokenKind::end)) {
      if (is(TokenKind::open)) ++open;
      if (is(TokenKind::close)) --open;
      take();
    }
  }

  void reportStray() {
    const Token& token = now();
    switch (token.kind) {
      case TokenKind::open:
        report(token, "unexpected '{'", "a block's word before it, and only words and strings between");
        take();
        skipBlock();
        return;
      case TokenKind::unit:
        if (findUnit(token.text) == nullptr) {
          reportUnknownUnit(token);
        } else {
          report(token, fmt::format("unit '{}' without a number", token.text), "a number before it");
        }
        break;
      case TokenKind::range:
        report(token, "unexpected '..'", "a number on both sides, as in 16..512");
        break;
      case TokenKind::listClose:
        report(token, "unexpected ']'", "no ']' here: no list is open");
        break;
      case TokenKind::word:
        report(token, fmt::format("unexpected '{}'", token.text),
               "a plain word: the name of a property or block");
        break;
      default:
        if (!open_.empty() && position_ > 0 && tokens_[position_ - 1].kind == TokenKind::open) {
          report(token, fmt::format("unexpected value in the braces of '{}'", open_.back().title),
                 "words with their values; the value of a property has no braces");
        } else {
          report(token, "unexpected value", "the name of a property or block before it");
        }
        break;
    }
    take();
    skipStatement();
  }

  /// Skips to the next plain word that starts a line, or to a brace, so that a stray token makes one finding.
  void skipStatement() {
    while (!is(TokenKind::end) && !is(TokenKind::open) && !is(TokenKind::close) && !isPlain(now())) take();
  }

  static std::vector<std::string> commentTexts(Token& token, bool atEnd) {
    std::vector<std::string> texts;
    if (atEnd && token.blankLineBefore && !token.comments.empty()) texts.emplace_back();
    for (Comment& comment : token.comments) texts.push_back(std::move(comment.text));
    token.comments.clear();
    if (atEnd) {
      while (!texts.empty() && texts.back().empty()) texts.pop_back();
    }
    return texts;
  }

  /// A comment behind the last token on its line.
  std::string commentOnLine() {
    std::vector<Comment>& comments = now_().comments;
    if (comments.empty() || comments.front().startsLine) return {};
    std::string text = std::move(comments.front().text);
    comments.erase(comments.begin());
    // A blank line directly behind it belongs to the next item.
    if (!comments.empty() && comments.front().text.empty()) {
      comments.erase(comments.begin());
      now_().blankLineBefore = true;
    }
    return text;
  }

  /// Comments inside a statement move above it.
  void keepComments(Item& owner) {
    for (Comment& comment : now_().comments) {
      if (!comment.text.empty()) owner.commentsBefore.push_back(std::move(comment.text));
    }
    now_().comments.clear();
  }

  void reportUnclosed() {
    // The innermost open block stands first.
    std::vector<std::string> titles;
    for (auto block = unclosed_.rbegin(); block != unclosed_.rend(); ++block) titles.push_back(block->title);
    const OpenBlock& place = unclosedHere_ ? *unclosedHere_ : unclosed_.front();
    doubtFrom(place.place.line);
    document_.findings.push_back(document_.finding(
        place.place, place.length,
        unclosed_.size() == 1 ? fmt::format("the file ends inside block '{}'", titles.front())
                              : fmt::format("the file ends inside blocks '{}'", fmt::join(titles, "', '")),
        unclosedHere_ ? fmt::format("'}}' for every '{{'; by its indentation, '{}' lacks one", place.title)
                      : "'}' for every '{'"));
  }

  struct OpenBlock {
    std::string title;
    SourcePlace place;
    int length;
  };
  struct EarlyEnd {
    std::string title;
    int line;
    Token brace;
  };
  Document& document_;
  std::vector<Token> tokens_;
  std::ptrdiff_t ofLexer_;  ///< findings
  std::size_t position_ = 0;
  std::size_t headerEnd_ =
      0;  ///< cache of blockStarts(): the first token behind the header words of the line
  std::vector<OpenBlock> open_, unclosed_;
  std::optional<OpenBlock> unclosedHere_;  ///< the first block that seems to lack its '}'
  std::optional<OpenBlock> missingOpen_;   ///< the first statement that seems to lack its '{'
  std::optional<EarlyEnd> earlyEnd_;       ///< the first '}' that seems to end another block than its own
  bool surplusTold_ = false;
  Doubts doubts_;
};

/// The place of the first control character, if any.
std::optional<SourcePlace> firstControlCharacter(const Document& document) {
  int line = 1, column = 1;
  for (const char c : document.source) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\n') {
      ++line;
      column = 1;
    } else if ((byte < 0x20 && c != '\t' && c != '\r') || byte == 0x7F) {
      return SourcePlace{document.file.string(), line, column};
    } else {
      ++column;
    }
  }
  return std::nullopt;
}

}  // namespace

Doubts doubtsOf(const Document& document) {
  Doubts doubts;
  if (document.findings.empty()) return doubts;
  const auto add = [&](const std::filesystem::path& file, const std::string& source) {
    Document again;
    again.file = file;
    again.source = source;
    again.lineStarts = lineStartsOf(source);
    if (source.size() > kMaximumTextBytes || firstControlCharacter(again)) return;
    std::vector<Token> tokens = lex(again);
    Parser parser(again, std::move(tokens));
    parser.run();
    doubts.from.insert(parser.doubts().from.begin(), parser.doubts().from.end());
    if (!doubts.surplusBrace) doubts.surplusBrace = parser.doubts().surplusBrace;
  };
  add(document.file, document.source);
  for (const auto& [file, source] : document.includedSources) add(file, source);
  return doubts;
}

Document parse(std::string source, std::filesystem::path file) {
  Document document;
  document.file = std::move(file);
  document.source = std::move(source);
  document.lineStarts = lineStartsOf(document.source);
  const SourcePlace whole{document.file.string(), 0, 0};
  if (document.source.size() > kMaximumTextBytes) {
    document.findings.push_back(
        document.finding(whole, 1, fmt::format("the text is too large ({} bytes)", document.source.size()),
                         fmt::format("at most {} bytes", kMaximumTextBytes)));
    return document;
  }
  if (const auto place = firstControlCharacter(document)) {
    Diagnostic finding =
        document.finding(*place, 1, "not a text file: it contains control characters", "UTF-8 text");
    finding.sourceLine.clear();
    document.findings.push_back(std::move(finding));
    return document;
  }
  std::vector<Token> tokens = lex(document);
  if (tokens.size() == 1 && document.findings.empty()) {
    document.commentsAtEnd.clear();
    document.findings.push_back(document.finding(whole, 1, "the text is empty", "at least one block"));
    return document;
  }
  Parser(document, std::move(tokens)).run();
  std::stable_sort(document.findings.begin(), document.findings.end(),
                   [](const Diagnostic& a, const Diagnostic& b) {
                     return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
                   });
  if (document.findings.size() >= kMaximumFindings) {
    document.findings.push_back(
        document.finding(whole, 1, "too many errors; the rest of the file was not read", "a text of blocks"));
  }
  return document;
}

}  // namespace lumivox::dsl

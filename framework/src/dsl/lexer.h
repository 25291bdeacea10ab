// Splits a text into tokens. Tokens carry comments and line structure for the formatter.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/dsl/document.h"

namespace lumivox::dsl {

enum class TokenKind { word, number, text, parameter, unit, open, close, listOpen, listClose, range, end };

struct Comment {
  std::string text;        ///< with '#', without trailing blanks; empty: a blank line
  bool startsLine = true;  ///< nothing but blanks before it
};

struct Token {
  TokenKind kind = TokenKind::end;
  SourcePlace place;
  int length = 1;  ///< columns
  std::string
      text;  ///< of words, strings (unescaped), parameters (without $) and units; the digits of a number
  double number = 0.0;
  bool integral = false;
  std::optional<Unit> unit;       ///< written right behind a number: 4cm
  bool startsLine = false;        ///< first on its line, comments aside
  bool blankLineBefore = false;   ///< before its first comment or, without one, before itself
  std::vector<Comment> comments;  ///< between the token before and this one
};

/// All tokens; the last is `end`. Errors go to document.findings, and unreadable text is skipped.
std::vector<Token> lex(Document& document);

/// Document::lineStarts of a text.
std::vector<std::size_t> lineStartsOf(const std::string& source);

const Unit* findUnit(const std::string& name);
std::vector<std::string> unitNameList();

}  // namespace lumivox::dsl

// The syntax of both texts. A document is blocks; a block is `word [header values] { items }`; an item is a property (`word values`) or
// a block. Meaning comes from tables (schema.h), never from here.
//
// How the parser tells them apart without knowing any word: a statement starts with a plain word. When the words, paths and strings
// that follow it on the same line end in `{`, it is a block. Otherwise it is a property: its first value may be anything; every further
// value may be anything but a plain word, since a plain word starts the next property. (A dotted or slashed word is no plain word.)
// `param NAME VALUE in RANGE` is one property: `in` never starts a statement.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "lumivox/base/error.h"

namespace lumivox::dsl {

/// Exponents of metre, second, radian and kelvin-free radiometric units: what a unit measures.
struct Dimension {
  int length = 0, time = 0, angle = 0;
  bool operator==(const Dimension&) const = default;
  std::string text() const;  ///< "length", "1/length", "angle/time", "no unit"
};

struct Unit {
  std::string name;       ///< "cm", "/m", "deg/s"
  Dimension dimension;
  double toBase = 1.0;    ///< metres, seconds, radians
};
const std::vector<Unit>& knownUnits();

enum class ValueKind { number, word, text, list, range, parameter };

/// word: plain, dotted (a.b) or slashed (a/b). text: quoted string. parameter: $x. A number keeps its unit.
struct Value {
  ValueKind kind = ValueKind::number;
  SourcePlace place;
  int length = 1;                       ///< columns
  double number = 0.0;                  ///< as written
  bool integral = false;                ///< written without point and exponent
  std::optional<Unit> unit;
  std::string text;                     ///< of a word, a string (unescaped) or a parameter (without $)
  std::vector<Value> items;             ///< list elements; or low and high of a range
  bool isPlainWord() const;
  double inBaseUnits() const { return unit ? number * unit->toBase : number; }
};

struct Block;

struct Property {
  std::string word;
  SourcePlace place;
  std::vector<Value> values;
};

struct Item {
  std::optional<Property> property;     ///< exactly one of the two
  std::unique_ptr<Block> block;
  std::vector<std::string> commentsBefore;  ///< whole-line comments above, with '#'
  std::string commentAfter;             ///< on the same line
  bool blankLineBefore = false;
  bool startsLine = true;               ///< was first on its line
};

struct Block {
  std::string word;
  SourcePlace place;
  std::vector<Value> header;            ///< name or path, kind
  std::vector<Item> items;
  std::vector<std::string> commentsAtEnd;
};

struct Document {
  std::filesystem::path file;
  std::string source;
  std::vector<Item> items;              ///< top-level blocks and properties (include)
  std::vector<std::string> commentsAtEnd;
  std::vector<Diagnostic> findings;     ///< syntax errors; the rest of the document is still usable
  std::vector<std::filesystem::path> includedFiles;

  std::string line(int number) const;
  /// A finding at a place in this document, with the source line filled in.
  Diagnostic finding(const SourcePlace& place, int length, std::string what, std::string expected = {}, std::string suggestion = {}) const;
};

/// Parses with recovery: all syntax errors of the file are in `findings`.
Document parse(std::string source, std::filesystem::path file);

/// Reads and parses a file and splices in its includes (a path relative to the including file); a missing file and a cycle are findings.
Document parseFile(const std::filesystem::path& file);

/// The one canonical layout. Keeps comments and blank lines; idempotent. Precondition: no findings.
std::string format(const Document& document);

}  // namespace lumivox::dsl

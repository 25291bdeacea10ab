// The syntax of both texts. A document is blocks; a block is `word [header values] { items }`; an item is a
// property (`word values`) or a block. Meaning comes from tables (schema.h), never from here.
//
// How the parser tells them apart without knowing any word: a statement starts with a plain word. When the
// words, paths and strings that follow it on the same line end in `{`, it is a block. Otherwise it is a
// property: its first value may be anything; every further value may be anything but a plain word, since a
// plain word starts the next property. (A dotted or slashed word is no plain word.) `param NAME VALUE in
// RANGE` is one property: `in` never starts a statement. The names of units are no plain words either when
// they follow a number on its line: `30 deg`, `40 /m`, `4cm`. Values other than plain words may go on in the
// next line. `include "file"` may appear wherever a property or a block may; the items of the file take its
// place.
#pragma once

#include <filesystem>
#include <map>
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
inline constexpr Dimension kNoDimension{0, 0, 0}, kLength{1, 0, 0}, kTime{0, 1, 0}, kAngle{0, 0, 1},
    kInverseLength{-1, 0, 0}, kSpeed{1, -1, 0}, kAngularSpeed{0, -1, 1};

struct Unit {
  std::string name;  ///< "cm", "/m", "deg/s"
  Dimension dimension;
  double toBase = 1.0;  ///< metres, seconds, radians
};
const std::vector<Unit>& knownUnits();
/// The names of the units of one dimension: "m, cm, mm or km"; empty when there are none.
std::string unitNames(const Dimension& dimension);

enum class ValueKind { number, word, text, list, range, parameter };

/// word: plain, dotted (a.b) or slashed (a/b). text: quoted string. parameter: $x. A number keeps its unit.
struct Value {
  ValueKind kind = ValueKind::number;
  SourcePlace place;
  int length = 1;         ///< columns
  double number = 0.0;    ///< as written
  bool integral = false;  ///< written without point and exponent
  std::optional<Unit> unit;
  std::string
      text;  ///< of a word, a string (unescaped) or a parameter (without $); a number's digits as written
  std::vector<Value> items;  ///< list elements; or low and high of a range
  bool isPlainWord() const;
  double inBaseUnits() const { return unit ? number * unit->toBase : number; }
  std::string written() const;  ///< as the formatter writes it
};

struct Block;

struct Property {
  std::string word;
  SourcePlace place;
  std::vector<Value> values;
};

struct Item {
  std::optional<Property> property;  ///< exactly one of the two
  std::unique_ptr<Block> block;
  std::vector<std::string>
      commentsBefore;  ///< whole-line comments above, with '#'; an empty string is a blank line between them
  std::string commentAfter;  ///< on the same line
  bool blankLineBefore = false;
  bool startsLine = true;  ///< was first on its line
};

struct Block {
  std::string word;
  SourcePlace place;
  std::vector<Value> header;  ///< name or path, kind
  std::vector<Item> items;
  std::string commentAfterOpen;  ///< on the line of '{'
  std::vector<std::string> commentsAtEnd;
  bool closed = true;  ///< false: the file ended before its '}' (a finding)

  std::string title() const;  ///< word and header as written: `light lamp area`
};

struct Document {
  std::filesystem::path file;
  std::string source;
  std::vector<Item> items;  ///< top-level blocks and properties (include)
  std::vector<std::string> commentsAtEnd;
  std::vector<Diagnostic> findings;  ///< syntax errors; the rest of the document is still usable
  std::vector<std::filesystem::path> includedFiles;  ///< each once, in the order of reading
  std::map<std::string, std::string>
      includedSources;  ///< their texts, by the file name that places in them carry
  /// Where the lines of `source` and of `includedSources` begin, in bytes: of every text that was parsed.
  std::vector<std::size_t> lineStarts;
  std::map<std::string, std::vector<std::size_t>> includedLineStarts;

  std::string line(int number) const;  ///< of this file
  std::string line(
      const SourcePlace& place) const;  ///< of the file that the place names: this one or an included one
  /// A finding at a place in this document or in an included file, with the source line filled in.
  Diagnostic finding(const SourcePlace& place, int length, std::string what, std::string expected = {},
                     std::string suggestion = {}) const;
};

/// Limits of one text. They keep hostile input from taking memory or the stack; no sensible text comes near.
inline constexpr std::size_t kMaximumTextBytes = std::size_t{4} << 20;
inline constexpr int kMaximumNesting = 32;
inline constexpr std::size_t kMaximumListItems = 65536;
inline constexpr std::size_t kMaximumFindings = 200;
inline constexpr std::size_t kMaximumIncludes = 256;

/// Parses with recovery: all syntax errors of the file are in `findings`. Includes stay as they are written.
Document parse(std::string source, std::filesystem::path file);

/// Splices included files in (a path is relative to the including file); a missing file and a cycle are
/// findings.
void resolveIncludes(Document& document);

/// Reads, parses and resolves includes. Throws Error when the file itself cannot be read.
Document parseFile(const std::filesystem::path& file);

/// The one canonical layout. Keeps comments and blank lines; idempotent. Precondition: no findings.
std::string format(const Document& document);

}  // namespace lumivox::dsl

// Meaning of words: tables from which the checker, `lumivox describe` and the generated reference all read.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/dsl/document.h"

namespace lumivox::dsl {

/// The kind of values that a property takes. `oneOrThree`: one number for all channels or axes, or three.
/// `axisAndNumber`: an axis (three plain numbers) and a number with the property's dimension. `name`: a word,
/// path or string that names something. `output`: a.b. `list`: numbers of the dimension, or words, in
/// brackets. `flag`: on or off. `any`: whatever; its owner checks it. In vectors either every component has a
/// unit, or none, or only the last, which then holds for all.
enum class PropertyType {
  number,
  integer,
  vector2,
  vector3,
  oneOrThree,
  axisAndNumber,
  resolution,
  word,
  text,
  name,
  list,
  range,
  output,
  flag,
  any
};

struct PropertySpecification {
  std::string word;
  PropertyType type = PropertyType::number;
  Dimension
      dimension;  ///< of numbers; without a unit: metres, seconds; angles and their speeds must carry one
  double low = -std::numeric_limits<double>::infinity(),
         high = std::numeric_limits<double>::infinity();  ///< inclusive, base units
  std::vector<std::string> choices;                       ///< of words
  std::string defaultText;                                ///< as it would be written; empty: none
  bool required = false;
  bool repeatable = false;
  std::string meaning;
};

enum class HeaderUse { none, optional, required };

struct BlockSpecification {
  std::string word;
  HeaderUse name = HeaderUse::none;
  std::vector<std::string> kinds;  ///< accepted second header values, e.g. area, directional; empty: none
  std::vector<PropertySpecification> properties;  ///< of every kind
  std::vector<std::pair<std::string, std::vector<PropertySpecification>>>
      kindProperties;                      ///< additional ones per kind
  std::vector<BlockSpecification> blocks;  ///< allowed inside
  bool repeatable = true;
  std::string meaning;
  bool anyKind = false;   ///< a kind is required, and any word will do: its owner checks it (TECHNIQUE.PASS)
  bool open = false;      ///< unknown properties are allowed: their owner checks them
  bool required = false;  ///< at least one in the enclosing block or text
};

/// Looks values up in a block that was checked against its specification.
class CheckedBlock {
 public:
  CheckedBlock(const Block& block, const BlockSpecification& specification)
      : block_(&block), specification_(&specification) {}
  const Block& block() const { return *block_; }
  std::string name() const;  ///< from the header; empty when it has none
  std::string kind() const;  ///< the second header value, or the only one where the name was left out
  bool has(const std::string& word) const { return find(word) != nullptr; }
  std::vector<const Block*> blocks(const std::string& word) const;
  const Property* find(const std::string& word) const;
  std::vector<const Property*> findAll(const std::string& word) const;
  double number(const std::string& word, double fallback) const;  ///< in base units
  bool flag(const std::string& word, bool fallback) const;
  /// All numbers of a property in base units; of a `oneOrThree` always three; of a range its two ends.
  std::vector<double> numbers(const std::string& word, std::vector<double> fallback) const;
  std::string text(const std::string& word, std::string fallback) const;

 private:
  const Block* block_;
  const BlockSpecification* specification_;
};

/// The numbers of a property's values in base units, with the unit rule of vectors. Words are skipped.
std::vector<double> numbersInBaseUnits(const Property& property);

/// Checks every top-level item of a text against the blocks allowed there, with everything inside.
void check(const Document& document, const std::vector<BlockSpecification>& allowed,
           std::vector<Diagnostic>& findings);

/// Appends to `findings` everything in `block` that its specification does not allow: unknown, duplicate and
/// missing properties and blocks, wrong types, units of the wrong dimension, values out of range, with the
/// nearest known word.
void check(const Document& document, const Block& block, const BlockSpecification& specification,
           std::vector<Diagnostic>& findings);

/// Checks the values of one property: number of values, types, dimensions, range, choices. A value `$x`
/// passes: its owner binds it first.
void checkProperty(const Document& document, const Property& property,
                   const PropertySpecification& specification, std::vector<Diagnostic>& findings);

/// "a number from 1 to 179 deg", "three numbers", "one of on, off": what a property expects.
std::string expectation(const PropertySpecification& specification);

/// All block and property words in the tables, sorted, each once.
std::vector<std::string> words(const std::vector<BlockSpecification>& specifications);

/// Text for `lumivox describe`: meaning, unit, range and default of a block or property, found anywhere in
/// `specifications`; every place where the word occurs. Empty when it occurs nowhere.
std::string describe(const std::vector<BlockSpecification>& specifications, const std::string& word);
/// Markdown of all tables, for the generated reference.
std::string describeAsMarkdown(const std::vector<BlockSpecification>& specifications);

}  // namespace lumivox::dsl

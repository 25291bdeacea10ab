// Meaning of words: tables from which the checker, `lumivox describe` and the generated reference all read.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/dsl/document.h"

namespace lumivox::dsl {

enum class PropertyType { number, integer, vector2, vector3, resolution, word, text, name, list, range, output, flag };

struct PropertySpecification {
  std::string word;
  PropertyType type = PropertyType::number;
  Dimension dimension;                  ///< of numbers
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices;     ///< of words
  std::string defaultText;              ///< as it would be written; empty: none
  bool required = false;
  bool repeatable = false;
  std::string meaning;
};

enum class HeaderUse { none, optional, required };

struct BlockSpecification {
  std::string word;
  HeaderUse name = HeaderUse::none;
  std::vector<std::string> kinds;       ///< accepted second header values, e.g. area, directional; empty: none
  std::vector<PropertySpecification> properties;        ///< of every kind
  std::vector<std::pair<std::string, std::vector<PropertySpecification>>> kindProperties;  ///< additional ones per kind
  std::vector<BlockSpecification> blocks;               ///< allowed inside
  bool repeatable = true;
  std::string meaning;
};

/// Looks values up in a block that was checked against its specification.
class CheckedBlock {
 public:
  CheckedBlock(const Block& block, const BlockSpecification& specification) : block_(&block), specification_(&specification) {}
  const Block& block() const { return *block_; }
  const Property* find(const std::string& word) const;
  std::vector<const Property*> findAll(const std::string& word) const;
  double number(const std::string& word, double fallback) const;        ///< in base units
  std::vector<double> numbers(const std::string& word, std::vector<double> fallback) const;
  std::string text(const std::string& word, std::string fallback) const;

 private:
  const Block* block_;
  const BlockSpecification* specification_;
};

/// Appends to `findings` everything in `block` that its specification does not allow: unknown, duplicate and missing properties and
/// blocks, wrong types, units of the wrong dimension, values out of range, with the nearest known word.
void check(const Document& document, const Block& block, const BlockSpecification& specification, std::vector<Diagnostic>& findings);

/// Text for `lumivox describe`: meaning, unit, range and default of a block or property, found anywhere in `specifications`.
std::string describe(const std::vector<BlockSpecification>& specifications, const std::string& word);
/// Markdown of all tables, for the generated reference.
std::string describeAsMarkdown(const std::vector<BlockSpecification>& specifications);

}  // namespace lumivox::dsl

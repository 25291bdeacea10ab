#include "scene/block_reader.h"

#include <fmt/format.h>

namespace lumivox {

using dsl::CheckedBlock;
using dsl::Property;

void BlockReader::report(const SourcePlace& place, int length, std::string what, std::string expected,
                         std::string suggestion) {
  findings_.push_back(
      document_.finding(place, length, std::move(what), std::move(expected), std::move(suggestion)));
}

void BlockReader::report(const Property& property, std::string what, std::string expected) {
  report(property.place, static_cast<int>(property.word.size()), std::move(what), std::move(expected));
}

glm::dvec3 BlockReader::vector(const CheckedBlock& block, const char* word, glm::dvec3 fallback) {
  const std::vector<double> values = block.numbers(word, {fallback.x, fallback.y, fallback.z});
  return {values.at(0), values.at(1), values.at(2)};
}

PlacedText BlockReader::placed(const Property& property) {
  const dsl::Value& value = property.values.front();
  return {value.text, value.place, value.length};
}

std::optional<PlacedText> BlockReader::placed(const CheckedBlock& block, const char* word) {
  const Property* property = block.find(word);
  return property == nullptr ? std::nullopt : std::optional(placed(*property));
}

glm::dvec3 BlockReader::direction(const CheckedBlock& block, const char* word, glm::dvec3 fallback) {
  // Range of lengths that can be normalised, with room for squares.
  constexpr double kShortestDirection = 1e-9, kLongestDirection = 2e9;
  const glm::dvec3 value = vector(block, word, fallback);
  const double length = glm::length(value);
  if (length >= kShortestDirection && length <= kLongestDirection) return value / length;
  if (const Property* property = block.find(word)) {
    report(*property,
           length == 0.0
               ? fmt::format("'{}' has length zero", word)
               : fmt::format("'{}' has a length of {:.6g}, of which no direction is left", word, length),
           fmt::format("a direction, with a length from {:.6g} to {:.6g}", kShortestDirection,
                       kLongestDirection));
  }
  return {0, 1, 0};
}

void BlockReader::requireFormat(const PlacedText& file, const char* what,
                                const std::vector<std::string>& formats) {
  if (hasFormat(file.text, formats)) return;
  report(file.place, file.length,
         fmt::format("{} file '{}' has a format that cannot be read", what, file.text),
         fmt::format("one of {}", fmt::join(formats, ", ")));
}

}  // namespace lumivox

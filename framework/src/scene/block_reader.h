// What the readers of a scene text's blocks share: values of properties, and findings at their places.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/dsl/document.h"
#include "lumivox/dsl/schema.h"
#include "scene/description.h"

namespace lumivox {

/// Reads properties of blocks that the grammar accepts. Findings are appended to the vector given.
class BlockReader {
 public:
  BlockReader(const dsl::Document& document, std::vector<Diagnostic>& findings)
      : document_(document), findings_(findings) {}

  void report(const SourcePlace& place, int length, std::string what, std::string expected,
              std::string suggestion = {});
  /// At the word of a property.
  void report(const dsl::Property& property, std::string what, std::string expected);

  static glm::dvec3 vector(const dsl::CheckedBlock& block, const char* word, glm::dvec3 fallback);
  static PlacedText placed(const dsl::Property& property);
  static std::optional<PlacedText> placed(const dsl::CheckedBlock& block, const char* word);
  /// A direction of unit length; a finding if the vector is too short or too long to be normalised.
  glm::dvec3 direction(const dsl::CheckedBlock& block, const char* word, glm::dvec3 fallback);
  /// Refuses a file of another format by its name, before anything is read.
  void requireFormat(const PlacedText& file, const char* what, const std::vector<std::string>& formats);

 protected:
  const dsl::Document& document_;
  std::vector<Diagnostic>& findings_;
};

/// The text of a block `capture`; nothing unless it names its files once.
std::optional<CaptureText> describeCapture(BlockReader& reader, const dsl::CheckedBlock& block);

}  // namespace lumivox

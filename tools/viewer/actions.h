// What can be done in the viewer, as statements of the language of the other texts: controls write them,
// scripts consist of them, and the history is a list of them.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lumivox/dsl/document.h"
#include "lumivox/dsl/schema.h"
#include "lumivox/scene/text.h"

namespace lumivox::viewer {

/// m, from the origin along each axis: nobody goes or looks farther.
inline constexpr double kFarthest = kFarthestPlace;
/// m, between a camera and its target: nearer, the direction between them is lost to rounding.
inline constexpr double kNearest = 1e-9;

/// The grammar: one block, `view NAME { ... }`, whose statements are done in their order.
const std::vector<dsl::BlockSpecification>& viewSpecifications();

/// One statement. `property` or `block` is set, within the document.
struct Action {
  std::shared_ptr<const dsl::Document> document;
  const dsl::Property* property = nullptr;
  const dsl::Block* block = nullptr;

  const std::string& word() const { return property != nullptr ? property->word : block->word; }
  const SourcePlace& place() const { return property != nullptr ? property->place : block->place; }
  // Of properties that were checked:
  double number(std::size_t value = 0) const;  ///< in base units
  std::string text(std::size_t value = 0) const;
  std::vector<double> numbers() const;
  bool flag() const;
  std::string written() const;  ///< as a script has it
};

/// The statements of a script. DiagnosticsError with all findings.
std::vector<Action> readScript(const std::filesystem::path& file);
/// Statements without a block around them.
std::vector<Action> parseActions(const std::string& statements);

/// A text as a value of a statement: in quotation marks.
std::string quoted(const std::string& text);
/// One of the choices of a control: words and numbers as they are, in quotation marks what is neither.
std::string choiceValue(const std::string& choice);

}  // namespace lumivox::viewer

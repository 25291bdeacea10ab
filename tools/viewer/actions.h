// The viewer's actions as statements of the text language. Controls write them, scripts consist of them, and
// the history is a list of them.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lumivox/dsl/document.h"
#include "lumivox/dsl/schema.h"
#include "lumivox/scene/text.h"

namespace lumivox::viewer {

/// m, largest coordinate of a camera's eye and target.
inline constexpr double kFarthest = kFarthestPlace;
/// m, least distance from a camera to its target: below it, rounding loses the direction between them.
inline constexpr double kNearest = 1e-9;

/// The grammar: one block, `view NAME { ... }`, whose statements are performed in order.
const std::vector<dsl::BlockSpecification>& viewSpecifications();

/// One statement. Either `property` or `block` is set, and points into the document.
struct Action {
  std::shared_ptr<const dsl::Document> document;
  const dsl::Property* property = nullptr;
  const dsl::Block* block = nullptr;

  const std::string& word() const { return property != nullptr ? property->word : block->word; }
  const SourcePlace& place() const { return property != nullptr ? property->place : block->place; }
  // For properties that were checked:
  double number(std::size_t value = 0) const;  ///< in base units
  std::string text(std::size_t value = 0) const;
  std::vector<double> numbers() const;
  bool flag() const;
  std::string written() const;  ///< as in a script
};

/// The statements of a script. Throws DiagnosticsError with all findings.
std::vector<Action> readScript(const std::filesystem::path& file);
/// The same for statements without a block around them.
std::vector<Action> parseActions(const std::string& statements);

/// A text as a value of a statement, in quotation marks.
std::string quoted(const std::string& text);
/// A control's choice as a value of a statement: words and numbers unchanged, any other text in quotation
/// marks.
std::string choiceValue(const std::string& choice);

}  // namespace lumivox::viewer

#include "viewer/text_items.h"

#include "lumivox/base/error.h"

namespace lumivox::viewer {

dsl::Document parsedAgain(const dsl::Document& document) {
  return dsl::parse(document.source, document.file);
}

dsl::Item itemOf(const std::string& statement) {
  dsl::Document made = dsl::parse("view \"made\" {\n" + statement + "\n}\n", "made");
  if (!made.findings.empty()) throw DiagnosticsError(made.findings);
  return std::move(made.items.front().block->items.front());
}

void replaceProperty(dsl::Block& block, const dsl::Property& property) {
  for (dsl::Item& item : block.items)
    if (item.property && item.property->word == property.word) {
      item.property->values = property.values;
      return;
    }
  dsl::Item added;
  added.property = property;
  block.items.push_back(std::move(added));
}

void replaceProperty(dsl::Block& block, const std::string& statement) {
  replaceProperty(block, *itemOf(statement).property);
}

}  // namespace lumivox::viewer

// Changing texts item by item.
#pragma once

#include <string>

#include "lumivox/dsl/document.h"

namespace lumivox::viewer {

/// A copy of a document, without findings, for changes: parsed again, since documents cannot be copied.
dsl::Document parsedAgain(const dsl::Document& document);
/// One statement or block as an item. Throws DiagnosticsError if the text is neither.
dsl::Item itemOf(const std::string& statement);
/// Replaces the values of a property, or appends it if the block lacks it.
void replaceProperty(dsl::Block& block, const dsl::Property& property);
void replaceProperty(dsl::Block& block, const std::string& statement);

}  // namespace lumivox::viewer

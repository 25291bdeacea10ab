// Changing texts item by item.
#pragma once

#include <string>

#include "lumivox/dsl/document.h"

namespace lumivox::viewer {

/// A document without findings, to be changed: documents cannot be copied.
dsl::Document parsedAgain(const dsl::Document& document);
/// One statement or block as an item; DiagnosticsError when it is none.
dsl::Item itemOf(const std::string& statement);
/// Gives a property other values, or adds it behind the others.
void replaceProperty(dsl::Block& block, const dsl::Property& property);
void replaceProperty(dsl::Block& block, const std::string& statement);

}  // namespace lumivox::viewer

// One mistake makes one finding.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/dsl/document.h"

namespace lumivox::dsl {

/// The part of a text that braces which are missing or too many make doubtful.
struct Doubts {
  std::map<std::string, int> from;          ///< by file: the line from which blocks may not be what they seem
  std::optional<SourcePlace> surplusBrace;  ///< a '}' that closes nothing
};

/// Reads the document and what it includes once more; empty, and at once, for a document without findings.
Doubts doubtsOf(const Document& document);

/// Drops findings that follow from others: those on the line of a syntax error, and those in doubtful lines.
/// The document's own stay.
void dropConsequences(const Document& document, std::vector<Diagnostic>& findings);

/// One finding for all that stands at the top of a text and belongs into a block that the text lacks: at
/// `item`, the first of it.
void reportOutside(const Document& document, const Item& item, const std::string& block,
                   std::vector<Diagnostic>& findings);

}  // namespace lumivox::dsl

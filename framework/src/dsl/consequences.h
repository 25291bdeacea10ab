// Drops findings that follow from others, so that one mistake makes one finding.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/dsl/document.h"

namespace lumivox::dsl {

/// The part of a text that missing or surplus braces make doubtful.
struct Doubts {
  std::map<std::string, int> from;          ///< by file: the first line whose blocks may be misread
  std::optional<SourcePlace> surplusBrace;  ///< a '}' that closes nothing
};

/// Reads the document and its includes once more. Returns at once for a document without findings.
Doubts doubtsOf(const Document& document);

/// Drops findings on the line of a syntax error and in doubtful lines. The document's own findings stay.
void dropConsequences(const Document& document, std::vector<Diagnostic>& findings);

/// Reports one finding, at `item`, for all top-level items that belong into a missing block.
void reportOutside(const Document& document, const Item& item, const std::string& block,
                   std::vector<Diagnostic>& findings);

}  // namespace lumivox::dsl

#include "dsl/consequences.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace lumivox::dsl {

void dropConsequences(const Document& document, std::vector<Diagnostic>& findings) {
  const auto isAt = [](const Diagnostic& one, const Diagnostic& other) {
    return one.place.line == other.place.line && one.place.file == other.place.file;
  };
  const Doubts doubts = doubtsOf(document);
  const auto follows = [&](const Diagnostic& finding) {
    const auto& own = document.findings;
    if (std::any_of(own.begin(), own.end(), [&](const Diagnostic& other) {
          return other.what == finding.what && other.place.text() == finding.place.text();
        }))
      return false;
    const auto doubtful = doubts.from.find(finding.place.file);
    return (doubtful != doubts.from.end() && finding.place.line >= doubtful->second) ||
           std::any_of(own.begin(), own.end(), [&](const Diagnostic& other) { return isAt(finding, other); });
  };
  std::vector<Diagnostic> kept;
  std::remove_copy_if(findings.begin(), findings.end(), std::back_inserter(kept), follows);
  // Two findings may each seem to follow from the other; a wrong text keeps at least one.
  if (kept.empty() && !findings.empty()) kept.push_back(findings.front());
  findings = std::move(kept);
}

void reportOutside(const Document& document, const Item& item, const std::string& block,
                   std::vector<Diagnostic>& findings) {
  // The closing brace of a block that was never opened is a consequence.
  if (const auto surplus = doubtsOf(document).surplusBrace)
    findings.erase(
        std::remove_if(findings.begin(), findings.end(),
                       [&](const Diagnostic& finding) { return finding.place.text() == surplus->text(); }),
        findings.end());
  const std::string& word = item.block ? item.block->word : item.property->word;
  findings.push_back(document.finding(item.block ? item.block->place : item.property->place,
                                      static_cast<int>(word.size()),
                                      fmt::format("'{}' stands outside of a block '{}'", word, block),
                                      fmt::format("{} ... {{ before it", block)));
}

}  // namespace lumivox::dsl

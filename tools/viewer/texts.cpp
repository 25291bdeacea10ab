// Pipeline texts with the changes of the window.
#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "viewer/session.h"
#include "viewer/text_items.h"

namespace lumivox::viewer {
namespace {

dsl::Block* blockNamed(dsl::Document& document, const std::string& word, const std::string& name) {
  for (dsl::Item& top : document.items) {
    if (!top.block) continue;
    for (dsl::Item& item : top.block->items)
      if (item.block && item.block->word == word && !item.block->header.empty() &&
          item.block->header.front().text == name)
        return item.block.get();
  }
  return nullptr;
}

}  // namespace

Pipeline withPassParameters(const Pipeline& pipeline, const std::string& pass, const dsl::Block& values) {
  dsl::Document document = parsedAgain(*pipeline.document);
  dsl::Block* const block = blockNamed(document, "pass", pass);
  if (block == nullptr) {
    std::vector<std::string> names;
    for (const PassText& one : pipeline.passes) names.push_back(one.name);
    const std::string nearest = nearestWord(pass, names);
    throw Error(fmt::format("set {}: the pipeline has no such pass; expected one of {}{}", pass,
                            fmt::join(names, ", "),
                            nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
  for (const dsl::Item& item : values.items)
    if (item.property) replaceProperty(*block, *item.property);
  return Pipeline::parse(dsl::format(document), pipeline.file);
}

std::string textWithDefaults(const Pipeline& pipeline, const ParameterValues& values) {
  dsl::Document document = parsedAgain(*pipeline.document);
  for (dsl::Item& top : document.items) {
    if (!top.block || top.block->word != "pipeline") continue;
    for (dsl::Item& item : top.block->items) {
      if (!item.property || item.property->word != "param" || item.property->values.size() < 2) continue;
      const auto value = values.find(item.property->values.front().text);
      if (value == values.end()) continue;
      // The number is in base units; only an angle requires its unit.
      std::string written = value->second.text();
      if (value->second.word.empty() && value->second.dimension == dsl::kAngle) written += " rad";
      item.property->values[1] = itemOf("value " + written).property->values.front();
    }
  }
  return dsl::format(document);
}

}  // namespace lumivox::viewer

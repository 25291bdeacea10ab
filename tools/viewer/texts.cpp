// Texts with what was changed in the window.
#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "viewer/session.h"

namespace lumivox::viewer {
namespace {

/// A document without findings, to be changed: documents cannot be copied.
dsl::Document parsedAgain(const dsl::Document& document) {
  return dsl::parse(document.source, document.file);
}

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

dsl::Item propertyItem(const std::string& statement) {
  dsl::Document made = dsl::parse("view \"made\" {\n" + statement + "\n}\n", "made");
  if (!made.findings.empty()) throw DiagnosticsError(made.findings);
  return std::move(made.items.front().block->items.front());
}

void replace(dsl::Block& block, const dsl::Property& property) {
  for (dsl::Item& item : block.items)
    if (item.property && item.property->word == property.word) {
      item.property->values = property.values;
      return;
    }
  dsl::Item added;
  added.property = property;
  block.items.push_back(std::move(added));
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
    if (item.property) replace(*block, *item.property);
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
      // A number in base units, which needs one where angles are.
      std::string written = value->second.text();
      if (value->second.word.empty() && value->second.dimension == dsl::kAngle) written += " rad";
      item.property->values[1] = propertyItem("value " + written).property->values.front();
    }
  }
  return dsl::format(document);
}

std::string textWithCamera(const std::filesystem::path& scene, const Camera& camera, int width, int height) {
  dsl::Document document = dsl::parseFile(scene);
  document = dsl::parse(document.source, scene);  // includes as they are written
  if (!document.findings.empty()) throw DiagnosticsError(document.findings);
  const auto vector = [](const glm::dvec3& value) {
    return fmt::format("{} {} {}", value.x, value.y, value.z);
  };
  std::string text =
      fmt::format("camera view {{\neye {}\ntarget {}\nup {}\nfov {} rad\nresolution {} {}\n",
                  vector(camera.eye), vector(camera.target), vector(camera.up), camera.fov, width, height);
  if (camera.aperture > 0.0) text += fmt::format("aperture {}\nfocus {}\n", camera.aperture, camera.focus);
  dsl::Item item = propertyItem(text + "}");
  for (dsl::Item& top : document.items) {
    if (!top.block || top.block->word != "scene") continue;
    std::vector<dsl::Item>& items = top.block->items;
    std::erase_if(items, [](const dsl::Item& one) {
      return one.block && one.block->word == "camera" && !one.block->header.empty() &&
             one.block->header.front().text == "view";
    });
    items.insert(items.begin(), std::move(item));
    return dsl::format(document);
  }
  throw Error(fmt::format("{}: no block `scene`", scene.string()));
}

}  // namespace lumivox::viewer

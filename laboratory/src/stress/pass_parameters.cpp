#include "stress/pass_parameters.h"

#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"

namespace lumivox::stress {
namespace {

const dsl::Property* propertyOf(const dsl::Block& block, const std::string& word) {
  for (const dsl::Item& item : block.items)
    if (item.property && item.property->word == word) return &*item.property;
  return nullptr;
}

dsl::Block* passBlock(std::vector<dsl::Item>& items, const std::string& name) {
  for (dsl::Item& item : items) {
    if (!item.block) continue;
    if (item.block->word == "pass" && !item.block->header.empty() && item.block->header[0].text == name)
      return item.block.get();
    if (dsl::Block* inside = passBlock(item.block->items, name)) return inside;
  }
  return nullptr;
}

}  // namespace

std::vector<PassParameter> allPassParameters(const Pipeline& pipeline, TechniqueSource& techniques) {
  std::vector<PassParameter> all;
  for (const PassText& text : pipeline.passes) {
    const Technique* technique = techniques.technique(text.technique);
    const PassEntry* entry = technique == nullptr ? nullptr : technique->find(text.pass);
    if (entry == nullptr) continue;
    const std::unique_ptr<Pass> pass = entry->make();
    const dsl::Property* form = propertyOf(*text.block, "as_published");
    const bool asPublished = form != nullptr && !form->values.empty() && form->values[0].text == "on";
    for (const ParamBase* parameter : pass->parameters()) {
      const dsl::Property* set = propertyOf(*text.block, parameter->name());
      PassParameter one{text.name + "." + parameter->name(),
                        parameter->type(),
                        parameter->low(),
                        parameter->high(),
                        parameter->choices(),
                        parameter->defaultText()};
      if (parameter->type() == ParamBase::Type::flag) one.words = {"off", "on"};
      if (set != nullptr && !set->values.empty()) {
        one.value = set->values[0].written();
        one.bound = set->values[0].kind == dsl::ValueKind::parameter;
      }
      if (asPublished && !parameter->publishedText().empty()) one.bound = true;
      all.push_back(std::move(one));
    }
  }
  return all;
}

std::vector<PassParameter> freePassParameters(const Pipeline& pipeline, TechniqueSource& techniques) {
  std::vector<PassParameter> free = allPassParameters(pipeline, techniques);
  std::erase_if(free, [](const PassParameter& one) { return one.bound; });
  return free;
}

Pipeline withPassParameters(const Pipeline& pipeline, const ParameterValues& values) {
  dsl::Document document = dsl::parse(pipeline.document->source, pipeline.file);
  dsl::resolveIncludes(document);
  for (const auto& [name, value] : values) {
    const std::size_t dot = name.find('.');
    dsl::Block* block = dot == std::string::npos ? nullptr : passBlock(document.items, name.substr(0, dot));
    if (block == nullptr)
      throw Error(fmt::format("pipeline \"{}\" has no pass for the parameter '{}'; expected pass.parameter",
                              pipeline.name, name));
    // The parser makes the value; a number without a unit is in base units.
    dsl::Document made = dsl::parse("pass p t.q { " + name.substr(dot + 1) + " " + value.text() + " }", "");
    auto& items = block->items;
    items.erase(std::remove_if(items.begin(), items.end(),
                               [&](const dsl::Item& item) {
                                 return item.property && item.property->word == name.substr(dot + 1);
                               }),
                items.end());
    items.push_back(std::move(made.items.at(0).block->items.at(0)));
  }
  return Pipeline::parse(dsl::format(document), pipeline.file);
}

}  // namespace lumivox::stress

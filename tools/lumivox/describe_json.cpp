#include "describe_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "lumivox/dsl/schema.h"
#include "lumivox/pipeline/sweep_text.h"
#include "lumivox/results/reproduction.h"
#include "lumivox/scene/text.h"
#include "viewer/actions.h"

namespace lumivox::command {
namespace {

/// In the order of dsl::PropertyType.
constexpr std::array kPropertyTypes = {
    "number",     "integer", "vector2", "vector3", "one_or_three", "axis_and_number",
    "resolution", "word",    "text",    "name",    "list",         "range",
    "output",     "flag",    "any"};
static_assert(kPropertyTypes.size() == static_cast<std::size_t>(dsl::PropertyType::any) + 1);

std::string baseUnit(const dsl::Dimension& dimension) {
  for (const dsl::Unit& unit : dsl::knownUnits())
    if (unit.dimension == dimension && unit.toBase == 1.0) return unit.name;
  return {};
}

/// A range's end that was declared as a float: 0.05 and not 0.05000000074505806.
double given(double number) {
  return std::isfinite(number) ? std::stod(fmt::format("{:.7g}", number)) : number;
}

/// "40 deg" becomes 0.698..., "0 1 0" three numbers, "on" true; any other word stays a string. A unit applies
/// to the numbers before it.
Json valueOf(const std::string& text) {
  if (text == "on" || text == "off") return text == "on";
  std::istringstream words(text);
  std::vector<double> numbers;
  std::size_t withoutUnit = 0;
  for (std::string word; words >> word;) {
    char* end = nullptr;
    const double number = std::strtod(word.c_str(), &end);
    if (end != word.c_str() && *end == '\0') {
      numbers.push_back(number);
      continue;
    }
    const auto unit = std::find_if(dsl::knownUnits().begin(), dsl::knownUnits().end(),
                                   [&](const dsl::Unit& one) { return one.name == word; });
    if (unit == dsl::knownUnits().end() || numbers.empty()) return text;
    for (; withoutUnit < numbers.size(); ++withoutUnit) numbers[withoutUnit] *= unit->toBase;
  }
  if (numbers.empty()) return text.empty() ? Json() : Json(text);
  return numbers.size() == 1 ? Json(numbers.front()) : Json(numbers);
}

/// Adds the range of a number. An infinite end is left out.
void addRange(Json& json, double low, double high, const std::string& unit) {
  if (std::isfinite(low)) json["low"] = low;
  if (std::isfinite(high)) json["high"] = high;
  if (!unit.empty()) json["unit"] = unit;
}

Json property(const dsl::PropertySpecification& one) {
  Json json = {{"word", one.word},
               {"meaning", one.meaning},
               {"type", kPropertyTypes[static_cast<std::size_t>(one.type)]},
               {"expected", dsl::expectation(one)},
               {"required", one.required},
               {"repeatable", one.repeatable}};
  addRange(json, one.low, one.high, baseUnit(one.dimension));
  if (!one.choices.empty()) json["choices"] = one.choices;
  if (!one.defaultText.empty()) json["default"] = valueOf(one.defaultText);
  return json;
}

Json properties(const std::vector<dsl::PropertySpecification>& all) {
  Json list = Json::array();
  for (const dsl::PropertySpecification& one : all) list.push_back(property(one));
  return list;
}

Json block(const dsl::BlockSpecification& one) {
  Json json = {{"word", one.word},
               {"meaning", one.meaning},
               {"name", one.name == dsl::HeaderUse::required   ? "required"
                        : one.name == dsl::HeaderUse::optional ? "optional"
                                                               : "none"},
               {"properties", properties(one.properties)},
               {"blocks", Json::array()}};
  for (const dsl::BlockSpecification& inner : one.blocks) json["blocks"].push_back(inner.word);
  for (const auto& [kind, own] : one.kindProperties) json["kinds"][kind] = properties(own);
  return json;
}

Json headed(const char* what, Json json) {
  json["what"] = what;
  return json;
}

/// Finds the blocks and properties of this word. `path`: the blocks around them.
void findInTexts(const std::vector<dsl::BlockSpecification>& blocks, const std::string& word,
                 std::vector<std::string>& path, Json& found) {
  const auto add = [&](const char* what, Json json) {
    json["in"] = path;
    found.push_back(headed(what, std::move(json)));
  };
  for (const dsl::BlockSpecification& one : blocks) {
    if (one.word == word) add("block", block(one));
    path.push_back(one.word);
    const auto addProperties = [&](const std::vector<dsl::PropertySpecification>& all) {
      for (const dsl::PropertySpecification& inner : all)
        if (inner.word == word) add("property", property(inner));
    };
    addProperties(one.properties);
    for (const auto& [kind, own] : one.kindProperties) {
      path.back() = one.word + ' ' + kind;
      addProperties(own);
    }
    path.back() = one.word;
    findInTexts(one.blocks, word, path, found);
    path.pop_back();
  }
}

Json kind(const PortKind& one) {
  Json json = {{"word", one.name},        {"meaning", one.meaning},    {"contains", Json::array()},
               {"heeded", Json::array()}, {"exported", Json::array()}, {"occupied", one.occupancy}};
  for (const PortResource& resource : one.resources)
    json["contains"].push_back({{"name", resource.name},
                                {"shape", resource.shape},
                                {"meaning", resource.meaning},
                                {"may_be_negative", resource.sign == PortResource::Sign::any}});
  for (const PortCondition& condition : one.conditions)
    json["heeded"].push_back({{"member", condition.member},
                              {"meaning", condition.meaning},
                              {"otherwise", condition.otherwise},
                              {"readers", condition.readers}});
  for (const PortField& field : one.fields)
    json["exported"].push_back({{"name", field.name}, {"unit", field.unit}, {"quantity", field.quantity}});
  return json;
}

const char* levelsName(Levels levels) {
  return levels == Levels::all ? "all" : levels == Levels::finest ? "finest" : "unspecified";
}

Json input(const InBase& one) {
  Json json = {{"word", one.name()},
               {"meaning", one.meaning()},
               {"kind", one.kind().name},
               {"required", one.presence() == Presence::required},
               {"history", one.presence() == Presence::history},
               {"levels", levelsName(one.expects().levels)},
               {"needs", unmetNeed(one.needs(), SceneTraits{})}};
  if (one.expects().component) json["component"] = name(*one.expects().component);
  return json;
}

Json output(const OutBase& one) {
  return {{"word", one.name()},
          {"meaning", one.meaning()},
          {"kind", one.kind().name},
          {"component", name(one.contributes())},
          {"levels", levelsName(one.levels())}};
}

Json parameter(const ParamBase& one) {
  constexpr std::array types = {"integer", "number", "flag", "word"};
  Json json = {{"word", one.name()},
               {"meaning", one.meaning()},
               {"type", types[static_cast<std::size_t>(one.type())]},
               {"default", valueOf(one.defaultText())}};
  if (one.choices().empty())
    addRange(json, given(one.low()), given(one.high()), one.unit());
  else if (one.type() == ParamBase::Type::word)
    json["choices"] = one.choices();
  if (const std::string printed = one.publishedText(); !printed.empty()) json["published"] = valueOf(printed);
  return json;
}

Json pass(const std::string& technique, const PassEntry& entry, const Pass& one) {
  Json json = {{"word", technique + "." + entry.name},
               {"meaning", entry.meaning},
               {"indirect_bounces", one.indirectBounces()},
               {"works_on_host", one.worksOnHost()},
               {"inputs", Json::array()},
               {"outputs", Json::array()},
               {"parameters", Json::array()}};
  for (const InBase* member : one.inputs()) json["inputs"].push_back(input(*member));
  for (const OutBase* member : one.outputs()) json["outputs"].push_back(output(*member));
  for (const ParamBase* member : one.parameters()) json["parameters"].push_back(parameter(*member));
  return json;
}

void findInTechniques(TechniqueSet& techniques, const std::string& word, Json& found) {
  for (const std::string& name : techniques.available()) {
    const Technique* technique = name == word ? techniques.technique(name) : nullptr;
    if (technique == nullptr) continue;
    Json passes = Json::array();
    for (const PassEntry& entry : technique->passes) passes.push_back(entry.name);
    found.push_back(headed(
        "technique",
        {{"word", name}, {"meaning", technique->meaning}, {"paper", technique->paper}, {"passes", passes}}));
  }
  forEachPass(techniques, [&](const Technique& technique, const PassEntry& entry) {
    const std::string full = technique.name + "." + entry.name;
    const std::unique_ptr<Pass> made = entry.make();
    if (word == entry.name || word == full) {
      found.push_back(headed("pass", pass(technique.name, entry, *made)));
      return;
    }
    const auto members = [&](const char* what, const auto& all, const auto& toJson) {
      for (const auto* one : all)
        if (one->name() == word) {
          found.push_back(headed(what, toJson(*one)));
          found.back()["pass"] = full;
        }
    };
    members("input", made->inputs(), input);
    members("output", made->outputs(), output);
    members("parameter", made->parameters(), parameter);
  });
}

}  // namespace

std::vector<const PortKind*> portKinds(TechniqueSet& techniques, std::vector<std::unique_ptr<Pass>>& passes) {
  std::vector<const PortKind*> kinds = FrameworkPorts::kinds();
  const auto add = [&](const PortBase* port) {
    if (std::none_of(kinds.begin(), kinds.end(),
                     [&](const PortKind* kind) { return kind->isSameType(port->kind()); }))
      kinds.push_back(&port->kind());
  };
  forEachPass(techniques, [&](const Technique&, const PassEntry& entry) {
    passes.push_back(entry.make());
    for (const InBase* input : passes.back()->inputs()) add(input);
    for (const OutBase* output : passes.back()->outputs()) add(output);
  });
  return kinds;
}

Json describedAsJson(TechniqueSet& techniques, const std::string& word) {
  Json found = Json::array();
  for (const auto* specifications :
       {&sceneSpecifications(), &pipelineSpecifications(), &sweepSpecifications(),
        &reproductionSpecifications(), &viewer::viewSpecifications()}) {
    std::vector<std::string> path;
    findInTexts(*specifications, word, path, found);
  }
  std::vector<std::unique_ptr<Pass>> passes;
  for (const PortKind* one : portKinds(techniques, passes))
    if (one->name == word) found.push_back(headed("port kind", kind(*one)));
  findInTechniques(techniques, word, found);
  return {{"word", word}, {"found", found}};
}

}  // namespace lumivox::command

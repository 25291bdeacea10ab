// Reads pipeline texts as far as that needs no technique library.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "dsl/consequences.h"
#include "lumivox/base/findings.h"
#include "lumivox/pipeline/pipeline.h"
#include "pipeline/read_sweep.h"
#include "pipeline/text_values.h"

namespace lumivox {

namespace {

/// Limit for the passes, parameters, outputs and sweeps of a pipeline, each: far above useful texts. Binding
/// searches each among all others, which stays fast up to this number.
constexpr std::size_t kMostOfAKind = 1000;

dsl::PropertySpecification property(const std::string& word, dsl::PropertyType type,
                                    const std::string& meaning) {
  dsl::PropertySpecification specification;
  specification.word = word;
  specification.type = type;
  specification.repeatable = true;
  specification.meaning = meaning;
  return specification;
}

std::vector<dsl::BlockSpecification> makeSpecifications() {
  dsl::BlockSpecification pass;
  pass.word = "pass";
  pass.name = dsl::HeaderUse::required;
  pass.meaning =
      "`pass NAME TECHNIQUE.PASS { ... }`: one stage of a technique. Inside, a word is an input of the pass "
      "followed by "
      "`pass.port` (or by the name of a pass that has one fitting output), or a parameter followed by its "
      "value: a "
      "number with its unit, a word, on or off, or `$name` for a parameter of the pipeline. `lumivox "
      "describe "
      "TECHNIQUE.PASS` lists both.";

  dsl::BlockSpecification pipeline;
  pipeline.word = "pipeline";
  pipeline.name = dsl::HeaderUse::required;
  pipeline.repeatable = false;
  pipeline.meaning = "A chain of passes from a scene to images. It names techniques, never geometry.";
  pipeline.properties = {
      property(
          "param", dsl::PropertyType::name,
          "`param NAME DEFAULT in LOW..HIGH` or `param NAME DEFAULT in [a b c]`: a value that passes read as "
          "`$NAME`, that --set NAME=VALUE changes and that a sweep varies."),
      property(
          "output", dsl::PropertyType::output,
          "`output NAME pass.port`: an image that the pipeline delivers under this name. A pipeline whose "
          "passes make no part of an image, a voxelizer for instance, needs none.")};
  pipeline.blocks = {pass};

  return {pipeline, sweepSpecification(SweepHome::pipeline)};
}

/// Collects the content of one text and every finding in it.
class TextReader : TextFindings {
 public:
  TextReader(Pipeline& pipeline, const dsl::Document& document, std::vector<Diagnostic>& findings)
      : TextFindings(document, findings), pipeline_(pipeline) {}

  void read() {
    const dsl::Block* main = nullptr;
    const bool hasMain =
        std::any_of(document_.items.begin(), document_.items.end(), [](const dsl::Item& item) {
          return item.block ? item.block->word == "pipeline" : item.property->word == "pipeline";
        });
    for (const dsl::Item& item : document_.items) {
      const std::string& word = item.block ? item.block->word : item.property->word;
      if (!hasMain && (word == "pass" || word == "param" || word == "output")) {
        dsl::reportOutside(document_, item, "pipeline", findings_);
        return;
      }
      if (item.property) {
        report(item.property->place, item.property->word,
               fmt::format("unknown statement '{}'", item.property->word),
               "a pipeline or sweep block, or an include",
               suggestionFor(findings_, item.property->word, {"pipeline", "sweep"}));
      } else if (item.block->word == "pipeline") {
        if (main != nullptr)
          report(item.block->place, "pipeline", "a second pipeline in one text", "one per file");
        if (main == nullptr) main = item.block.get();
      } else if (item.block->word != "sweep") {
        report(item.block->place, item.block->word, fmt::format("unknown block '{}'", item.block->word),
               "pipeline or sweep", suggestionFor(findings_, item.block->word, {"pipeline", "sweep"}));
      }
    }
    if (main != nullptr) {
      readPipeline(*main);
    } else if (findings_.empty()) {
      findings_.push_back(document_.finding({document_.file.string(), 0, 0}, 1,
                                            "the text has no pipeline block", "pipeline \"Name\" { ... }"));
    }
    for (const dsl::Item& item : document_.items) {
      if (item.block && item.block->word == "sweep" && main != nullptr) readSweep(*item.block);
    }
    // A refused pass may use a parameter, so unused ones are reported only without findings.
    if (findings_.empty()) warnOfUnused();
  }

 private:
  void readPipeline(const dsl::Block& block) {
    if (block.header.size() != 1 ||
        (block.header[0].kind != dsl::ValueKind::text && !block.header[0].isPlainWord())) {
      report(block.place, block.word, "the pipeline needs one name", "pipeline \"Name\" { ... }");
    } else {
      pipeline_.name = block.header[0].text;
    }
    for (const dsl::Item& item : block.items) {
      if (item.block) {
        if (item.block->word == "pass") {
          readPass(*item.block);
        } else {
          report(item.block->place, item.block->word,
                 fmt::format("unknown block '{}' in a pipeline", item.block->word), "pass",
                 nearestWord(item.block->word, {"pass"}));
        }
      } else if (item.property->word == "param") {
        readParameter(*item.property);
      } else if (item.property->word == "output") {
        readOutput(*item.property);
      } else {
        const std::string nearest = nearestWord(item.property->word, {"param", "pass", "output"});
        if (nearest == "param") noteRefused(*item.property);
        report(item.property->place, item.property->word,
               fmt::format("unknown property '{}' in a pipeline", item.property->word),
               "param, pass or output", nearest);
      }
    }
    if (pipeline_.passes.empty() && findings_.empty())
      report(block.place, block.word, "the pipeline has no pass", "pass NAME TECHNIQUE.PASS { ... }");
  }

  void readPass(const dsl::Block& block) {
    static const char* const kForm = "pass NAME TECHNIQUE.PASS { ... }";
    const auto& header = block.header;
    if (header.size() != 2 || !header[0].isPlainWord()) {
      report(block.place, block.word, "a pass needs its own name and that of a technique's pass", kForm);
      return;
    }
    const auto parts = splitDotted(header[1]);
    if (!parts) {
      report(header[1].place, header[1].length, "a technique and one of its passes are needed here", kForm);
      return;
    }
    for (const PassText& other : pipeline_.passes) {
      if (other.name == header[0].text) {
        report(header[0].place, header[0].length, fmt::format("a second pass named '{}'", other.name),
               fmt::format("another name; the first is at {}", other.place.text()));
      }
    }
    if (!hasRoom(pipeline_.passes, block.place, block.word)) return;
    pipeline_.passes.push_back({header[0].text, parts->first, parts->second, header[0].place, &block});
    for (const dsl::Item& item : block.items) {
      if (!item.property) continue;
      for (const dsl::Value& value : item.property->values) {
        if (value.kind == dsl::ValueKind::parameter) usedParameters_.insert(value.text);
      }
    }
  }

  /// Whether another item of a kind is allowed; reports the first that is not.
  template <class All>
  bool hasRoom(const All& all, const SourcePlace& place, const std::string& word) {
    if (all.size() < kMostOfAKind) return true;
    if (full_.insert(word).second)
      report(place, word, fmt::format("too many blocks or properties '{}'", word),
             fmt::format("at most {} in a pipeline", kMostOfAKind));
    return false;
  }

  /// Remembers a parameter whose declaration was refused, so that its uses get no finding.
  void noteRefused(const dsl::Property& property) {
    if (!property.values.empty() && property.values[0].isPlainWord())
      refusedParameters_.insert(property.values[0].text);
  }

  void readParameter(const dsl::Property& property) {
    static const char* const kForm = "param NAME DEFAULT in LOW..HIGH, or in [a b c]";
    const auto& values = property.values;
    const bool ranged = values.size() == 4 && values[2].isPlainWord() && values[2].text == "in" &&
                        (isNumberRange(values[3]) || values[3].kind == dsl::ValueKind::list);
    const auto value = values.size() >= 2 ? parameterValue(values[1]) : std::nullopt;
    if (values.empty() || !values[0].isPlainWord() || !value || (values.size() != 2 && !ranged)) {
      noteRefused(property);
      report(property.place, property.word, "malformed param", kForm);
      return;
    }
    PipelineParameter parameter;
    parameter.name = values[0].text;
    parameter.value = *value;
    if (ranged && values[3].kind == dsl::ValueKind::range) {
      parameter.low = values[3].items.at(0).inBaseUnits();
      parameter.high = values[3].items.at(1).inBaseUnits();
      for (const dsl::Value& end : values[3].items) {
        const dsl::Dimension dimension = end.unit ? end.unit->dimension : dsl::Dimension{};
        if (dimension != value->dimension) {
          const auto text = [](const dsl::Dimension& one) {
            return one == dsl::kNoDimension ? std::string("no unit") : "a unit of " + one.text();
          };
          report(values[3].place, values[3].length, fmt::format("the range has {}", text(dimension)),
                 fmt::format("{}, as the default", text(value->dimension)));
          break;
        }
      }
    } else if (ranged) {
      for (const dsl::Value& choice : values[3].items) {
        if (const auto one = parameterValue(choice)) {
          parameter.choices.push_back(one->text());
        } else {
          report(choice.place, choice.length, "this cannot be a choice", "numbers or words");
        }
      }
    }
    if (const std::string misfit = parameter.misfit(*value); !misfit.empty()) {
      report(values[1].place, values[1].length,
             fmt::format("the default of '{}' is {}, which does not fit", parameter.name, value->text()),
             misfitExpectation(misfit));
    }
    for (const char* word : {kSweptScenes, kSweptPipelines, kSweptSeeds, kAccumulatedFrames}) {
      if (parameter.name == word)
        report(values[0].place, values[0].length, fmt::format("'{}' is a reserved word of sweeps", word),
               "another name for the parameter");
    }
    for (const PipelineParameter& other : pipeline_.parameters) {
      if (other.name == parameter.name) {
        report(values[0].place, values[0].length, fmt::format("a second parameter named '{}'", other.name));
      }
    }
    if (!hasRoom(pipeline_.parameters, property.place, property.word)) return;
    parameterPlaces_.push_back(values[0].place);
    pipeline_.parameters.push_back(std::move(parameter));
  }

  void readOutput(const dsl::Property& property) {
    const auto& values = property.values;
    if (values.size() != 2 || !values[0].isPlainWord() || values[1].kind != dsl::ValueKind::word) {
      report(property.place, property.word, "malformed output", "output NAME pass.port");
      return;
    }
    for (const Pipeline::Output& other : pipeline_.outputs) {
      if (other.name == values[0].text) {
        report(values[0].place, values[0].length, fmt::format("a second output named '{}'", other.name),
               fmt::format("another name; the first is at {}", other.place.text()));
      }
    }
    const auto parts = splitDotted(values[1]);
    if (!parts) {
      report(values[1].place, values[1].length, "this is not an output of a pass", "pass.port");
      return;
    }
    if (!hasRoom(pipeline_.outputs, property.place, property.word)) return;
    pipeline_.outputs.push_back({values[0].text, parts->first, parts->second, values[1].place});
  }

  void readSweep(const dsl::Block& block) {
    const SweepBlock read = readSweepBlock(document_, block, SweepHome::pipeline, findings_);
    for (const Sweep& other : pipeline_.sweeps) {
      if (other.name == read.name)
        report(block.place, block.word, fmt::format("a second sweep named '{}'", read.name));
    }
    if (!hasRoom(pipeline_.sweeps, block.place, block.word)) return;
    std::vector<const SweepAxis*> unknown;
    pipeline_.sweeps.push_back(fittedSweep(read, pipeline_, document_, findings_, unknown));
    const std::vector<std::string> names = parameterNames(pipeline_);
    for (const SweepAxis* axis : unknown)
      if (!refusedParameters_.contains(axis->parameter))
        report(axis->place, axis->parameter, fmt::format("unknown parameter '{}'", axis->parameter),
               oneOf(names, "a parameter, but this pipeline declares none"),
               suggestionFor(findings_, axis->parameter, names));
  }

  void warnOfUnused() {
    // A misspelt use has its own finding.
    for (const std::string& used : usedParameters_)
      if (findParameter(pipeline_, used) == nullptr) return;
    for (std::size_t i = 0; i < pipeline_.parameters.size(); ++i) {
      const std::string& name = pipeline_.parameters[i].name;
      if (usedParameters_.contains(name)) continue;
      report(parameterPlaces_[i], name, fmt::format("no pass uses the parameter '{}'", name),
             "$" + name + " in a pass");
      findings_.back().severity = Diagnostic::Severity::warning;
    }
  }

  Pipeline& pipeline_;
  std::vector<SourcePlace> parameterPlaces_;
  std::set<std::string> usedParameters_, refusedParameters_;
  std::set<std::string> full_;  ///< kinds of items that exceed their limit
};

Pipeline pipelineOf(dsl::Document parsed) {
  Pipeline pipeline;
  const auto document = std::make_shared<const dsl::Document>(std::move(parsed));
  pipeline.file = document->file;
  pipeline.document = document;
  Hasher hasher;
  hasher.add(document->source);
  for (const auto& included : document->includedFiles)
    hasher.add(document->includedSources.at(included.string()));
  pipeline.hash = hasher.finish();
  std::vector<Diagnostic> findings = document->findings;
  TextReader(pipeline, *document, findings).read();
  dsl::dropConsequences(*document, findings);
  throwOrLog(std::move(findings));
  return pipeline;
}

}  // namespace

// ---- values --------------------------------------------------------------------------------------------

void TextFindings::report(const SourcePlace& place, int length, std::string what, std::string expected,
                          std::string suggestion) {
  findings_.push_back(
      document_.finding(place, length, std::move(what), std::move(expected), std::move(suggestion)));
}

void TextFindings::report(const SourcePlace& place, const std::string& word, std::string what,
                          std::string expected, std::string suggestion) {
  report(place, static_cast<int>(word.size()), std::move(what), std::move(expected), std::move(suggestion));
}

std::filesystem::path besideText(const dsl::Value& value) {
  return (std::filesystem::path(value.place.file).parent_path() / value.text).lexically_normal();
}

std::optional<std::pair<std::string, std::string>> splitDotted(const dsl::Value& value) {
  if (value.kind != dsl::ValueKind::word) return std::nullopt;
  const std::size_t dot = value.text.find('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == value.text.size()) return std::nullopt;
  const std::string second = value.text.substr(dot + 1);
  if (second.find_first_of("./") != std::string::npos || value.text.find('/') < dot) return std::nullopt;
  return std::pair(value.text.substr(0, dot), second);
}

std::optional<ParameterValue> parameterValue(const dsl::Value& value) {
  ParameterValue result;
  if (value.kind == dsl::ValueKind::number) {
    result.number = value.inBaseUnits();
    if (value.unit) result.dimension = value.unit->dimension;
    return result;
  }
  if (value.isPlainWord() || (value.kind == dsl::ValueKind::text && !value.text.empty())) {
    result.word = value.text;
    return result;
  }
  return std::nullopt;
}

bool isNumberRange(const dsl::Value& value) {
  return value.kind == dsl::ValueKind::range && value.items.at(0).kind == dsl::ValueKind::number &&
         value.items.at(1).kind == dsl::ValueKind::number;
}

const PipelineParameter* findParameter(const Pipeline& pipeline, const std::string& name) {
  for (const PipelineParameter& parameter : pipeline.parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

std::vector<std::string> parameterNames(const Pipeline& pipeline) {
  std::vector<std::string> names;
  for (const PipelineParameter& parameter : pipeline.parameters) names.push_back(parameter.name);
  return names;
}

std::string oneOf(const std::vector<std::string>& words, const std::string& otherwise) {
  if (words.empty()) return otherwise;
  if (words.size() == 1) return words.front();
  return "one of " + listed(words);
}

std::string misfitExpectation(const std::string& misfit) {
  static const std::string kMust = "must be ";
  return misfit.rfind(kMust, 0) == 0 ? misfit.substr(kMust.size()) : misfit;
}

void throwOrLog(std::vector<Diagnostic> findings) {
  const bool anyError = std::any_of(findings.begin(), findings.end(), [](const Diagnostic& finding) {
    return finding.severity == Diagnostic::Severity::error;
  });
  if (anyError) throw DiagnosticsError(std::move(findings));
  for (const Diagnostic& finding : findings) logFinding(finding);
}

// ---- public --------------------------------------------------------------------------------------------

std::string ParameterValue::text() const {
  return word.empty() ? fmt::format("{}", number) : word;
}

std::string PipelineParameter::misfit(const ParameterValue& candidate) const {
  if (!choices.empty()) {
    const bool known = std::find(choices.begin(), choices.end(), candidate.text()) != choices.end();
    return known ? std::string() : fmt::format("must be one of {}", fmt::join(choices, ", "));
  }
  const std::string range = low ? fmt::format(" in {}..{}", *low, *high) : std::string();
  if (candidate.word.empty() != value.word.empty()) {
    return value.word.empty() ? "must be a number" + range : "must be a word";
  }
  if (!candidate.word.empty()) return {};
  // A number without a unit is in base units, so only a unit of another dimension is wrong.
  if (candidate.dimension != dsl::Dimension{} && candidate.dimension != value.dimension) {
    return value.dimension == dsl::kNoDimension
               ? std::string("must be a number without a unit")
               : fmt::format("must be a number that measures {}", value.dimension.text());
  }
  const bool inside =
      std::isfinite(candidate.number) && (!low || (candidate.number >= *low && candidate.number <= *high));
  return inside ? std::string() : "must be a number" + range;
}

const std::vector<dsl::BlockSpecification>& pipelineSpecifications() {
  static const std::vector<dsl::BlockSpecification> specifications = makeSpecifications();
  return specifications;
}

Pipeline Pipeline::load(const std::filesystem::path& file) {
  return pipelineOf(dsl::parseFile(file));
}

Pipeline Pipeline::parse(std::string source, std::filesystem::path file) {
  dsl::Document document = dsl::parse(std::move(source), std::move(file));
  dsl::resolveIncludes(document);
  return pipelineOf(std::move(document));
}

ParameterValues Pipeline::settings(const std::vector<std::string>& assignments) const {
  ParameterValues values;
  for (const std::string& assignment : assignments) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw Error(fmt::format("setting '{}': expected NAME=VALUE", assignment));
    }
    const std::string parameterName = assignment.substr(0, equals), text = assignment.substr(equals + 1);
    const PipelineParameter* parameter = findParameter(*this, parameterName);
    if (parameter == nullptr) {
      const std::vector<std::string> names = parameterNames(*this);
      const std::string nearest = nearestWord(parameterName, names);
      throw Error(fmt::format("setting '{}': pipeline \"{}\" has no parameter '{}'; expected {}{}",
                              assignment, name, parameterName,
                              oneOf(names, "no setting, since it declares no parameters"),
                              nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
    // The text's own parser reads the value, so that units work alike.
    const dsl::Document parsed = dsl::parse("value " + text + "\n", "--set");
    std::optional<ParameterValue> value;
    if (parsed.findings.empty() && parsed.items.size() == 1 && parsed.items[0].property &&
        parsed.items[0].property->values.size() == 1) {
      value = parameterValue(parsed.items[0].property->values[0]);
    }
    const std::string misfit = value ? parameter->misfit(*value) : std::string("must be a number or a word");
    if (!misfit.empty()) throw Error(fmt::format("setting '{}': the value {}", assignment, misfit));
    value->dimension = parameter->value.dimension;
    values[parameterName] = *value;
  }
  return values;
}

std::vector<std::string> Pipeline::techniques() const {
  std::vector<std::string> names;
  for (const PassText& pass : passes) {
    if (std::find(names.begin(), names.end(), pass.technique) == names.end()) names.push_back(pass.technique);
  }
  return names;
}

}  // namespace lumivox

// Binds a pipeline text: its words become passes, parameters and connections. All findings are collected, and
// nothing runs.
#include "pipeline/graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>

#include "pipeline/text_values.h"

namespace lumivox {

namespace {

template <class Named>
std::vector<std::string> namesOf(const std::vector<Named*>& members) {
  std::vector<std::string> names;
  for (const Named* member : members) names.push_back(member->name());
  return names;
}

template <class Named>
int indexOf(const std::vector<Named*>& members, const std::string& name) {
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (members[i]->name() == name) return static_cast<int>(i);
  }
  return -1;
}

/// "diffuse (Image), grid (RadianceGrid)"
std::string portsText(const Pass& pass) {
  std::vector<std::string> texts;
  for (const OutBase* output : pass.outputs())
    texts.push_back(fmt::format("{} ({})", output->name(), output->kind().name));
  return oneOf(texts, "nothing, since the pass has no outputs");
}

dsl::Dimension dimensionOf(const ParamBase& parameter) {
  for (const dsl::Unit& unit : dsl::knownUnits()) {
    if (unit.name == parameter.unit()) return unit.dimension;
  }
  return {};
}

class Binder {
 public:
  Binder(const Pipeline& pipeline, TechniqueSource& techniques, const ParameterValues& values)
      : pipeline_(pipeline), techniques_(techniques), values_(values) {}

  BoundGraph bind() {
    checkValues();
    for (const PassText& text : pipeline_.passes) graph_.passes.push_back(makePass(text));
    for (std::size_t i = 0; i < graph_.passes.size(); ++i) {
      if (graph_.passes[i].object) bindPass(static_cast<int>(i));
    }
    bindOutputs();
    schedule();
    throwOrLog(std::move(findings_));
    connectInputs(graph_);
    return std::move(graph_);
  }

 private:
  void report(const SourcePlace& place, int length, std::string what, std::string expected = {},
              std::string suggestion = {}) {
    findings_.push_back(pipeline_.document->finding(place, length, std::move(what), std::move(expected),
                                                    std::move(suggestion)));
  }
  void report(const PassText& pass, std::string what, std::string expected = {},
              std::string suggestion = {}) {
    report(pass.place, static_cast<int>(pass.name.size()), std::move(what), std::move(expected),
           std::move(suggestion));
  }
  void report(const dsl::Property& property, std::string what, std::string expected = {},
              std::string suggestion = {}) {
    report(property.place, static_cast<int>(property.word.size()), std::move(what), std::move(expected),
           std::move(suggestion));
  }
  void report(const dsl::Value& value, std::string what, std::string expected = {},
              std::string suggestion = {}) {
    report(value.place, value.length, std::move(what), std::move(expected), std::move(suggestion));
  }

  /// Checks values from outside the text (settings, sweep points) as well.
  void checkValues() {
    for (const auto& [name, value] : values_) {
      const PipelineParameter* parameter = findParameter(pipeline_, name);
      if (parameter == nullptr) {
        throw Error(fmt::format("pipeline \"{}\" has no parameter '{}'; expected {}", pipeline_.name, name,
                                oneOf(parameterNames(pipeline_), "none, since it declares no parameters")));
      }
      if (const std::string misfit = parameter->misfit(value); !misfit.empty()) {
        throw Error(fmt::format("parameter '{}' of pipeline \"{}\" is {}: it {}", name, pipeline_.name,
                                value.text(), misfit));
      }
    }
  }

  BoundPass makePass(const PassText& text) {
    BoundPass bound{text.name, text.technique, text.pass, nullptr, {}};
    const Technique* technique = techniques_.technique(text.technique);
    // The place of "TECHNIQUE.PASS" in the header.
    const dsl::Value& place = text.block->header.at(1);
    if (technique == nullptr) {
      if (missingReported_.insert(text.technique).second) {
        const MissingTechnique missing = explainMissing(techniques_, text.technique);
        report(place, missing.what, missing.expected, missing.suggestion);
      }
      return bound;
    }
    const PassEntry* entry = technique->find(text.pass);
    if (entry == nullptr) {
      std::vector<std::string> names;
      for (const PassEntry& one : technique->passes) names.push_back(one.name);
      report(place, fmt::format("technique '{}' has no pass '{}'", text.technique, text.pass),
             oneOf(names, "nothing, since it has no passes"), suggestionFor(findings_, text.pass, names));
      return bound;
    }
    bound.object = entry->make();
    bound.sources.resize(bound.object->inputs().size());
    return bound;
  }

  void bindPass(int index) {
    const PassText& text = pipeline_.passes[static_cast<std::size_t>(index)];
    Pass& pass = *graph_.passes[static_cast<std::size_t>(index)].object;
    const std::size_t findingsBefore = findings_.size();
    saidOf_.clear();
    std::set<std::string> given;
    for (const dsl::Item& item : text.block->items) {
      if (item.block) {
        report(item.block->place, static_cast<int>(item.block->word.size()), "a pass cannot contain blocks",
               "inputs and parameters");
        continue;
      }
      const dsl::Property& property = *item.property;
      if (!given.insert(property.word).second) {
        report(property, fmt::format("'{}' is given twice", property.word),
               "each input and parameter at most once");
        continue;
      }
      bindProperty(index, property);
    }
    for (const InBase* input : pass.inputs()) {
      if (input->presence() == Presence::required && !given.contains(input->name())) {
        report(text, fmt::format("pass '{}' lacks its required input '{}'", text.name, input->name()),
               fmt::format("{} PASS.PORT, where the port is of kind {}", input->name(), input->kind().name),
               offer(index, *input));
      }
    }
    if (findings_.size() == findingsBefore) {
      stateWhatIsSaid(pass);
      std::string contradiction = pass.applyPublished();
      if (contradiction.empty()) contradiction = pass.checkParameters();
      if (!contradiction.empty())
        report(text, fmt::format("the parameters of pass '{}' contradict each other: {}", text.name,
                                 contradiction));
    }
  }

  /// The text that would connect the input to the only output of its kind; empty if there is none or more
  /// than one.
  std::string offer(int reader, const InBase& input) const {
    std::string found;
    for (std::size_t i = 0; i < graph_.passes.size(); ++i) {
      if (static_cast<int>(i) == reader || !graph_.passes[i].object) continue;
      for (const OutBase* output : graph_.passes[i].object->outputs()) {
        if (!input.takes(output->kind())) continue;
        if (!found.empty()) return {};
        found = fmt::format("{} {}.{}", input.name(), graph_.passes[i].name, output->name());
      }
    }
    return found;
  }

  void bindProperty(int index, const dsl::Property& property) {
    BoundPass& bound = graph_.passes[static_cast<std::size_t>(index)];
    const int input = indexOf(bound.object->inputs(), property.word);
    const int parameter = indexOf(bound.object->parameters(), property.word);
    if (input < 0 && parameter < 0) {
      std::vector<std::string> known = namesOf(bound.object->inputs());
      for (const std::string& name : namesOf(bound.object->parameters())) known.push_back(name);
      report(property,
             fmt::format("{}.{} has no input or parameter '{}'", bound.technique, bound.pass, property.word),
             oneOf(known, "an empty block, since it has none"),
             suggestionFor(findings_, property.word, known));
      return;
    }
    if (property.values.size() != 1) {
      report(property, fmt::format("'{}' takes one value, not {}", property.word, property.values.size()));
      return;
    }
    if (input >= 0) {
      const InBase& reader = *bound.object->inputs()[static_cast<std::size_t>(input)];
      const OutputIndex source = connect(property.values[0], readerOf(reader),
                                         fmt::format("input '{}' of pass '{}'", property.word, bound.name));
      bound.sources[static_cast<std::size_t>(input)] = source;
      if (source.valid()) warnOfWrongLight(property.values[0], source, reader, bound.name);
    } else {
      setParameter(*bound.object->parameters()[static_cast<std::size_t>(parameter)], property.values[0]);
    }
  }

  void warn(const dsl::Value& value, std::string what, std::string expected, std::string suggestion) {
    report(value, std::move(what), std::move(expected), std::move(suggestion));
    findings_.back().severity = Diagnostic::Severity::warning;
  }

  /// Warns of outputs of the right kind whose content is not what the input expects.
  void warnOfWrongLight(const dsl::Value& value, OutputIndex source, const InBase& input,
                        const std::string& pass) {
    const OutBase& output = graph_.output(source);
    const Expects& expects = input.expects();
    if (expects.levels == Levels::all && output.levels() == Levels::finest)
      warn(
          value,
          fmt::format(
              "output '{}' fills only the finest level, but input '{}' of pass '{}' reads all: its light is wrong",
              graph_.outputText(source), input.name(), pass),
          "an output that fills all levels", only(source, [&](const OutBase& one) {
            return input.takes(one.kind()) && one.levels() == Levels::all;
          }));
    if (!expects.component || output.contributes() == *expects.component) return;
    warn(value,
         fmt::format("output '{}' holds {}, but input '{}' of pass '{}' takes {}: its light is wrong",
                     graph_.outputText(source), componentText(output.contributes()), input.name(), pass,
                     componentText(*expects.component)),
         "an output that holds " + componentText(*expects.component), only(source, [&](const OutBase& one) {
           return input.takes(one.kind()) && one.contributes() == *expects.component;
         }));
  }

  static std::string componentText(Contributes component) {
    return component == Contributes::nothing ? "no component of the image" : name(component);
  }

  /// The only output in the pipeline that fits, or the only one of the same pass; empty if there is none or
  /// more than one.
  template <class Fits>
  std::string only(OutputIndex near, const Fits& fits) const {
    for (const bool samePass : {true, false}) {
      std::string found;
      int count = 0;
      for (std::size_t i = 0; i < graph_.passes.size(); ++i) {
        if (!graph_.passes[i].object || (samePass && static_cast<int>(i) != near.pass)) continue;
        for (const OutBase* output : graph_.passes[i].object->outputs()) {
          if (!fits(*output)) continue;
          found = graph_.passes[i].name + "." + output->name();
          ++count;
        }
      }
      if (count == 1) return found;
    }
    return {};
  }

  // ---- connections ---------------------------------------------------------------------------------------

  /// The kind that a reader expects, and whether it accepts others.
  struct Reader {
    const PortKind& kind;
    std::function<bool(const PortKind&)> takes;
  };
  static Reader readerOf(const InBase& input) {
    return {input.kind(), [&input](const PortKind& kind) { return input.takes(kind); }};
  }

  /// The output that a value names; invalid after a finding.
  OutputIndex connect(const dsl::Value& value, const Reader& wanted, const std::string& reader) {
    const auto parts = splitDotted(value);
    if (!parts && !value.isPlainWord()) {
      report(value, fmt::format("{} is connected to no output", reader), "PASS.PORT");
      return {};
    }
    return connect(value.place, value.length, parts ? parts->first : value.text,
                   parts ? parts->second : std::string(), wanted, reader);
  }

  OutputIndex connect(const SourcePlace& place, int length, const std::string& passName,
                      const std::string& portName, const Reader& wanted, const std::string& reader) {
    const PortKind& kind = wanted.kind;
    int source = -1;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < graph_.passes.size(); ++i) {
      names.push_back(graph_.passes[i].name);
      if (source < 0 && graph_.passes[i].name == passName) source = static_cast<int>(i);
    }
    if (source < 0) {
      // All readers of a missing pass share one mistake, which is reported once.
      if (unknownReported_.insert(passName).second)
        report(place, length, fmt::format("unknown pass '{}'", passName), oneOf(names, "a pass"),
               suggestionFor(findings_, passName, names));
      return {};
    }
    const Pass* pass = graph_.passes[static_cast<std::size_t>(source)].object.get();
    if (pass == nullptr) return {};  // Already reported: its technique or pass is unknown.
    const auto& outputs = pass->outputs();
    int port = portName.empty() ? -1 : indexOf(outputs, portName);
    if (!portName.empty() && port < 0) {
      report(place, length, fmt::format("pass '{}' has no output '{}'", passName, portName), portsText(*pass),
             suggestionFor(findings_, portName, namesOf(outputs)));
      return {};
    }
    if (portName.empty()) {
      std::vector<int> fitting;
      for (std::size_t i = 0; i < outputs.size(); ++i) {
        if (wanted.takes(outputs[i]->kind())) fitting.push_back(static_cast<int>(i));
      }
      if (fitting.size() > 1 || (fitting.empty() && outputs.size() != 1)) {
        report(place, length,
               fmt::format("pass '{}' has {} outputs of kind {}", passName, fitting.size(), kind.name),
               fmt::format("{}.PORT, where PORT is {}", passName, portsText(*pass)));
        return {};
      }
      port = fitting.empty() ? 0 : fitting.front();
    }
    const OutBase& output = *outputs[static_cast<std::size_t>(port)];
    if (output.kind().name == kind.name && !wanted.takes(output.kind())) {
      report(place, length,
             fmt::format("output '{}.{}' and {} both name their kind {}, but have different types", passName,
                         output.name(), reader, kind.name),
             "techniques that share the header of the kind");
      return {};
    }
    if (!wanted.takes(output.kind())) {
      std::vector<std::string> fitting;
      for (const OutBase* other : outputs) {
        if (wanted.takes(other->kind())) fitting.push_back(passName + "." + other->name());
      }
      report(place, length,
             fmt::format("output '{}.{}' is of kind {}, but {} takes {}", passName, output.name(),
                         output.kind().name, reader, kind.name),
             "an output of kind " + kind.name, fitting.size() == 1 ? fitting.front() : std::string());
      return {};
    }
    return {source, port};
  }

  static Reader imageReader() {
    const PortKind& image = portKind<Image>();
    return {image, [&image](const PortKind& kind) { return kind.isSameType(image); }};
  }

  void bindOutputs() {
    for (const Pipeline::Output& output : pipeline_.outputs) {
      const int length = static_cast<int>(output.pass.size() + 1 + output.port.size());
      graph_.outputs.push_back(
          {output.name, connect(output.place, length, output.pass, output.port, imageReader(),
                                fmt::format("output '{}' of the pipeline", output.name))});
    }
    if (pipeline_.outputs.empty()) requireNoImage();
  }

  /// A pipeline may lack outputs only if no pass makes a part of an image.
  void requireNoImage() {
    for (std::size_t i = 0; i < graph_.passes.size(); ++i) {
      if (!graph_.passes[i].object) continue;
      for (const OutBase* output : graph_.passes[i].object->outputs()) {
        if (output->contributes() == Contributes::nothing) continue;
        const std::string port = graph_.passes[i].name + "." + output->name();
        report(pipeline_.passes[i], fmt::format("the pipeline has no output, so '{}' is never shown", port),
               "output NAME " + port);
        return;
      }
    }
  }

  // ---- parameters ----------------------------------------------------------------------------------------

  void setParameter(ParamBase& parameter, const dsl::Value& value) {
    if (value.kind != dsl::ValueKind::parameter) {
      const auto constant = parameterValue(value);
      if (!constant) {
        report(value, fmt::format("this is not a value for the parameter '{}'", parameter.name()),
               expectation(parameter));
        return;
      }
      if (const std::string misfit = tryValue(parameter, *constant); !misfit.empty()) {
        report(value,
               fmt::format("parameter '{}' is {}, which does not fit", parameter.name(), constant->text()),
               misfitExpectation(misfit));
      }
      saidOf_[&parameter] = Said::byText;
      return;
    }
    const PipelineParameter* declared = findParameter(pipeline_, value.text);
    if (declared == nullptr) {
      const std::vector<std::string> names = parameterNames(pipeline_);
      report(value, fmt::format("unknown parameter '${}'", value.text),
             oneOf(names, "a parameter declared with param"), suggestionFor(findings_, value.text, names));
      return;
    }
    // Values of sweeps are checked now, so that no report stops half-way.
    for (const Sweep& sweep : pipeline_.sweeps) {
      for (const auto& [name, values] : sweep.axes) {
        if (name != value.text) continue;
        for (const ParameterValue& one : values) {
          if (const std::string misfit = tryValue(parameter, one); !misfit.empty()) {
            report(value,
                   fmt::format("sweep '{}' sets '{}' to {}, which does not fit '{}'", sweep.name, name,
                               one.text(), parameter.name()),
                   misfitExpectation(misfit));
          }
        }
      }
    }
    const auto given = values_.find(value.text);
    const ParameterValue& chosen = given == values_.end() ? declared->value : given->second;
    if (const std::string misfit = tryValue(parameter, chosen); !misfit.empty()) {
      report(value,
             fmt::format("'${}' is {}, which does not fit '{}'", value.text, chosen.text(), parameter.name()),
             misfitExpectation(misfit));
    }
    // A pipeline passes on all of its parameters; a value equal to the pass's default counts as not stated.
    if (parameter.valueText() != parameter.defaultText())
      saidOf_[&parameter] = given == values_.end() ? Said::byText : Said::byCaller;
  }

  /// If the caller turned `as_published` on, it overrides values of the text. If the text did, stated values
  /// stand beside it.
  void stateWhatIsSaid(Pass& pass) {
    Said form = Said::byText;
    for (const ParamBase* parameter : pass.parameters())
      if (parameter->name() == "as_published" && saidOf_.contains(parameter)) form = saidOf_.at(parameter);
    for (ParamBase* parameter : pass.parameters()) {
      const auto said = saidOf_.find(parameter);
      if (said != saidOf_.end() && said->second >= form) parameter->state();
    }
  }

  static std::string tryValue(ParamBase& parameter, const ParameterValue& value) {
    if (!value.word.empty()) return parameter.set(value.word);
    const dsl::Dimension wanted = dimensionOf(parameter);
    const bool isNumber =
        parameter.type() == ParamBase::Type::integer || parameter.type() == ParamBase::Type::number;
    if (isNumber && value.dimension != dsl::Dimension{} && value.dimension != wanted) {
      return wanted == dsl::kNoDimension ? std::string("must be a number without a unit")
                                         : fmt::format("must be a number that measures {}, not {}",
                                                       wanted.text(), value.dimension.text());
    }
    return parameter.set(value.number);
  }

  static std::string expectation(ParamBase& parameter) {
    switch (parameter.type()) {
      case ParamBase::Type::integer:
      case ParamBase::Type::number:
        return misfitExpectation(parameter.set(std::string()));
      case ParamBase::Type::flag:
        return "on or off";
      case ParamBase::Type::word:
        return oneOf(parameter.choices(), "a word");
    }
    return {};
  }

  // ---- order ---------------------------------------------------------------------------------------------

  /// The sources of a pass in the same frame. Histories are not among them: they exist before the frame
  /// begins.
  std::vector<std::size_t> sourcesBefore(std::size_t index) const {
    std::vector<std::size_t> result;
    const BoundPass& bound = graph_.passes[index];
    for (std::size_t i = 0; i < bound.sources.size(); ++i) {
      if (bound.sources[i].valid() && bound.object->inputs()[i]->presence() != Presence::history)
        result.push_back(static_cast<std::size_t>(bound.sources[i].pass));
    }
    return result;
  }

  /// Orders sources before readers, and in text order among equals. Passes left over form cycles.
  void schedule() {
    const std::size_t count = graph_.passes.size();
    std::vector<bool> done(count, false);
    const auto ready = [&](std::size_t index) {
      const std::vector<std::size_t> sources = sourcesBefore(index);
      return std::all_of(sources.begin(), sources.end(), [&](std::size_t source) { return done[source]; });
    };
    for (bool progress = true; progress;) {
      progress = false;
      for (std::size_t i = 0; i < count && !progress; ++i) {
        if (done[i] || !ready(i)) continue;
        done[i] = progress = true;
        graph_.order.push_back(static_cast<int>(i));
      }
    }
    std::vector<bool> explained = done;
    for (std::size_t i = 0; i < count; ++i) {
      if (!explained[i]) reportCycle(i, done, explained);
    }
  }

  /// Follows unscheduled sources until a pass repeats: that is a cycle. Passes that only read a cycle get no
  /// finding of their own.
  void reportCycle(std::size_t start, const std::vector<bool>& done, std::vector<bool>& explained) {
    std::vector<std::size_t> path;
    std::size_t at = start;
    while (std::find(path.begin(), path.end(), at) == path.end()) {
      path.push_back(at);
      for (const std::size_t source : sourcesBefore(at)) {
        if (done[source]) continue;
        at = source;
        break;
      }
    }
    const auto first = std::find(path.begin(), path.end(), at);
    const bool known = explained[at];
    for (const std::size_t pass : path) explained[pass] = true;
    if (known) return;
    // The path runs from readers to sources; data flows the other way.
    std::vector<std::size_t> cycle(first, path.end());
    std::reverse(cycle.begin(), cycle.end());
    std::rotate(cycle.begin(), std::min_element(cycle.begin(), cycle.end()), cycle.end());
    std::string text;
    for (const std::size_t pass : cycle) text += graph_.passes[pass].name + " -> ";
    text += graph_.passes[cycle.front()].name;
    report(pipeline_.passes[cycle.front()], "cyclic dependency: " + text,
           "an order in which they can run; only an input that is a history may lead back");
  }

  const Pipeline& pipeline_;
  TechniqueSource& techniques_;
  const ParameterValues& values_;
  BoundGraph graph_;
  std::vector<Diagnostic> findings_;
  /// The origin of a parameter's value; the later enumerator overrides.
  enum class Said { byText, byCaller };
  std::map<const ParamBase*, Said> saidOf_;
  std::set<std::string> missingReported_, unknownReported_;
};

}  // namespace

std::string BoundGraph::outputText(OutputIndex index) const {
  return passes[static_cast<std::size_t>(index.pass)].name + "." + output(index).name();
}

std::size_t BoundGraph::findPass(const std::string& pass) const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < passes.size(); ++i) {
    if (passes[i].name == pass) return i;
    names.push_back(passes[i].name);
  }
  throw Error(fmt::format("the pipeline has no pass '{}'; expected {}", pass, oneOf(names, "none")));
}

OutputIndex BoundGraph::find(const std::string& pass, const std::string& port) const {
  const std::size_t position = findPass(pass);
  const int index = indexOf(passes[position].object->outputs(), port);
  if (index >= 0) return {static_cast<int>(position), index};
  throw Error(fmt::format("pass '{}' has no output '{}'; expected {}", pass, port,
                          portsText(*passes[position].object)));
}

MissingTechnique explainMissing(const TechniqueSource& techniques, const std::string& name) {
  for (const SkippedTechnique& skipped : techniques.skipped()) {
    if (skipped.library.filename() == "lib" + name + ".so") {
      return {
          fmt::format("technique '{}' was skipped: {}: {}", name, skipped.library.string(), skipped.reason),
          {},
          {}};
    }
  }
  const std::vector<std::string> available = techniques.available();
  std::vector<std::string> folders;
  for (const std::filesystem::path& folder : techniques.folders()) folders.push_back(folder.string());
  // The usual cause is a user's technique in a folder that no option names.
  return {folders.empty()
              ? fmt::format("unknown technique '{}'", name)
              : fmt::format("unknown technique '{}': no lib{}.so in {} (--techniques FOLDER adds one)", name,
                            name, fmt::join(folders, ", ")),
          oneOf(available, "a technique, but no technique library was found"), nearestWord(name, available)};
}

void connectInputs(BoundGraph& graph) {
  for (BoundPass& pass : graph.passes) {
    for (std::size_t i = 0; i < pass.sources.size(); ++i) {
      if (pass.sources[i].valid()) pass.object->inputs()[i]->connect(&graph.output(pass.sources[i]));
    }
  }
}

BoundGraph bindPipeline(const Pipeline& pipeline, TechniqueSource& techniques,
                        const ParameterValues& values) {
  return Binder(pipeline, techniques, values).bind();
}

void checkPipeline(const Pipeline& pipeline, TechniqueSource& techniques) {
  bindPipeline(pipeline, techniques, {});
}

}  // namespace lumivox

// describe: the meaning of a word of the texts, and the whole reference.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "command.h"
#include "describe_json.h"
#include "highlighting.h"
#include "lumivox/base/error.h"
#include "lumivox/base/installation.h"
#include "lumivox/base/log.h"
#include "lumivox/base/terminal.h"
#include "lumivox/dsl/schema.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/sweep_text.h"
#include "lumivox/results/reproduction.h"
#include "lumivox/scene/text.h"
#include "viewer/actions.h"

namespace lumivox::command {
namespace {

std::string rangeText(const ParamBase& parameter) {
  if (!parameter.choices().empty()) return fmt::format("one of {}", fmt::join(parameter.choices(), ", "));
  if (parameter.type() == ParamBase::Type::flag) return "on or off";
  if (parameter.type() == ParamBase::Type::integer)
    return fmt::format("an integer in {}..{}", parameter.low(), parameter.high());
  // Printed as the floats that they were declared as: 0.05 and not 0.05000000074505806.
  const auto given = [](double end) { return std::stod(fmt::format("{}", static_cast<float>(end))); };
  return fmt::format("a number in {}..{}{}", given(parameter.low()), given(parameter.high()),
                     parameter.unit().empty() ? "" : " " + parameter.unit());
}

std::string inputText(const InBase& input) {
  const std::string need = unmetNeed(input.needs(), SceneTraits{});
  const Expects& expects = input.expects();
  const std::string takes = expects.component && *expects.component != Contributes::nothing
                                ? fmt::format(", {}", name(*expects.component))
                            : expects.levels == Levels::all ? ", all levels"
                                                            : "";
  return fmt::format("{}{}{}{}", input.kind().name, takes,
                     input.presence() == Presence::optional  ? ", may be left out"
                     : input.presence() == Presence::history ? ", of the frame before, may be left out"
                                                             : "",
                     need.empty() ? "" : ", read when the scene has " + need);
}

std::string outputText(const OutBase& output) {
  const char* levels = output.levels() == Levels::finest ? ", the finest level"
                       : output.levels() == Levels::all  ? ", all levels"
                                                         : "";
  return output.kind().name + levels +
         (output.contributes() == Contributes::nothing ? ""
                                                       : fmt::format(", {}", name(output.contributes())));
}

std::string meaningAfter(const std::string& meaning) {
  return meaning.empty() ? "" : ": " + meaning;
}

/// "1..32; default 8; published 1".
std::string valuesText(const ParamBase& parameter) {
  const std::string printed = parameter.publishedText();
  return rangeText(parameter) + "; default " + parameter.defaultText() +
         (printed.empty() ? std::string() : "; published " + printed);
}

std::string passText(const std::string& technique, const PassEntry& entry) {
  const std::unique_ptr<Pass> pass = entry.make();
  std::string text = fmt::format("pass NAME {}.{}\n  {}\n", technique, entry.name, entry.meaning);
  if (pass->indirectBounces() != 1)
    text += fmt::format("  models {} bounces of indirect light\n", pass->indirectBounces());
  if (pass->worksOnHost()) text += "  works on the host\n";
  const auto section = [&](const char* title, const auto& members, const auto& line) {
    if (members.empty()) return;
    text += fmt::format("  {}\n", title);
    for (const auto* member : members)
      text += fmt::format("    {} ({}){}\n", member->name(), line(*member), meaningAfter(member->meaning()));
  };
  section("inputs", pass->inputs(), inputText);
  section("outputs", pass->outputs(), outputText);
  section("parameters", pass->parameters(), valuesText);
  return text;
}

/// The readers that a condition concerns: "readers", "readers of coarser levels".
std::string readersText(const PortCondition& condition) {
  return condition.readers.empty() ? "readers" : "readers " + condition.readers;
}

/// A port kind with its meaning, its resources (and which may be negative), the conditions for readers, the
/// fields that are exported and what counts as occupied.
std::string kindText(const PortKind& kind) {
  std::string text = fmt::format("port kind {}\n  {}\n", kind.name, kind.meaning);
  for (const PortResource& one : kind.resources)
    text += fmt::format("  contains {} ({}): {}{}\n", one.name, one.shape, one.meaning,
                        one.sign == PortResource::Sign::any ? "; may be negative" : "");
  for (const PortCondition& one : kind.conditions)
    text += fmt::format("  {} heed {}: {}; otherwise {}\n", readersText(one), one.member, one.meaning,
                        one.otherwise);
  for (const PortField& one : kind.fields)
    text += fmt::format("  exported as {} ({}): {}\n", one.name, one.unit, one.quantity);
  if (!kind.occupancy.empty()) text += fmt::format("  occupied: {}\n", kind.occupancy);
  return text;
}

/// If a name belongs to inputs, outputs or parameters of more passes than this, only the passes are listed.
constexpr std::size_t kMostInFull = 3;

/// An input, output or parameter of the described name.
struct Member {
  std::string pass, text;
};

/// The members in full, or more than kMostInFull of them as "input light of 7 passes: a.b, a.c, ...".
std::string membersText(const std::string& what, const std::string& word,
                        const std::vector<Member>& members) {
  std::string text;
  if (members.size() <= kMostInFull) {
    for (const Member& one : members)
      text += fmt::format("{} {} of {} {}\n\n", what, word, one.pass, one.text);
    return text;
  }
  std::vector<std::string> passes;
  for (const Member& one : members) passes.push_back(one.pass);
  return fmt::format("{} {} of {} passes: {}; lumivox describe {} explains one of them\n\n", what, word,
                     members.size(), fmt::join(passes, ", "), passes.front());
}

/// Describes everything in the techniques that has this name; adds all names to `known`.
std::string describeInTechniques(TechniqueSet& techniques, const std::string& word,
                                 std::vector<std::string>& known) {
  std::string text;
  for (const std::string& name : techniques.available()) {
    const Technique* technique = techniques.technique(name);
    if (technique == nullptr) continue;
    known.push_back(name);
    if (name != word) continue;
    text += fmt::format("technique {}\n  {}\n  {}\n  passes:", name, technique->meaning, technique->paper);
    for (const PassEntry& entry : technique->passes) text += " " + entry.name;
    text += "\n\n";
  }
  std::vector<Member> inputs, outputs, parameters;
  forEachPass(techniques, [&](const Technique& technique, const PassEntry& entry) {
    const std::string full = technique.name + "." + entry.name;
    known.push_back(entry.name);
    known.push_back(full);
    if (word == entry.name || word == full) {
      text += passText(technique.name, entry) + "\n";
      return;
    }
    const std::unique_ptr<Pass> pass = entry.make();
    const auto collect = [&](std::vector<Member>& found, const auto& members, const auto& line) {
      for (const auto* one : members) {
        known.push_back(one->name());
        if (one->name() == word)
          found.push_back({full, fmt::format("({}){}", line(*one), meaningAfter(one->meaning()))});
      }
    };
    collect(inputs, pass->inputs(), inputText);
    collect(outputs, pass->outputs(), outputText);
    collect(parameters, pass->parameters(), valuesText);
  });
  return text + membersText("output", word, outputs) + membersText("input", word, inputs) +
         membersText("parameter", word, parameters);
}

/// The known word that differs from this one by a final "s": "cones" for "cone". Empty if there is none.
std::string otherNumberOf(const std::string& word, const std::vector<std::string>& known) {
  for (const std::string& one : known)
    if (one == word + "s" || word == one + "s") return one;
  return {};
}

/// Wraps lines to the width of the terminal. A line with columns ("  fov  full angle") continues below its
/// second column, and a line without columns two spaces further in.
std::string fittedToTerminal(const std::string& text) {
  const auto columns = static_cast<std::size_t>(outputColumns());
  std::string result;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    const std::string line = text.substr(from, end - from);
    from = end + 1;
    if (shownWidth(line) <= columns) {
      result += line + "\n";
      continue;
    }
    const std::size_t margin = line.find_first_not_of(' ');
    const std::size_t gap = line.find("  ", margin);
    std::size_t second = gap == std::string::npos ? margin : line.find_first_not_of(' ', gap);
    if (second > columns / 2) second = margin;
    const std::string lines = wrapped(line.substr(second), columns - second, second == margin ? 2 : 0);
    const std::string below(second, ' ');
    result += line.substr(0, second);
    for (const char c : lines) result += c == '\n' ? "\n" + below : std::string(1, c);
    result += "\n";
  }
  return result;
}

int describe(const std::string& word, bool asJson, const GlobalOptions& global) {
  TechniqueSet techniques = global.techniqueSet();
  std::vector<std::string> known;
  std::string text;
  for (const auto* specifications :
       {&sceneSpecifications(), &pipelineSpecifications(), &sweepSpecifications(),
        &reproductionSpecifications(), &viewer::viewSpecifications()}) {
    std::string found = dsl::describe(*specifications, word);
    if (!found.empty()) text += found + (found.back() == '\n' ? "\n" : "\n\n");
    for (const std::string& one : dsl::words(*specifications)) known.push_back(one);
  }
  std::vector<std::unique_ptr<Pass>> passes;
  for (const PortKind* kind : portKinds(techniques, passes)) {
    known.push_back(kind->name);
    if (kind->name == word) text += kindText(*kind) + "\n";
  }
  text += describeInTechniques(techniques, word, known);
  if (text.empty())
    if (const std::string other = otherNumberOf(word, known); !other.empty())
      return describe(other, asJson, global);
  if (text.empty()) {
    const std::string nearest = nearestWord(word, known);
    throw Error(fmt::format(
        "nothing is called '{}'; expected a block, property, port kind, technique, pass, port or parameter{}",
        word, nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
  text.erase(text.find_last_not_of('\n') + 1);
  if (asJson) {
    printJson(describedAsJson(techniques, word));
  } else {
    print(fittedToTerminal(text + "\n"));
  }
  return kGood;
}

std::string markdownCell(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2))
    text.insert(at, "\\");
  return text;
}

std::string kindsAsMarkdown(TechniqueSet& techniques) {
  std::string text =
      "\n## Port kinds\n\nWhat flows between passes. A number below 0 is a finding of the health scan where `any sign` does not say "
      "otherwise. What readers heed are members that say how to read the others. A technique brings a kind of its own by the same "
      "table (`pipeline/port.h`).\n\n"
      "| Kind | Holds | Readers heed | Exported | Occupied |\n|---|---|---|---|---|\n";
  std::vector<std::unique_ptr<Pass>> passes;
  for (const PortKind* kind : portKinds(techniques, passes)) {
    std::vector<std::string> holds, heeded, fields;
    for (const PortResource& one : kind->resources)
      holds.push_back(fmt::format("`{}` ({}{}): {}", one.name, one.shape,
                                  one.sign == PortResource::Sign::any ? ", any sign" : "", one.meaning));
    for (const PortCondition& one : kind->conditions)
      heeded.push_back(fmt::format("`{}`{}: {}; otherwise {}", one.member,
                                   one.readers.empty() ? "" : " (" + readersText(one) + ")", one.meaning,
                                   one.otherwise));
    for (const PortField& one : kind->fields)
      fields.push_back(fmt::format("`{}`: {}, {}", one.name, one.quantity, one.unit));
    text += fmt::format("| `{}`: {} | {} | {} | {} | {} |\n", kind->name, markdownCell(kind->meaning),
                        markdownCell(fmt::format("{}", fmt::join(holds, "<br>"))),
                        markdownCell(fmt::format("{}", fmt::join(heeded, "<br>"))),
                        markdownCell(fmt::format("{}", fmt::join(fields, "<br>"))),
                        markdownCell(kind->occupancy));
  }
  return text;
}

/// The binding numbers that techniques share: those of shaders/common and shaders/toolkit.
std::string bindingsAsMarkdown(TechniqueSet& techniques) {
  using Key = std::pair<shader::BindingKind, std::string>;
  struct Use {
    std::set<std::uint32_t> numbers;
    std::set<std::string> techniques;
  };
  std::map<Key, Use> uses;
  const auto look = [&](const std::string& name, const shader::ShaderPack& pack) {
    for (const shader::PackedProgram& program : pack.programs)
      for (const shader::PackedBinding& binding : program.bindings) {
        Use& use = uses[{binding.kind, binding.name}];
        use.numbers.insert(binding.binding);
        use.techniques.insert(name);
      }
  };
  for (const std::string& name : techniques.available())
    if (const Technique* technique = techniques.technique(name)) look(name, technique->shaders);
  look("toolkit", shader::readShaderPack(frameworkPack("toolkit")));
  std::map<std::pair<shader::BindingKind, std::uint32_t>, std::vector<std::string>> claimed;
  for (const auto& [key, use] : uses)
    if (use.numbers.size() == 1 && use.techniques.size() > 1)
      claimed[{key.first, *use.numbers.begin()}].push_back("`" + key.second + "`");
  std::string text =
      "\n## Claimed bindings\n\nNumbers that bindings of one name have in the shaders of several techniques: "
      "those of `shaders/common` and `shaders/toolkit`, which a shader that includes the file leaves free, and a "
      "few habits. Each kind of binding counts by itself.\n\n| Kind | Number | Bindings |\n|---|---|---|\n";
  for (const auto& [place, names] : claimed)
    text += fmt::format("| {} | {} | {} |\n", name(place.first), place.second, fmt::join(names, ", "));
  return text;
}

int describeAsMarkdown(const GlobalOptions& global) {
  TechniqueSet techniques = global.techniqueSet();
  std::string text =
      "# Reference\n\nWritten by `lumivox describe --markdown` from the tables that the parser uses.\n\n";
  text += "## Scene texts\n\n" + dsl::describeAsMarkdown(sceneSpecifications()) + "\n";
  text += "## Pipeline texts\n\n" + dsl::describeAsMarkdown(pipelineSpecifications()) + "\n";
  text += "## Sweep texts\n\n" + dsl::describeAsMarkdown(sweepSpecifications()) + "\n";
  text += "## Published tables\n\n" + dsl::describeAsMarkdown(reproductionSpecifications()) + "\n";
  text += "## Scripts of the window\n\n" + dsl::describeAsMarkdown(viewer::viewSpecifications());
  text += kindsAsMarkdown(techniques) + bindingsAsMarkdown(techniques) + "\n## Techniques\n";
  std::string technique;
  forEachPass(techniques, [&](const Technique& owner, const PassEntry& entry) {
    if (owner.name != technique)
      text += fmt::format("\n### {}\n\n{}\n\n{}\n", owner.name, owner.meaning, owner.paper);
    technique = owner.name;
    text += fmt::format(
        "\n#### {}.{}\n\n{}\n\n| Word | Kind | Values | Published | Meaning |\n|---|---|---|---|---|\n",
        owner.name, entry.name, entry.meaning);
    const std::unique_ptr<Pass> pass = entry.make();
    const auto row = [&](const std::string& word, const char* kind, const std::string& values,
                         const std::string& meaning, const std::string& printed = {}) {
      text += fmt::format("| `{}` | {} | {} | {} | {} |\n", word, kind, markdownCell(values), printed,
                          markdownCell(meaning));
    };
    for (const InBase* input : pass->inputs())
      row(input->name(), "input", inputText(*input), input->meaning());
    for (const OutBase* output : pass->outputs())
      row(output->name(), "output", outputText(*output), output->meaning());
    for (const ParamBase* parameter : pass->parameters())
      row(parameter->name(), "parameter", rangeText(*parameter) + "; default " + parameter->defaultText(),
          parameter->meaning(), parameter->publishedText());
  });
  print(text);
  return kGood;
}

}  // namespace

void addDescribeCommand(Commands& commands) {
  const GlobalOptions& global = commands.global;
  auto* command = commands.app.add_subcommand("describe", "explains a word of the texts");
  auto word = std::make_shared<std::string>();
  auto markdown = std::make_shared<bool>(false), json = std::make_shared<bool>(false);
  auto highlighting = std::make_shared<std::string>();
  auto* positional =
      command->add_option("WORD", *word, "a block, property, port kind, technique, pass, port or parameter");
  command->add_flag("--markdown", *markdown, "print the whole reference")->excludes(positional);
  command
      ->add_option("--highlighting", *highlighting,
                   "print the grammar by which an editor colours the texts: textmate (JSON) or vim")
      ->check(CLI::IsMember({"textmate", "vim"}))
      ->excludes(positional);
  command->add_flag("--json", *json, "print every place where the word occurs as JSON");
  commands.onChosen(command, [=, &global]() -> int {
    if (*markdown) return describeAsMarkdown(global);
    if (!highlighting->empty()) {
      const HighlightedWords words = highlightedWords();
      print(*highlighting == "vim" ? vimSyntax(words) : textMateGrammar(words));
      return kGood;
    }
    if (word->empty()) throw Error("describe: expected a word, or --markdown for the whole reference");
    return describe(*word, *json, global);
  });
}

}  // namespace lumivox::command

#include "highlighting.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "lumivox/dsl/document.h"
#include "lumivox/dsl/schema.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/pipeline/sweep_text.h"
#include "lumivox/results/reproduction.h"
#include "lumivox/scene/text.h"

namespace lumivox::command {
namespace {

void sortOut(std::vector<std::string>& words) {
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
}

void add(HighlightedWords& words, const std::vector<dsl::PropertySpecification>& properties) {
  for (const dsl::PropertySpecification& property : properties) {
    words.properties.push_back(property.word);
    words.choices.insert(words.choices.end(), property.choices.begin(), property.choices.end());
  }
}

void add(HighlightedWords& words, const std::vector<dsl::BlockSpecification>& blocks) {
  for (const dsl::BlockSpecification& block : blocks) {
    words.blocks.push_back(block.word);
    words.kinds.insert(words.kinds.end(), block.kinds.begin(), block.kinds.end());
    add(words, block.properties);
    for (const auto& [kind, properties] : block.kindProperties) add(words, properties);
    add(words, block.blocks);
  }
}

/// The words as alternatives of a regular expression. Longer words come first, or "m" would match the
/// beginning of "m/s".
std::string alternatives(std::vector<std::string> words) {
  std::stable_sort(words.begin(), words.end(),
                   [](const std::string& a, const std::string& b) { return a.size() > b.size(); });
  return fmt::format("{}", fmt::join(words, "|"));
}

constexpr const char* kNumber = R"((?<![\w.])-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)";

}  // namespace

HighlightedWords highlightedWords() {
  HighlightedWords words;
  for (const auto* specifications : {&sceneSpecifications(), &pipelineSpecifications(),
                                     &sweepSpecifications(), &reproductionSpecifications()})
    add(words, *specifications);
  words.choices.insert(words.choices.end(), {"on", "off"});
  for (const dsl::Unit& unit : dsl::knownUnits()) words.units.push_back(unit.name);
  for (auto* list : {&words.blocks, &words.kinds, &words.properties, &words.choices, &words.units})
    sortOut(*list);
  return words;
}

std::string textMateGrammar(const HighlightedWords& words) {
  using Grammar = nlohmann::ordered_json;
  const auto rule = [](const std::string& name, const std::string& match) {
    return Grammar{{"name", name + ".lumivox"}, {"match", match}};
  };
  // Matches whole words of letters, digits and underscores only.
  const auto whole = [](const std::vector<std::string>& some) {
    return fmt::format(R"((?<![\w./$])(?:{})(?![\w./]))", alternatives(some));
  };
  Grammar strings{{"name", "string.quoted.double.lumivox"},
               {"begin", "\""},
               {"end", "\"|$"},
               {"patterns", Grammar::array({rule("constant.character.escape", R"(\\.)")})}};
  Grammar number =
      rule("constant.numeric", fmt::format(R"({}(\s*(?:{})(?![\w/]))?)", kNumber, alternatives(words.units)));
  number["captures"] = {{"1", {{"name", "keyword.other.unit.lumivox"}}}};
  Grammar block =
      rule("meta.block",
           fmt::format(R"(^\s*({})(?![\w./])(?:\s+("[^"]*"|[\w./]+))?(?:\s+({})(?![\w./]))?(?=[^{{}}#]*\{{))",
                       alternatives(words.blocks), alternatives(words.kinds)));
  block["captures"] = {{"1", {{"name", "keyword.control.lumivox"}}},
                       {"2", {{"name", "entity.name.lumivox"}}},
                       {"3", {{"name", "storage.type.lumivox"}}}};
  const Grammar grammar{{"name", "Lumivox"},
                     {"scopeName", "source.lumivox"},
                     {"fileTypes", {"scene", "pipeline", "sweep", "reproduction"}},
                     {"patterns", Grammar::array({rule("comment.line.number-sign", "#.*$"), block, strings,
                                               rule("variable.parameter", R"(\$\w+)"), number,
                                               rule("keyword.control", whole(words.blocks)),
                                               rule("support.type.property-name", whole(words.properties)),
                                               rule("storage.type", whole(words.kinds)),
                                               rule("constant.language", whole(words.choices))})}};
  return grammar.dump(2) + "\n";
}

std::string vimSyntax(const HighlightedWords& words) {
  // Vim's keywords consist of word characters only. Of several groups with the same word, the last one wins.
  const auto keywords = [](const char* group, const std::vector<std::string>& some) {
    std::string text;
    for (const std::string& word : some) text += fmt::format("syntax keyword {} {}\n", group, word);
    return text;
  };
  std::vector<std::string> units = words.units;
  std::stable_sort(units.begin(), units.end(),
                   [](const std::string& a, const std::string& b) { return a.size() > b.size(); });
  std::string text =
      "\" Vim syntax of the texts of Lumivox, written by `lumivox describe --highlighting vim`\n"
      "if exists('b:current_syntax')\n  finish\nendif\n"
      "syntax case match\n";
  text += keywords("lumivoxChoice", words.choices) + keywords("lumivoxKind", words.kinds) +
          keywords("lumivoxProperty", words.properties) + keywords("lumivoxBlock", words.blocks);
  text += fmt::format("syntax match lumivoxNumber '\\v<\\d+(\\.\\d+)?([eE][-+]?\\d+)?(\\s*({})>)?'\n", [&] {
    std::string escaped = fmt::format("{}", fmt::join(units, "|"));
    for (std::size_t at = escaped.find('/'); at != std::string::npos; at = escaped.find('/', at + 2))
      escaped.insert(at, "\\");
    return escaped;
  }());
  return text +
         "syntax match lumivoxParameter '\\$\\w\\+'\n"
         "syntax region lumivoxString start='\"' skip='\\\\.' end='\"' oneline\n"
         "syntax match lumivoxComment '#.*$'\n"
         "highlight default link lumivoxBlock Keyword\n"
         "highlight default link lumivoxKind Type\n"
         "highlight default link lumivoxProperty Identifier\n"
         "highlight default link lumivoxChoice Constant\n"
         "highlight default link lumivoxNumber Number\n"
         "highlight default link lumivoxParameter PreProc\n"
         "highlight default link lumivoxString String\n"
         "highlight default link lumivoxComment Comment\n"
         "let b:current_syntax = 'lumivox'\n";
}

}  // namespace lumivox::command

// Grammars by which editors colour the texts, made from the tables that the parser uses.
#pragma once

#include <string>
#include <vector>

namespace lumivox::command {

/// Every word of the scene, pipeline, sweep and reproduction texts by what it is; sorted, each once.
struct HighlightedWords {
  std::vector<std::string> blocks, kinds, properties, choices, units;
};
HighlightedWords highlightedWords();

/// A TextMate grammar (JSON), as Visual Studio Code, Sublime Text and others read it: scope source.lumivox.
std::string textMateGrammar(const HighlightedWords& words);
/// A Vim syntax file.
std::string vimSyntax(const HighlightedWords& words);

}  // namespace lumivox::command

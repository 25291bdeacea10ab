// Grammars for the highlighting of texts in editors, generated from the tables of the parser.
#pragma once

#include <string>
#include <vector>

namespace lumivox::command {

/// The words of scene, pipeline, sweep and reproduction texts by kind, sorted and without duplicates.
struct HighlightedWords {
  std::vector<std::string> blocks, kinds, properties, choices, units;
};
HighlightedWords highlightedWords();

/// A TextMate grammar (JSON), as Visual Studio Code, Sublime Text and others read it: scope source.lumivox.
std::string textMateGrammar(const HighlightedWords& words);
/// A Vim syntax file.
std::string vimSyntax(const HighlightedWords& words);

}  // namespace lumivox::command

// Scenes and pipelines by the names that `lumivox list` prints, for every command that takes one.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

namespace lumivox::command {

enum class NamedText { scene, pipeline, sceneOrPipeline };

/// The files that `lumivox list scenes` and `lumivox list pipelines` print: those of the project around the
/// working folder and those installed with the program. AbsentError if there is neither.
std::vector<std::filesystem::path> listedTexts(NamedText kind);

/// The file for a word on a command line: a file of that name if it exists, else the listed text of that name
/// ("cornell", or "stress/tiny" in a subfolder). A word with an ending, or one that begins with '/', './' or
/// '../', is a path and is returned unchanged. Error, with the nearest name, for any other.
std::filesystem::path textOf(const std::filesystem::path& given, NamedText kind);

/// Makes an option accept names: each becomes its path when the option is parsed.
CLI::Option* takesNames(CLI::Option* option, NamedText kind);

}  // namespace lumivox::command

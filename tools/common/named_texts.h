// Scenes and pipelines by the names that `lumivox list` prints: one mechanism for every command that takes
// one.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

namespace lumivox::command {

enum class NamedText { scene, pipeline, sceneOrPipeline };

/// The files that `lumivox list scenes` and `lumivox list pipelines` print, by path: those of the project
/// here and those that come with the program. AbsentError where there is neither.
std::vector<std::filesystem::path> listedTexts(NamedText kind);

/// The file that a word on a command line means: a file of that name where there is one, else the listed text
/// of that name ("cornell", "stress/tiny" of a folder below). What has an ending, or is a path that begins
/// with '/', './' or '../', is a path and comes back as it is. Error with the nearest name for any other.
std::filesystem::path textOf(const std::filesystem::path& given, NamedText kind);

/// For the option of a text, or of several: a name becomes its path before anybody reads it.
CLI::Option* takesNames(CLI::Option* option, NamedText kind);

}  // namespace lumivox::command

// Writes a technique from the templates that are installed with the program.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lumivox::command {

/// The placeholder for the technique's name in the texts and file names of templates.
inline constexpr const char* kNameInTemplates = "technique_name";

/// Why a technique cannot have this name, in words ("..., expected ..."); empty if it can. The name becomes a
/// folder, a C++ namespace, a library and a word of pipeline texts.
std::string nameDefect(const std::string& name);

/// Whether the folder is a project with techniques: this tree, or a folder from newTechnique().
bool isTechniqueProject(const std::filesystem::path& folder);

/// Writes templates/technique as technique `name` into `project`, which gets templates/project first if it is
/// not yet a project. Returns the files, relative to the project. Error, with nothing written, if one of them
/// exists already, or if the folder is neither a project nor empty.
std::vector<std::filesystem::path> newTechnique(const std::filesystem::path& templates,
                                                const std::string& name,
                                                const std::filesystem::path& project);

}  // namespace lumivox::command

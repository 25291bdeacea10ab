// Writing a technique from the templates that come with the program.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lumivox::command {

/// The word that stands for the technique's name in the templates' texts and file names.
inline constexpr const char* kNameInTemplates = "technique_name";

/// Why this is not a name for a technique, in words ("..., expected ..."); empty when it is one. The name
/// becomes a folder, a C++ namespace, a library and a word of pipeline texts.
std::string nameDefect(const std::string& name);

/// A project with techniques: this tree, or a folder that newTechnique has made.
bool isTechniqueProject(const std::filesystem::path& folder);

/// Writes the technique `name` of templates/technique into `project`, and templates/project around it when
/// that is no project yet. Returns the files, relative to the project. Error, and nothing written, when one
/// of them is there already, or the project's folder holds something else.
std::vector<std::filesystem::path> newTechnique(const std::filesystem::path& templates,
                                                const std::string& name,
                                                const std::filesystem::path& project);

}  // namespace lumivox::command

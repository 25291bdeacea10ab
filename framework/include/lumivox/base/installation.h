// Where the running program lies, and what comes with it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace lumivox {

/// The running program's file.
std::optional<std::filesystem::path> programFile();

/// A folder of data that comes with the running program, such as "scenes/pipelines" or "templates": in
/// share/lumivox of the prefix that it is installed in, else in a folder above it, as in the source tree.
std::optional<std::filesystem::path> programData(const std::filesystem::path& folder);

/// The same for a program that lies elsewhere: for tests.
std::optional<std::filesystem::path> programData(const std::filesystem::path& folder,
                                                 const std::filesystem::path& program);

/// The folder that the framework's library was loaded from: its techniques and packs of shaders lie below.
/// Error where that cannot be told.
std::filesystem::path libraryFolder();

/// A pack of the framework's own shaders, such as "toolkit", whether there is one of this name or not.
std::filesystem::path frameworkPack(const std::string& name);

}  // namespace lumivox

// Several files that are written together.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

namespace lumivox {

struct NewFile {
  std::filesystem::path path;
  std::string_view content;
};

/// As writeFileAtomically (lumivox/base/file.h), for files that belong together: all of them are whole and on
/// the disk before the first takes its name, so that a full disk leaves every old file as it was and nothing
/// beside it. Only between the renames can a reader see new files beside old ones.
void writeFilesAtomically(std::span<const NewFile> files);

}  // namespace lumivox

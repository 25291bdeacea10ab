// Writes several files together.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

namespace lumivox {

struct NewFile {
  std::filesystem::path path;
  std::string_view content;
};

/// Like writeFileAtomically (lumivox/base/file.h), for files that belong together. All of them are complete
/// and on the disk before the first is renamed, so that a full disk changes nothing. Only between the renames
/// can a reader see new files beside old ones.
void writeFilesAtomically(std::span<const NewFile> files);

}  // namespace lumivox

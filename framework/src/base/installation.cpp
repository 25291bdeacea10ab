#include "lumivox/base/installation.h"

#include <dlfcn.h>

#include "lumivox/base/error.h"

namespace lumivox {

namespace fs = std::filesystem;

std::optional<fs::path> programFile() {
  std::error_code failure;
  const fs::path program = fs::read_symlink("/proc/self/exe", failure);
  if (failure || program.empty()) return std::nullopt;
  return program;
}

std::optional<fs::path> programData(const fs::path& folder) {
  const std::optional<fs::path> program = programFile();
  return program ? programData(folder, *program) : std::nullopt;
}

std::optional<fs::path> programData(const fs::path& folder, const fs::path& program) {
  std::error_code ignored;
  // PREFIX/bin/lumivox
  const fs::path installed = program.parent_path().parent_path() / "share/lumivox" / folder;
  if (fs::is_directory(installed, ignored)) return installed;
  for (fs::path above = program.parent_path(); above.has_relative_path(); above = above.parent_path())
    if (fs::is_directory(above / folder, ignored)) return above / folder;
  return std::nullopt;
}

fs::path libraryFolder() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&libraryFolder), &info) == 0 || info.dli_fname == nullptr)
    throw Error("the framework's library cannot be found, and with it what lies beside it");
  return fs::absolute(info.dli_fname).parent_path();
}

fs::path frameworkPack(const std::string& name) {
  return libraryFolder() / "shaders" / (name + ".shaderpack");
}

}  // namespace lumivox

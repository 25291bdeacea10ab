#include "scene/assets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/base/installation.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

/// Anything but a folder: reading refuses what is no regular file.
bool isFile(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::exists(status) && !fs::is_directory(status);
}

bool isDirectory(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path.empty() ? fs::path(".") : path, error);
}

constexpr const char* kModelsBesideProject = "../shared/models";

/// The folder above the text that holds `scenes/`; else the nearest one with models beside it.
std::optional<fs::path> projectOf(const fs::path& sceneFile) {
  std::error_code error;
  std::optional<fs::path> withModels;
  for (fs::path directory = fs::absolute(sceneFile, error).parent_path(); directory.has_relative_path();
       directory = directory.parent_path()) {
    if (directory.filename() == "scenes") return directory.parent_path();
    if (!withModels && isDirectory(directory / kModelsBesideProject)) withModels = directory;
  }
  return withModels;
}

}  // namespace

AssetSearch::AssetSearch(const fs::path& sceneFile, const SceneLoadOptions& options) : sceneFile_(sceneFile) {
  const auto add = [&](const fs::path& directory) {
    const fs::path normal = directory.lexically_normal();
    if (std::find(directories_.begin(), directories_.end(), normal) == directories_.end())
      directories_.push_back(normal);
  };
  add(sceneFile.parent_path());
  for (const fs::path& directory : options.assetPath) add(directory);
  if (const char* variable = std::getenv("LUMIVOX_ASSETS")) {
    std::istringstream stream(variable);
    for (std::string directory; std::getline(stream, directory, ':');) {
      if (!directory.empty()) add(directory);
    }
  }
  if (const auto project = projectOf(sceneFile)) add(*project / kModelsBesideProject);
  if (const auto scenes = programData("scenes")) add(scenes->parent_path() / kModelsBesideProject);
}

std::optional<fs::path> AssetSearch::find(const std::string& name) const {
  for (const fs::path& directory : directories_) {
    const fs::path candidate = (directory / name).lexically_normal();
    if (isFile(candidate)) return candidate;
  }
  return std::nullopt;
}

std::optional<fs::path> AssetSearch::findAny(const std::string& name) const {
  for (const fs::path& directory : directories_) {
    const fs::path candidate = (directory / name).lexically_normal();
    std::error_code error;
    if (fs::exists(candidate, error)) return candidate;
  }
  return std::nullopt;
}

fs::path AssetSearch::found(const std::string& name, const std::string& what) const {
  if (const auto path = find(name)) return *path;
  refuse(name, what);
}

fs::path AssetSearch::foundAny(const std::string& name, const std::string& what) const {
  if (const auto path = findAny(name)) return *path;
  refuse(name, what);
}

void AssetSearch::refuse(const std::string& name, const std::string& what) const {
  throw AbsentError(
      fmt::format("{}: {} '{}' was not found; searched {}", sceneFile_.string(), what, name, soughtAt(name)));
}

std::string AssetSearch::soughtAt(const std::string& name) const {
  std::string text;
  for (const fs::path& directory : directories_) {
    text += (text.empty() ? "" : ", ") + (directory / name).lexically_normal().string();
  }
  return text;
}

bool AssetSearch::isLocal(const std::string& name) const {
  return isDirectory((directories_.front() / name).parent_path());
}

std::string AssetSearch::nearestLocal(const std::string& name) const {
  const fs::path relative(name);
  std::vector<std::string> names;
  std::error_code error;
  const fs::path folder = directories_.front() / relative.parent_path();
  for (const auto& entry : fs::directory_iterator(folder.empty() ? fs::path(".") : folder, error)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  const std::string nearest = nearestWord(relative.filename().string(), names);
  return nearest.empty() ? nearest : (relative.parent_path() / nearest).string();
}

}  // namespace lumivox

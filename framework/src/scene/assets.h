// Searches model, image and capture files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox {

/// Searches files named in a scene text: beside the text, then in SceneLoadOptions::assetPath, then in each
/// directory of $LUMIVOX_ASSETS (separated by colons), then in ../shared/models beside the project that holds
/// the text and beside the one that the program comes from.
class AssetSearch {
 public:
  AssetSearch(const std::filesystem::path& sceneFile, const SceneLoadOptions& options);

  std::optional<std::filesystem::path> find(const std::string& name) const;
  /// As find(), for folders too.
  std::optional<std::filesystem::path> findAny(const std::string& name) const;
  /// As find(); an AbsentError says that `what` was not found, and where it was sought.
  std::filesystem::path found(const std::string& name, const std::string& what) const;
  /// As findAny(), with the error of found().
  std::filesystem::path foundAny(const std::string& name, const std::string& what) const;
  /// Every place where `name` is searched, for messages.
  std::string soughtAt(const std::string& name) const;
  /// Whether `name` should be beside the text because its folder exists there: then its absence is an error
  /// of the text.
  bool isLocal(const std::string& name) const;
  /// The nearest existing file name in the local folder, or empty.
  std::string nearestLocal(const std::string& name) const;

 private:
  [[noreturn]] void refuse(const std::string& name, const std::string& what) const;
  std::filesystem::path sceneFile_;
  std::vector<std::filesystem::path> directories_;  // the first is the scene's own
};

}  // namespace lumivox

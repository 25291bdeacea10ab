// Where model and image files are sought.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox {

/// Seeks files named in a scene text: beside the text, then in SceneLoadOptions::assetPath, then in each
/// directory of $LUMIVOX_ASSETS (separated by colons), then in ../shared/models beside the project that holds
/// the text and beside the one that the program comes from.
class AssetSearch {
 public:
  AssetSearch(const std::filesystem::path& sceneFile, const SceneLoadOptions& options);

  std::optional<std::filesystem::path> find(const std::string& name) const;
  /// As find(), for folders too.
  std::optional<std::filesystem::path> findAny(const std::string& name) const;
  /// Every place where `name` was sought, for messages.
  std::string soughtAt(const std::string& name) const;
  /// Whether `name` is meant to be beside the text, so that its absence is an error of the text: its folder
  /// is there.
  bool isLocal(const std::string& name) const;
  /// The nearest existing file name in the local folder, or empty.
  std::string nearestLocal(const std::string& name) const;

 private:
  std::vector<std::filesystem::path> directories_;  // the first is the scene's own
};

}  // namespace lumivox

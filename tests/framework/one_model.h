// A scene of one mesh block with a model of any format, written for a test.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/scene/scene.h"
#include "support/support.h"

namespace lumivox::test {

/// A scene with one mesh `m` of the file `name`.
struct OneModel {
  TemporaryDirectory directory;
  std::filesystem::path file;

  OneModel(const std::string& name, const std::string& bytes, const std::string& mesh = "",
           const std::string& more = "") {
    directory.write(name, bytes);
    file = directory.write(
        "a.scene", "scene \"x\" {\ncamera main { eye 0 0 9  target 0 0 0 }\nmesh m {\nfile \"" + name +
                       "\"\n" + mesh + "\n}\n" + more + "\n}\n");
  }
  Scene load(bool strict = false) const {
    SceneLoadOptions options;
    options.strict = strict;
    return loadScene(file, options);
  }
  std::string error() const {
    return messageOf<Error>([&] { load(); });
  }
  std::pair<Scene, std::string> logged() const {
    const LogCapture log;
    Scene scene = load();
    return {std::move(scene), log.text()};
  }
};

/// The corners of all triangles in the order of the scene's parts.
inline std::vector<glm::vec3> cornersOf(const Scene& scene) {
  std::vector<glm::vec3> corners;
  for (const std::uint32_t index : scene.indices) corners.push_back(scene.positions[index]);
  return corners;
}

}  // namespace lumivox::test

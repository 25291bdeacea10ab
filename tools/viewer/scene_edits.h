// What was switched off or changed in the scene panel, apart from the scene's text.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox::viewer {

/// Other values of a material; what is absent stays as the scene has it.
struct MaterialEdit {
  std::optional<glm::vec3> diffuse, specular, emission;
  std::optional<float> exponent;
  bool operator==(const MaterialEdit&) const = default;
};

struct SceneEdits {
  /// Names as parts() gives them.
  std::set<std::string> off;
  std::map<std::string, glm::vec3> powers;  ///< of lights, as Light::power
  std::map<std::string, MaterialEdit> materials;
  std::optional<glm::vec3> environment;
  bool operator==(const SceneEdits&) const = default;
  bool empty() const { return *this == SceneEdits(); }
};

/// What can be switched off in a scene: "environment", "gloss", "light NAME", "object NAME", "medium NAME".
std::vector<std::string> partsOf(const Scene& scene);

/// The scene with the edits. Names that it lacks are passed over: the text may have changed since. Its hash
/// is that of the scene and the edits.
Scene edited(const Scene& scene, const SceneEdits& edits);

}  // namespace lumivox::viewer

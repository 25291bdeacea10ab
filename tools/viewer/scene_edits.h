// The edits of the scene panel, kept apart from the scene's text.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox::viewer {

/// New values of a material; absent ones keep the scene's value.
struct MaterialEdit {
  std::optional<glm::vec3> diffuse, specular, emission;
  std::optional<float> exponent;
  bool operator==(const MaterialEdit&) const = default;
};
struct MediumEdit {
  std::optional<glm::vec3> extinction, albedo;
  std::optional<float> anisotropy;
  bool operator==(const MediumEdit&) const = default;
};
struct CameraEdit {
  std::optional<glm::dvec3> eye, target;
  std::optional<double> fov;
  bool operator==(const CameraEdit&) const = default;
};

struct SceneEdits {
  /// Names as partsOf() gives them.
  std::set<std::string> off;
  std::map<std::string, glm::vec3> powers;  ///< of lights, as Light::power; of area lights their radiance
  std::map<std::string, MaterialEdit> materials;  ///< by materialName()
  std::map<std::string, MediumEdit> media;
  std::map<std::string, CameraEdit> cameras;
  std::optional<glm::vec3> environment;
  bool operator==(const SceneEdits&) const = default;
  bool empty() const { return *this == SceneEdits(); }
};

/// The material of an area light's surface is called MATERIAL@LIGHT. materialName(): the name without the
/// light. areaLightOf(): the light's name, empty if it is no area light.
std::string materialName(const Material& material);
std::string areaLightOf(const Material& material);

/// A light as it can be edited: a light without extent, or an area light.
struct EditableLight {
  std::string name;
  bool area = false;
  glm::vec3 power{0.0f};
  bool keyed = false;  ///< its power is that of keys, and cannot be edited
};
std::vector<EditableLight> editableLights(const Scene& scene);
/// Whether its place is that of keys or rates, which cannot be edited; and the same of its fov.
bool moves(const Camera& camera);
bool hasKeysOfFov(const Camera& camera);
/// Materials without duplicate names, with their own emission instead of an area light's.
std::vector<Material> editableMaterials(const Scene& scene);

/// What can be switched off in a scene: "environment", "gloss", "light NAME", "object NAME", "medium NAME".
std::vector<std::string> partsOf(const Scene& scene);

/// The scene with the edits; its hash covers the scene and the edits. Names that the scene lacks are ignored,
/// since the text may have changed. Error if a material would reflect more than it receives, or if a camera
/// has no view direction.
Scene edited(const Scene& scene, const SceneEdits& edits);

/// The scene's text with these edits in the canonical layout, for a file in the same folder. `view`, if
/// given, becomes its first camera. The text was parsed and gives the edited scene. Error if it cannot
/// express the edits, such as those of an included file.
std::string textWithEdits(const Scene& scene, const SceneEdits& edits, const Camera* view,
                          const SceneLoadOptions& options);

}  // namespace lumivox::viewer

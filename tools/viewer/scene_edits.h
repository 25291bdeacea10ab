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

/// A surface whose emission is an area light's is called MATERIAL@LIGHT: the name without the light, and the
/// light's, empty where it is none.
std::string materialName(const Material& material);
std::string areaLightOf(const Material& material);

/// A light of the scene as it is edited: one without extent, or the name of an area light.
struct EditableLight {
  std::string name;
  bool area = false;
  glm::vec3 power{0.0f};
};
std::vector<EditableLight> editableLights(const Scene& scene);
/// Materials, each once by its name, with the emission that is its own.
std::vector<Material> editableMaterials(const Scene& scene);

/// What can be switched off in a scene: "environment", "gloss", "light NAME", "object NAME", "medium NAME".
std::vector<std::string> partsOf(const Scene& scene);

/// The scene with the edits. Names that it lacks are passed over: the text may have changed since. Its hash
/// is that of the scene and the edits. Error when a material then reflects more than it receives, or a camera
/// looks nowhere.
Scene edited(const Scene& scene, const SceneEdits& edits);

/// The scene's text with these edits, and with a camera `view` as its first where one is given, in the
/// canonical layout: a text for the folder of the scene's own. It was read, and gives the edited scene; Error
/// when it cannot, as for what an included file says.
std::string textWithEdits(const Scene& scene, const SceneEdits& edits, const Camera* view,
                          const SceneLoadOptions& options);

}  // namespace lumivox::viewer

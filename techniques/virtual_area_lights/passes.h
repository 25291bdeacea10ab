// The technique's passes, file by file.
#pragma once

#include <vector>

#include "lumivox/plugin/technique.h"
#include "points/surface_points_binding.h"
#include "sparse_light.h"

namespace lumivox::virtual_area_lights {

void addPoints(TechniqueRegistry& registry);
void addVertices(TechniqueRegistry& registry);
void addLook(TechniqueRegistry& registry);
void addGather(TechniqueRegistry& registry);
void addNormalise(TechniqueRegistry& registry);
void addOcclude(TechniqueRegistry& registry);
void addApply(TechniqueRegistry& registry);
void addPixels(TechniqueRegistry& registry);
void addBruteForce(TechniqueRegistry& registry);
void addBounce(TechniqueRegistry& registry);

/// How lights are occluded. One value for `gather` and `occlude`.
enum class Visibility { sphere, directions };
inline constexpr const char* kVisibilityMeaning =
    "what tells whether lights are visible; sphere: `occlude`, with one share for all lights of a point (Lensing & Broll 2013, Sec. 3.3); directions: `gather` asks the nearest disc in the direction of each light, and open directions bring the environment";

/// The camera's position, which is all that a glossy lobe reads of it.
inline std::vector<float> eyeOf(const SceneSnapshot& snapshot) {
  const glm::vec3& eye = snapshot.camera.eye;
  return {eye.x, eye.y, eye.z};
}

}  // namespace lumivox::virtual_area_lights

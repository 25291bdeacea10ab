// The technique's passes, file by file.
#pragma once

#include <vector>

#include "lumivox/plugin/technique.h"
#include "points/surface_points_binding.h"
#include "sparse_light.h"

namespace lumivox::virtual_area_lights {

void addPoints(TechniqueRegistry& registry);
void addVertices(TechniqueRegistry& registry);
void addGather(TechniqueRegistry& registry);
void addNormalise(TechniqueRegistry& registry);
void addOcclude(TechniqueRegistry& registry);
void addApply(TechniqueRegistry& registry);
void addPixels(TechniqueRegistry& registry);
void addBruteForce(TechniqueRegistry& registry);

/// The camera's position, which is all that a glossy lobe reads of it.
inline std::vector<float> eyeOf(const SceneSnapshot& snapshot) {
  const glm::vec3& eye = snapshot.camera.eye;
  return {eye.x, eye.y, eye.z};
}

}  // namespace lumivox::virtual_area_lights

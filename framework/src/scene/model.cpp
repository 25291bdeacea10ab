#include "scene/model.h"

#include <algorithm>

#include "scene/description.h"
#include "scene/gltf_model.h"
#include "scene/obj_model.h"
#include "scene/ply_model.h"

namespace lumivox {

Model loadModel(const std::vector<std::filesystem::path>& frames, const ModelOptions& options,
                Hasher& hasher) {
  const std::string name = frames.front().filename().string();
  if (hasFormat(name, kGltfFormats)) return loadGltfModel(frames.front(), options, hasher);
  if (hasFormat(name, kPlyFormats)) return loadPlyModel(frames.front(), options, hasher);
  return loadObjModel(frames, options, hasher);
}

bool hasArea(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  constexpr double kLeastHeight = 0x1.0p-23;
  const double longest = std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
  return glm::length(glm::cross(b - a, c - a)) > kLeastHeight * longest;
}

glm::vec3 unitNormal(const glm::vec3& v) {
  return glm::vec3(glm::normalize(glm::dvec3(v)));
}

}  // namespace lumivox

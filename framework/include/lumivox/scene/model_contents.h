// What a model file holds, for those who write a scene around it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox {

struct ModelContents {
  struct ModelPart {
    std::string name;  ///< as texts select it; empty: the whole file
    std::uint64_t triangles = 0, vertices = 0;
    std::vector<std::string> materials;
    bool isMoving = false, isDeforming = false;
  };
  struct UsedMaterial {
    Material values;                      ///< without images
    std::filesystem::path texture, mask;  ///< files; empty for none and for embedded ones
    bool hasEmbeddedImages = false;
    float coverage = 1.0f;  ///< factor of the mask; below a half without one: a hole
  };
  struct Animation {
    std::string name;
    double duration = 0.0;  ///< s
  };
  std::vector<ModelPart> parts;
  std::vector<UsedMaterial> materials;  ///< of triangles, each name once
  std::vector<Camera> cameras;          ///< with keys if they move
  std::vector<Light> lights;            ///< at the start of the animation
  std::vector<Animation> animations;
  std::pair<glm::dvec3, glm::dvec3> bounds;  ///< at the start, m
};

/// Reads a model as a mesh block does that places nothing. Throws as loadScene().
ModelContents readModelContents(const std::filesystem::path& file);

}  // namespace lumivox

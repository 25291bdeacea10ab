// The pass that traces paths through bits, on inputs that tests make.
#pragma once

#include <functional>
#include <vector>

#include "support/near_field.h"

namespace lumivox::test::voxel_paths {

using near_field::Gatherer;

/// The pass over one surface point. `specular`: albedo and exponent of its Phong lobe, if it has one.
inline Gatherer tracer(const BinaryGrid& bits, const glm::vec3& position, const glm::vec3& normal,
                       const Scene& scene = SceneBuilder().scene, float diffuse = 0.5f,
                       const glm::vec4& specular = glm::vec4(0.0f)) {
  Gatherer result(bits, scene, 8, 8, "voxel_path_tracing.trace");
  GBuffer seen = gbufferAt({position, normal, glm::vec3(diffuse), specular});
  if (specular == glm::vec4(0.0f)) seen.specular = nullptr;
  result.in("gbuffer", seen);
  return result;
}

/// The shell of a cube of `side` voxels.
inline VoxelSet shellOf(int side) {
  VoxelSet set({side, side, side});
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z)
        if (std::min({x, y, z}) == 0 || std::max({x, y, z}) == side - 1) set.insert({x, y, z});
  return set;
}

/// The attributes of each voxel, x fastest, with the normal that the function gives.
inline AttributeGrid attributesWhere(const glm::ivec3& size, float albedo,
                                     const std::function<glm::vec3(const glm::ivec3&)>& normalAt) {
  std::vector<float> albedos, normals;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const glm::vec3 normal = normalAt({x, y, z});
        const bool is = normal != glm::vec3(0.0f);
        for (int c = 0; c < 3; ++c) {
          normals.push_back(normal[c]);
          albedos.push_back(is ? albedo : 0.0f);
        }
        normals.push_back(0.0f);
        albedos.push_back(is ? 1.0f : 0.0f);
      }
  return {{glm::vec3(0.0f), 1.0f, size},
          textureOf(volumeOf(size), albedos),
          textureOf(volumeOf(size), normals),
          nullptr};
}

/// Attributes of the shell: normals that point inwards, and this albedo.
inline AttributeGrid attributesOfShell(int side, float albedo) {
  return attributesWhere(glm::ivec3(side), albedo, [side](const glm::ivec3& at) {
    glm::vec3 normal(0.0f);
    for (int axis = 0; axis < 3 && normal == glm::vec3(0.0f); ++axis) {
      if (at[axis] == 0) normal[axis] = 1.0f;
      if (at[axis] == side - 1) normal[axis] = -1.0f;
    }
    return normal;
  });
}

/// A map in which every surface around has this reflected radiance and albedo.
inline ReflectiveShadowMap shiningAll(float radiance, float albedo, const glm::dvec3& from) {
  SceneBuilder builder;
  builder.box(glm::vec3(-1.0f), glm::vec3(1.0f), builder.lambert(0.5f), true);
  builder.light(LightKind::point, glm::vec3(1.0f), from);
  ReflectiveShadowMap map = near_field::mapOf(builder.scene, 4, glm::vec4(glm::vec3(from), 1.0f),
                                              {0, 1, 0, 1}, near_field::fluxOf(radiance));
  map.albedo = filled(layers(4, 4, map.layerCount), glm::vec4(glm::vec3(albedo), 1.0f));
  return map;
}

}  // namespace lumivox::test::voxel_paths

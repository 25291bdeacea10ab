// The pass that traces paths through bits, on what tests make by hand.
#pragma once

#include "support/near_field.h"

namespace lumivox::test::voxel_paths {

using near_field::Gatherer;

inline Gatherer tracer(const BinaryGrid& bits, const Scene& scene = SceneBuilder().scene, int side = 8) {
  return Gatherer(bits, scene, side, side, "voxel_path_tracing", "trace");
}

/// The shell of a cube of so many voxels a side.
inline VoxelSet shellOf(int side) {
  VoxelSet set({side, side, side});
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z)
        if (std::min({x, y, z}) == 0 || std::max({x, y, z}) == side - 1) set.insert({x, y, z});
  return set;
}

inline gpu::TextureRef volumeOf(const glm::ivec3& size, const std::vector<glm::vec4>& values) {
  auto texture = std::make_shared<gpu::Texture>(
      device(),
      gpu::TextureDescription{gpu::TextureKind::d3, gpu::Format::rgba32f, size.x, size.y, size.z, 1},
      "test volume");
  texture->upload(0, std::as_bytes(std::span(values)));
  return texture;
}

/// Voxels of the shell look inwards, and reflect so much.
inline AttributeGrid attributesOf(int side, float albedo) {
  const glm::ivec3 size(side);
  std::vector<glm::vec4> albedos, normals;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const glm::ivec3 at(x, y, z);
        glm::vec4 normal(0.0f);
        for (int axis = 0; axis < 3 && normal == glm::vec4(0.0f); ++axis) {
          if (at[axis] == 0) normal[axis] = 1.0f;
          if (at[axis] == side - 1) normal[axis] = -1.0f;
        }
        normals.push_back(normal);
        albedos.push_back(normal == glm::vec4(0.0f) ? glm::vec4(0.0f) : glm::vec4(glm::vec3(albedo), 1.0f));
      }
  return {{glm::vec3(0.0f), 1.0f, size}, volumeOf(size, albedos), volumeOf(size, normals), nullptr};
}

/// A map that makes every surface around shine with this radiance and reflect so much.
inline ReflectiveShadowMap shiningAll(float radiance, float albedo, const glm::dvec3& from) {
  SceneBuilder builder;
  builder.box(glm::vec3(-1.0f), glm::vec3(1.0f), builder.lambert(0.5f), true);
  builder.light(LightKind::point, glm::vec3(1.0f), from);
  ReflectiveShadowMap map = near_field::mapOf(builder.scene, 4, glm::vec4(glm::vec3(from), 1.0f),
                                              {0, 1, 0, 1}, near_field::fluxOf(radiance));
  map.albedo = near_field::filledLayers(4, map.layerCount, glm::vec4(glm::vec3(albedo), 1.0f));
  return map;
}

}  // namespace lumivox::test::voxel_paths

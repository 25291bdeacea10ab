// Placement of a clipmap's levels and its bindings.
#pragma once

#include "lumivox/plugin/technique.h"
#include "radiance_clipmap.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {

/// Levels of a clipmap in the scene.
struct ClipmapPlacement {
  glm::vec3 origin{0.0f};         ///< corner of voxel (0,0,0) of all levels, m
  float voxelSize = 1.0f;         ///< of the finest level, m
  int resolution = 0;             ///< voxels along each side of a level
  std::vector<glm::ivec3> first;  ///< first voxel of each level, at its corner
  /// Voxels of each level within the store; set where the coarsest level holds the scene.
  std::vector<VoxelRange> scene;
  /// Extent in finest voxels that rounding depends on: the whole scene, and around the origin where levels
  /// follow the camera. It does not depend on the camera.
  float sceneSide = 0.0f;

  int levels() const { return static_cast<int>(first.size()); }
  VoxelRange rangeOf(int level) const {
    const glm::ivec3 low = first[static_cast<std::size_t>(level)];
    return {low, low + resolution};
  }
  /// Whether the voxels are the same, even if levels have moved.
  bool sameVoxels(const ClipmapPlacement& other) const {
    return origin == other.origin && voxelSize == other.voxelSize && resolution == other.resolution &&
           scene == other.scene && sceneSide == other.sceneSide && first.size() == other.first.size();
  }
};

/// Places levels around the camera, each moved by whole voxels of its own. Without a `finestExtent` the
/// coarsest holds the scene and does not move, and finer ones stay within the scene; a single level is then
/// that of placeGrid(). With one, the finest level is so many metres wide. Finer levels lie in coarser ones.
/// The result depends on the arguments alone.
ClipmapPlacement placeClipmap(const SceneSnapshot& snapshot, int resolution, int levels, float finestExtent);

/// The voxels of the next coarser level that overlap these.
VoxelRange coarserTouching(const VoxelRange& finer);

/// The blocks of all levels, and the sizes of the volumes and bits that hold them.
struct ClipmapLayout {
  std::vector<RadianceClipmap::Level> levels;
  glm::ivec3 volume{0};
  std::uint64_t words = 0;
  std::uint64_t bytes(gpu::Format format) const {
    return 6 * GridPlacement{.resolution = volume}.voxelCount() * gpu::bytesPerTexel(format) +
           words * sizeof(std::uint32_t);
  }
};
ClipmapLayout layoutOf(const ClipmapPlacement& placement);

/// The block Clipmap of clipmap.glsl.
gpu::ResourceBinding clipmapBinding(const RadianceClipmap& clipmap);

/// Bindings for reading the volumes, under the shaders' names of faces.
shader::BindingSet facesOf(const std::array<gpu::TextureRef, 6>& faces, gpu::Sampling sampling);
/// Bindings for writing the volumes and the bits of occupied voxels (clipmap_write.glsl).
shader::BindingSet writing(const RadianceClipmap& clipmap);

}  // namespace lumivox::voxel_cone_tracing

// Where the levels of a clipmap lie, and how passes bind it.
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
  std::vector<glm::ivec3> first;  ///< voxel of each level at its corner
  /// Voxels of each level that lie beyond no side of the store; where the coarsest holds the scene.
  std::vector<VoxelRange> scene;
  /// Voxels of the finest level along the whole scene, and around the origin where levels follow the camera:
  /// what rounding goes by. It does not depend on the camera.
  float sceneSide = 0.0f;

  int levels() const { return static_cast<int>(first.size()); }
  VoxelRange rangeOf(int level) const {
    const glm::ivec3 low = first[static_cast<std::size_t>(level)];
    return {low, low + resolution};
  }
  /// The same voxels: levels may have moved.
  bool sameVoxels(const ClipmapPlacement& other) const {
    return origin == other.origin && voxelSize == other.voxelSize && resolution == other.resolution &&
           scene == other.scene && sceneSide == other.sceneSide && first.size() == other.first.size();
  }
};

/// Levels around the camera, moved by whole voxels of their own. Without a `finestExtent` the coarsest holds
/// the scene and does not move, and the finer ones lie no further out than the scene; a placement of one
/// level is then that of placeGrid(). With one, the finest is so many metres wide. Finer levels lie in
/// coarser ones. A function of its arguments alone.
ClipmapPlacement placeClipmap(const SceneSnapshot& snapshot, int resolution, int levels, float finestExtent);

/// The voxels of the next coarser level that share any with these.
VoxelRange coarserTouching(const VoxelRange& finer);

/// The blocks of all levels, and the size of the volumes and the bits that hold them.
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

/// The volumes to be read, by the names that shaders have for faces.
shader::BindingSet facesOf(const std::array<gpu::TextureRef, 6>& faces, gpu::Sampling sampling);
/// To be written, with the bits of what is occupied (clipmap_write.glsl).
shader::BindingSet writing(const RadianceClipmap& clipmap);

}  // namespace lumivox::voxel_cone_tracing

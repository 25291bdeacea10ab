// Every store that cones read, over [-1,1]^3 with the same given contents, so that one law is tested over all
// stores.
#pragma once

#include <variant>

#include "support/clipmap.h"
#include "support/octree.h"

namespace lumivox::test::cones {

using AnyStore =
    std::variant<RadianceGrid, DirectionalRadianceGrid, octree::RadianceOctree, clipmap::RadianceClipmap>;

/// A kind of store, for GENERATE(from_range(kStoreKinds)).
struct StoreKind {
  enum class Of { grid, coarseFaces, faces, octree, octreeFaces, clipmap } of;
  const char* name;
  const char* opacity = "facing";
  /// Voxels along a side of the finest level. In a clipmap, along a side of each of its three levels, of
  /// which the coarsest spans [-1,1].
  int resolution = 64;
  double finest() const { return of == Of::clipmap ? 0.5 / resolution : 2.0 / resolution; }
  /// The values of parameter `reading` that suit this store.
  std::vector<const char*> readings() const {
    if (of == Of::grid || of == Of::octree) return {"layers"};
    return {"layers", "interpolated"};
  }
};
inline const std::vector<StoreKind> kStoreKinds{
    {StoreKind::Of::grid, "one grid"},
    {StoreKind::Of::grid, "one grid of means", "average"},
    {StoreKind::Of::coarseFaces, "coarse directional"},
    {StoreKind::Of::faces, "six grids"},
    {StoreKind::Of::octree, "octree"},
    {StoreKind::Of::octree, "octree of means", "average"},
    {StoreKind::Of::octreeFaces, "octree of six faces", "facing", 32},
    {StoreKind::Of::clipmap, "clipmap", "facing", 32}};

/// The value of a voxel's face from the voxel's centre and width (m) and the face: radiance times opacity,
/// with the opacity in w.
using StoreFill = std::function<glm::vec4(const glm::vec3& middle, float width, int face)>;

/// A store with all its levels. `levels`: settings for a clipmap.
inline AnyStore storeOf(const StoreKind& kind, const StoreFill& fill,
                        clipmap::ClipmapSettings levels = {.levels = 3, .extent = 0.5}) {
  const auto size = static_cast<float>(kind.finest());
  const auto faceAtVoxel = [&](int face, int x, int y, int z) {
    return fill((glm::vec3(x, y, z) + 0.5f) * size - 1.0f, size, face);
  };
  const auto voxel = [&](int x, int y, int z) { return faceAtVoxel(0, x, y, z); };
  switch (kind.of) {
    case StoreKind::Of::grid:
      return filtered(makeGrid(kind.resolution, voxel), kind.opacity);
    case StoreKind::Of::coarseFaces:
      return filteredDirections(makeGrid(kind.resolution, voxel));
    case StoreKind::Of::faces:
      return filteredDirections(makeDirections(kind.resolution, faceAtVoxel));
    case StoreKind::Of::octree:
      return octree::octreeOf(kind.resolution, faceAtVoxel, "one", kind.opacity);
    case StoreKind::Of::octreeFaces:
      return octree::octreeOf(kind.resolution, faceAtVoxel);
    case StoreKind::Of::clipmap:
      break;
  }
  levels.resolution = kind.resolution;
  return clipmap::madeClipmap(levels, glm::vec3(0.0f), [&](int level, const glm::vec3& middle, int face) {
    return fill(middle, size * static_cast<float>(1 << level), face);
  });
}

template <class Read>
auto gatherWith(const Scene& scene, const AnyStore& any, const GBuffer& gbuffer,
                const GatherSettings& settings, const Read& read) {
  return std::visit([&](const auto& store) { return gatherWith(scene, store, gbuffer, settings, read); },
                    any);
}
inline glm::vec3 gather(const Scene& scene, const AnyStore& any, const glm::vec3& position,
                        const glm::vec3& normal, const GatherSettings& settings) {
  return std::visit([&](const auto& store) { return gather(scene, store, position, normal, settings); }, any);
}
inline glm::vec3 alongNormal(const AnyStore& any, const glm::vec3& position, const glm::vec3& direction,
                             float exponent, const GatherSettings& settings) {
  return std::visit(
      [&](const auto& store) { return alongNormal(store, position, direction, exponent, settings); }, any);
}

/// The voxels of a face at a level that are not transparent, with their stored values.
using VoxelsAt = std::map<Cell, glm::vec4>;
inline VoxelsAt opaqueTexels(const std::vector<float>& texels, const glm::ivec3& size) {
  VoxelsAt result;
  for (int i = 0; i < size.x * size.y * size.z; ++i) {
    const float* texel = texels.data() + 4 * static_cast<std::size_t>(i);
    if (texel[3] > 0.0f)
      result[{i % size.x, i / size.x % size.y, i / (size.x * size.y)}] = {texel[0], texel[1], texel[2],
                                                                          texel[3]};
  }
  return result;
}
inline VoxelsAt voxelsOf(const RadianceGrid& grid, int /*face*/, int level) {
  return opaqueTexels(grid.radiance->downloadFloats(level), levelResolution(grid.grid.resolution, level));
}
inline VoxelsAt voxelsOf(const DirectionalRadianceGrid& grid, int face, int level) {
  const gpu::TextureRef& texture =
      level < grid.firstLevelOfFaces() ? grid.finest : grid.faces[static_cast<std::size_t>(face)];
  const int at = level < grid.firstLevelOfFaces() ? level : level - grid.firstLevelOfFaces();
  return opaqueTexels(texture->downloadFloats(at), levelResolution(grid.grid.resolution, level));
}
inline VoxelsAt voxelsOf(const octree::RadianceOctree& octree, int face, int level) {
  VoxelsAt result;
  for (const auto& [place, voxels] : octree::bricksOf(octree, level, face))
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 local(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::vec4& value = voxels[static_cast<std::size_t>(corner)];
      if (value.w > 0.0f)
        result[octree::cellOf(2 * glm::ivec3(place[0], place[1], place[2]) + local)] = value;
    }
  return result;
}

}  // namespace lumivox::test::cones

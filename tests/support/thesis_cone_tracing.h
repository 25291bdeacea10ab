// Passes of thesis_cone_tracing over stores with given contents.
#pragma once

#include <map>
#include <string>

#include "../../techniques/thesis_cone_tracing/octree_ports.h"
#include "support/cones.h"
#include "support/octree.h"

namespace lumivox::test::thesis {

using octree::cellOf;
using octree::fragmentAt;
using octree::fragmentsWhere;
using octree::listOf;
using thesis_cone_tracing::OctreeBricks;
using thesis_cone_tracing::OctreeNodes;

/// A pass of the technique on a scene.
inline PassHarness passOf(const char* name, const Scene& scene) {
  return PassHarness(device(), techniques(), "thesis_cone_tracing", name, scene, snapshotOf(scene, 0.0));
}

/// Filters the coarser levels as printed.
inline RadianceGrid mipmapped(const RadianceGrid& finest, bool drawn = false) {
  const Scene scene = cones::emptyScene();
  PassHarness mipmap = passOf("mipmap", scene);
  mipmap.setParameter("drawn", std::string(drawn ? "on" : "off"));
  mipmap.setInput("radiance", finest);
  mipmap.run();
  return mipmap.output<RadianceGrid>("mips");
}
inline DirectionalRadianceGrid mipmapped(const DirectionalRadianceGrid& finest, bool drawn = false) {
  const Scene scene = cones::emptyScene();
  PassHarness mipmap = passOf("mipmap_directional", scene);
  mipmap.setParameter("drawn", std::string(drawn ? "on" : "off"));
  mipmap.setInput("radiance", finest);
  mipmap.run();
  return mipmap.output<DirectionalRadianceGrid>("mips");
}

struct GatherSettings {
  double coneRatio = 1.1547005383792515, reach = 0, jitter = 0;
  std::uint64_t seed = 1;
};

inline const char* inputOf(const RadianceGrid&) {
  return "grid";
}
inline const char* inputOf(const DirectionalRadianceGrid&) {
  return "directions";
}
inline const char* inputOf(const OctreeBricks&) {
  return "octree";
}

/// An output of `gather` for a g-buffer: "diffuse" or "glossy".
template <class Store>
ImageBuffer gathered(const Scene& scene, const Store& store, const GBuffer& gbuffer, const char* output,
                     const GatherSettings& settings) {
  PassHarness gather = passOf("gather", scene);
  gather.setParameter("cone_ratio", settings.coneRatio);
  gather.setParameter("reach", settings.reach);
  gather.setParameter("jitter", settings.jitter);
  gather.setInput("gbuffer", gbuffer);
  gather.setInput(inputOf(store), store);
  gather.run(settings.seed);
  return imageOf(*gather.template output<Image>(output).texture);
}

/// Indirect diffuse radiance at one surface point of albedo 1.
template <class Store>
glm::vec3 gather(const Scene& scene, const Store& store, const glm::vec3& position, const glm::vec3& normal,
                 const GatherSettings& settings = {}) {
  return cones::pixelOf(
      gathered(scene, store, cones::surfacePoint(position, normal, glm::vec3(1.0f)), "diffuse", settings));
}

/// Indirect glossy radiance at one surface point.
template <class Store>
glm::vec3 gatherGlossy(const Scene& scene, const Store& store, const glm::vec3& position,
                       const glm::vec3& normal, const glm::vec4& specular,
                       const GatherSettings& settings = {}) {
  return cones::pixelOf(gathered(
      scene, store, cones::surfacePoint(position, normal, glm::vec3(0.0f), specular), "glossy", settings));
}

/// The radiance that the cone of a mirroring lobe gathers along a direction.
template <class Store>
glm::vec3 alongDirection(const Store& store, const glm::vec3& position, const glm::vec3& direction,
                         float exponent, const GatherSettings& settings = {}) {
  Scene scene = cones::emptyScene();
  scene.cameras.front().eye = glm::dvec3(position) + 2.0 * glm::dvec3(direction);
  return gatherGlossy(scene, store, position, direction, glm::vec4(1, 1, 1, exponent), settings);
}

inline OctreeNodes treeOf(const VoxelFragments& list, const char* voxels = "in_leaves") {
  const Scene scene = cones::emptyScene();
  PassHarness tree = passOf("octree", scene);
  tree.setParameter("voxels", std::string(voxels));
  tree.setInput("fragments", list);
  tree.run();
  return tree.output<OctreeNodes>("tree");
}

/// The finest level of an octree whose fragments reflect their albedo.
inline OctreeBricks leavesOf(const VoxelFragments& list, const char* voxels = "in_leaves") {
  const Scene scene = cones::emptyScene();
  PassHarness leaves = passOf("octree_leaves", scene);
  leaves.setParameter("ambient", octree::kAmbient);
  leaves.setInput("fragments", list);
  leaves.setInput("tree", treeOf(list, voxels));
  leaves.run();
  return leaves.output<OctreeBricks>("radiance");
}

inline OctreeBricks mipmapped(const OctreeBricks& leaves, const char* borders = "averaged") {
  const Scene scene = cones::emptyScene();
  PassHarness mipmap = passOf("octree_mipmap", scene);
  mipmap.setParameter("borders", std::string(borders));
  mipmap.setInput("radiance", leaves);
  mipmap.run();
  return mipmap.output<OctreeBricks>("mips");
}

/// The voxels of a brick, x fastest.
using Brick = std::array<glm::vec4, 27>;

/// Every brick of a level, by its node's position.
inline std::map<Cell, Brick> bricksOf(const OctreeBricks& octree, int level) {
  const std::vector<float> texels = octree.radiance->downloadFloats(0);
  const glm::ivec3 size = octree.poolSize();
  std::map<Cell, Brick> result;
  for (const OctreeNodes::Brick& brick : octree.tree.bricksOf(level)) {
    Brick& values = result[cellOf(brick.place)];
    for (int i = 0; i < OctreeNodes::kBrickVoxels; ++i) {
      const glm::ivec3 at = octree.texelOf(brick.index) + glm::ivec3(i % 3, i / 3 % 3, i / 9);
      const std::size_t texel = 4 * static_cast<std::size_t>((at.z * size.y + at.y) * size.x + at.x);
      values[static_cast<std::size_t>(i)] = {texels[texel], texels[texel + 1], texels[texel + 2],
                                             texels[texel + 3]};
    }
  }
  return result;
}

}  // namespace lumivox::test::thesis

// Sparse voxel octrees of given fragments, and their contents read back.
#pragma once

#include <array>
#include <functional>
#include <glm/gtc/packing.hpp>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "../../techniques/voxel_cone_tracing/octree/radiance_octree.h"
#include "support/cones.h"
#include "support/voxel_fragments.h"

namespace lumivox::voxel_cone_tracing {

/// The name of gather's input for this store, for test::cones::gather.
inline const char* inputOf(const RadianceOctree&) {
  return "octree";
}

}  // namespace lumivox::voxel_cone_tracing

namespace lumivox::test::octree {

using voxel_cone_tracing::OctreeBrickList;
using voxel_cone_tracing::RadianceOctree;
using voxel_cone_tracing::VoxelOctree;

inline constexpr std::uint32_t kNone = ~0u;

inline FragmentData fragmentAt(const glm::ivec3& cell, const glm::vec3& albedo = glm::vec3(0.5f),
                               float coverage = 1.0f) {
  FragmentData result{};
  result.voxel = static_cast<std::uint32_t>(cell.x | cell.y << 10 | cell.z << 20);
  result.offset = 512u | 512u << 10 | 512u << 20;
  result.albedoRg = glm::packHalf2x16(glm::vec2(albedo));
  result.albedoBCoverage = glm::packHalf2x16(glm::vec2(albedo.z, coverage));
  return result;
}

/// A list over a grid that spans [-1,1] along its longest side.
inline VoxelFragments listOf(const std::vector<FragmentData>& fragments, const glm::ivec3& size,
                             gpu::Device& on = device()) {
  VoxelFragments list;
  const int longest = std::max({size.x, size.y, size.z});
  list.grid = {glm::vec3(-1.0f), 2.0f / static_cast<float>(longest), size};
  list.capacity = std::max<std::size_t>(fragments.size(), 1);
  list.fragments = std::make_shared<gpu::Buffer>(on, list.capacity * sizeof(FragmentData), "list");
  if (!fragments.empty()) list.fragments->uploadValues(std::span<const FragmentData>(fragments));
  const auto count = static_cast<std::uint32_t>(fragments.size());
  const std::uint32_t groups = std::max((count + 63u) / 64u, 1u), rows = (groups + 65534u) / 65535u;
  const std::array<std::uint32_t, 4> words{count, std::min(groups, 65535u), rows, 1};
  list.count = std::make_shared<gpu::Buffer>(on, sizeof(words), "count");
  list.count->uploadValues(std::span<const std::uint32_t>(words));
  return list;
}

inline VoxelOctree treeOf(const VoxelFragments& list) {
  const Scene scene = cones::emptyScene();
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", "octree", scene, snapshotOf(scene, 0.0));
  harness.setInput("fragments", list);
  harness.run();
  return harness.output<VoxelOctree>("tree");
}

/// The number of wanted bricks, and of nodes in which a read finds a value.
inline std::array<std::uint32_t, 2> wantedOf(const VoxelOctree& tree) {
  const auto words = tree.levels->downloadValues<std::uint32_t>();
  return {words.at(0), words.at(1)};
}

inline Cell cellOf(const glm::ivec3& place) {
  return {place.x, place.y, place.z};
}

/// Bytes that cones read of a store of floats: bricks with their positions, the eight bricks around each
/// node, and the ranks that find both.
inline std::uint64_t storeBytes(const VoxelOctree& tree) {
  constexpr std::uint64_t kBrick = VoxelOctree::kBrickVoxels * 4 * sizeof(float);
  return wantedOf(tree)[0] * (kBrick + VoxelOctree::kBrickBytes) +
         wantedOf(tree)[1] * VoxelOctree::kCornersBytes + tree.ranks->sizeBytes() + tree.shown->sizeBytes();
}

/// Irradiance under which a fragment reflects its albedo, W/m^2.
inline constexpr double kAmbient = kPi;

/// The finest level of an octree whose fragments reflect their albedo.
inline RadianceOctree leavesOf(const VoxelFragments& list, const char* precision = "float",
                               const char* faces = "one") {
  const Scene scene = cones::emptyScene();
  PassHarness inject(device(), techniques(), "voxel_cone_tracing", "octree_inject", scene,
                     snapshotOf(scene, 0.0));
  inject.setParameter("ambient", kAmbient);
  inject.setParameter("precision", std::string(precision));
  inject.setParameter("faces", std::string(faces));
  inject.setInput("fragments", list);
  inject.setInput("tree", treeOf(list));
  inject.run();
  return inject.output<RadianceOctree>("radiance");
}

/// The finest level of the octree of a scene under its lights.
inline RadianceOctree injectedOctree(const Scene& scene, int resolution,
                                     const cones::InjectSettings& settings = {}, const char* faces = "one") {
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness voxels(device(), techniques(), "voxelization", "conservative", scene, snapshot);
  voxels.setParameter("resolution", resolution);
  voxels.run();
  const auto fragments = voxels.output<VoxelFragments>("fragments");
  PassHarness shadow(device(), techniques(), "direct_lighting", "shadow_map", scene, snapshot);
  shadow.run();
  PassHarness inject(device(), techniques(), "voxel_cone_tracing", "octree_inject", scene, snapshot);
  inject.setParameter("precision", std::string(settings.precision));
  inject.setParameter("bounces", settings.bounces);
  inject.setParameter("faces", std::string(faces));
  inject.setInput("fragments", fragments);
  inject.setInput("tree", treeOf(fragments));
  inject.setInput("shadow", shadow.output<ShadowMap>("depth"));
  inject.run();
  return inject.output<RadianceOctree>("radiance");
}

inline RadianceOctree filteredOctree(const RadianceOctree& leaves, const char* opacity = "facing") {
  const Scene scene = cones::emptyScene();
  PassHarness filter(device(), techniques(), "voxel_cone_tracing", "octree_filter", scene,
                     snapshotOf(scene, 0.0));
  filter.setParameter("opacity", std::string(opacity));
  filter.setInput("radiance", leaves);
  filter.run();
  return filter.output<RadianceOctree>("mips");
}

/// The voxels of every brick of a level, x fastest, by the node's position.
inline std::map<Cell, std::array<glm::vec4, 8>> bricksOf(const RadianceOctree& octree, int level,
                                                         int face = 0) {
  const std::vector<float> texels = octree.radiance->downloadFloats(0);
  const gpu::TextureDescription& pool = octree.radiance->description();
  std::map<Cell, std::array<glm::vec4, 8>> result;
  for (const auto& brick : OctreeBrickList::of(octree.tree, level).bricks) {
    auto& values = result[cellOf(brick.place)];
    for (int i = 0; i < VoxelOctree::kBrickVoxels; ++i) {
      const glm::ivec3 local(i & 1, i >> 1 & 1, i >> 2);
      const glm::ivec3 at = octree.texelOf(brick.index, face) + local;
      const std::size_t texel = 4 * static_cast<std::size_t>((at.z * pool.height + at.y) * pool.width + at.x);
      values[static_cast<std::size_t>(i)] = {texels[texel], texels[texel + 1], texels[texel + 2],
                                             texels[texel + 3]};
    }
  }
  return result;
}

/// Fragments in all voxels of a grid for which `fill` gives an opacity, in w, above 0.
inline std::vector<FragmentData> fragmentsWhere(const glm::ivec3& size,
                                                const std::function<glm::vec4(const glm::ivec3&)>& fill) {
  std::vector<FragmentData> result;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const glm::vec4 value = fill({x, y, z});
        if (value.w > 0.0f) result.push_back(fragmentAt({x, y, z}, glm::vec3(value), value.w));
      }
  return result;
}

/// An octree over a grid of [-1,1]^3 with all levels. `fill` gives the finest voxels by face and voxel, as
/// for cones::makeDirections. Leaves exist only where the opacity of some face is above 0.
inline RadianceOctree octreeOf(int resolution, const std::function<glm::vec4(int, int, int, int)>& fill,
                               const char* faces = "six", const char* opacity = "facing") {
  const auto isSomething = [&](const glm::ivec3& at) {
    bool found = false;
    for (int face = 0; face < 6 && !found; ++face) found = fill(face, at.x, at.y, at.z).w > 0.0f;
    return glm::vec4(found ? 1.0f : 0.0f);
  };
  const glm::ivec3 size(resolution);
  RadianceOctree octree = leavesOf(listOf(fragmentsWhere(size, isSomething), size), "float", faces);
  const gpu::TextureDescription& pool = octree.radiance->description();
  std::vector<float> texels = octree.radiance->downloadFloats(0);
  for (const auto& brick : OctreeBrickList::of(octree.tree, 0).bricks)
    for (int i = 0; i < VoxelOctree::kBrickVoxels * octree.faces; ++i) {
      const int face = i / VoxelOctree::kBrickVoxels;
      const glm::ivec3 local(i & 1, i >> 1 & 1, i >> 2 & 1), at = octree.texelOf(brick.index, face) + local,
                                                             voxel = 2 * brick.place + local;
      const glm::vec4 value = glm::any(glm::greaterThanEqual(voxel, size))
                                  ? glm::vec4(0.0f)
                                  : fill(face, voxel.x, voxel.y, voxel.z);
      for (int c = 0; c < 4; ++c)
        texels[4 * static_cast<std::size_t>((at.z * pool.height + at.y) * pool.width + at.x) +
               static_cast<std::size_t>(c)] = value[c];
    }
  octree.radiance->uploadFloats(0, texels);
  return filteredOctree(octree, opacity);
}

/// The nodes n whose bricks, of the voxels 2n to 2n + 2, contain one of these voxels.
inline std::set<Cell> nodesWith(const std::set<Cell>& voxels, int nodesAlong) {
  std::set<Cell> result;
  for (const Cell& voxel : voxels)
    for (int side = 0; side < 8; ++side) {
      Cell node{};
      bool inside = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int lower = (side >> axis & 1) != 0 && voxel[axis] % 2 == 0 ? 1 : 0;
        node[axis] = voxel[axis] / 2 - lower;
        inside = inside && node[axis] >= 0 && node[axis] < nodesAlong;
      }
      if (inside) result.insert(node);
    }
  return result;
}

/// Fragments in the voxels of a sphere's surface; some voxels have two.
inline std::vector<FragmentData> shell(const glm::ivec3& size) {
  std::vector<FragmentData> result;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const float radius = glm::length(glm::vec3(x, y, z) - 0.4f * glm::vec3(size));
        if (std::abs(radius - 0.35f * static_cast<float>(size.x)) > 0.6f) continue;
        for (int copies = 0; copies <= (x + y) % 2; ++copies) result.push_back(fragmentAt({x, y, z}));
      }
  return result;
}

}  // namespace lumivox::test::octree

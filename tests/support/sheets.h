// One layer of partly opaque voxels in every store that cones read.
#pragma once

#include "support/clipmap.h"
#include "support/made_fragments.h"
#include "support/octree.h"

namespace lumivox::test::cones {

/// An unfiltered dense grid over [-1,1]^3 whose voxels reflect the albedo of the list's fragments.
template <class Grid>
Grid injectedList(const char* pass, const VoxelFragments& list) {
  const Scene scene = emptyScene();
  PassHarness inject(device(), techniques(), "voxel_cone_tracing", pass, scene, snapshotOf(scene, 0.0));
  inject.setParameter("ambient", octree::kAmbient);
  inject.setInput("fragments", list);
  inject.run();
  return inject.template output<Grid>("radiance");
}

/// Calls `check` with each store over [-1,1]^3, 32 voxels along a side, and its name. One layer across `axis`
/// (1: y, 2: z), next to the centre, is full of fragments with this coverage and a normal along the axis. It
/// emits 0.5 W/(sr m^2) to both sides. Every store gets it by its own injection and filter, except the
/// clipmap, which voxelizes triangles and so gets its faces directly.
template <class Check>
void forSheets(int axis, float coverage, const Check& check) {
  constexpr int kVoxels = 32, kLayer = kVoxels / 2;
  constexpr float kSent = 0.5f, kVoxel = 2.0f / kVoxels;
  glm::vec3 normal(0.0f);
  normal[axis] = 1.0f;
  std::vector<FragmentData> fragments =
      octree::fragmentsWhere(glm::ivec3(kVoxels), [&](const glm::ivec3& at) {
        return glm::vec4(glm::vec3(kSent), at[axis] == kLayer ? coverage : 0.0f);
      });
  for (FragmentData& fragment : fragments) fragment.normal = packedOctahedron(normal);
  const VoxelFragments list = octree::listOf(fragments, glm::ivec3(kVoxels));

  const auto one = injectedList<RadianceGrid>("inject", list);
  check(filtered(one), "one grid");
  check(filteredDirections(one), "coarse directional");
  check(filteredDirections(injectedList<DirectionalRadianceGrid>("inject_directional", list)), "six grids");
  for (const char* faces : {"one", "six"})
    check(octree::filteredOctree(octree::leavesOf(list, "float", faces)),
          faces == std::string("one") ? "octree" : "octree of six faces");
  const clipmap::ClipmapSettings levels{.resolution = kVoxels, .levels = 1};
  check(clipmap::madeClipmap(levels, glm::vec3(0.0f),
                             [&](int, const glm::vec3& middle, int face) {
                               const bool inside = middle[axis] > 0.0f && middle[axis] < kVoxel;
                               return inside && face / 2 == axis
                                          ? glm::vec4(glm::vec3(kSent * coverage), coverage)
                                          : glm::vec4(0.0f);
                             }),
        "clipmap");
}

}  // namespace lumivox::test::cones

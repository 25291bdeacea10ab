// Bricks of six faces in a sparse voxel octree, beside the six directional grids and in closed form.
#include "support/stores.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;
using namespace lumivox::test::octree;

namespace {

Scene cornell() {
  return loadScene(sourceDirectory() / "scenes/cornell.scene");
}

}  // namespace

TEST_CASE("faces of the octree's voxels are those of six directional grids, at every level halved evenly") {
  struct Stored {
    const char *precision, *bricks;
  };
  for (const Scene& scene : {cornell(), loadScene(sourceDirectory() / "scenes/untuned/room.scene")})
    for (const auto& [precision, bricks] :
         {Stored{"float", "own"}, Stored{"half", "own"}, Stored{"float", "published"}}) {
      InjectSettings settings;
      settings.precision = precision;
      const DirectionalRadianceGrid dense = filteredDirections(injectedDirections(scene, 32, settings));
      const RadianceOctree sparse = filteredOctree(injectedOctree(scene, 32, settings, "six", bricks));
      CHECK(dense.unit == sparse.unit);
      std::size_t compared = 0;
      for (int level = 0; level <= sparse.tree.depth; ++level) {
        const glm::ivec3 size = levelResolution(dense.grid.resolution, level);
        if (size * (1 << level) != dense.grid.resolution) break;
        for (int face = 0; face < 6; ++face) {
          const auto expected = voxelsOf(dense, face, level), found = voxelsOf(sparse, face, level);
          CAPTURE(precision, bricks, level, face, expected.size(), found.size());
          CHECK((found == expected));
          compared += expected.size();
          if (sparse.tree.brickSide() == 2) continue;
          // What published bricks hold of their neighbours is what those hold.
          std::size_t wrong = 0;
          for (const auto& [place, voxels] : bricksOf(sparse, level, face))
            for (int i = 0; i < 27; ++i) {
              const auto owned = found.find(
                  cellOf(2 * glm::ivec3(place[0], place[1], place[2]) + glm::ivec3(i % 3, i / 3 % 3, i / 9)));
              wrong += voxels[static_cast<std::size_t>(i)] !=
                       (owned == found.end() ? glm::vec4(0.0f) : owned->second);
            }
          CHECK(wrong == 0);
        }
      }
      CHECK(compared > 6 * 1000);
    }
}

TEST_CASE("six faces are refused where voxels do not lie as in a grid, and by rules that have no sides") {
  const VoxelFragments list = listOf({fragmentAt({3, 3, 3})}, glm::ivec3(8));
  for (const char* voxels : {"at_corners", "in_leaves"})
    CHECK_THROWS_WITH(leavesOf(list, voxels, "float", "published", "six"),
                      Catch::Matchers::Contains("expected 'voxels as_grid'"));
  CHECK_THROWS_WITH(filteredOctree(leavesOf(list, "as_grid", "float", "own", "six"), "average"),
                    Catch::Matchers::Contains("expected 'opacity facing'"));
  const RadianceOctree published = filteredOctree(leavesOf(list, "as_grid", "float", "published", "six"));
  CHECK_THROWS_WITH(gather(emptyScene(), published, glm::vec3(0.0f), {0, 1, 0}, {}),
                    Catch::Matchers::Contains("expected 'bricks own'"));
}

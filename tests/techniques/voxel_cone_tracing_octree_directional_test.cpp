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
  for (const Scene& scene : {cornell(), loadScene(sourceDirectory() / "scenes/untuned/room.scene")})
    for (const char* precision : {"float", "half"}) {
      InjectSettings settings;
      settings.precision = precision;
      const DirectionalRadianceGrid dense = filteredDirections(injectedDirections(scene, 32, settings));
      const RadianceOctree sparse = filteredOctree(injectedOctree(scene, 32, settings, "six"));
      CHECK(dense.unit == sparse.unit);
      std::size_t compared = 0;
      for (int level = 0; level <= sparse.tree.depth; ++level) {
        const glm::ivec3 size = levelResolution(dense.grid.resolution, level);
        if (size * (1 << level) != dense.grid.resolution) break;
        for (int face = 0; face < 6; ++face) {
          const auto expected = voxelsOf(dense, face, level), found = voxelsOf(sparse, face, level);
          CAPTURE(precision, level, face, expected.size(), found.size());
          CHECK((found == expected));
          compared += expected.size();
        }
      }
      CHECK(compared > 6 * 1000);
    }
}

TEST_CASE("six faces are refused by rules that have no sides") {
  const VoxelFragments list = listOf({fragmentAt({3, 3, 3})}, glm::ivec3(8));
  CHECK_THROWS_WITH(filteredOctree(leavesOf(list, "float", "six"), "average"),
                    Catch::Matchers::Contains("expected 'opacity facing'"));
}

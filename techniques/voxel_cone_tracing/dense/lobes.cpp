// Lobes of normals: Crassin et al. 2011, Sec. 5; thesis Gomes 2015, Sec. 3.1.2; Toksvig 2005.
#include <algorithm>

#include "../direct_light.h"
#include "levels.h"
#include "lumivox/toolkit/bindings.h"
#include "normal_lobes.h"

namespace lumivox::voxel_cone_tracing {
namespace {

namespace lobe_sums = shaders::voxel_cone_tracing::lobe_sums;
namespace resolve = shaders::voxel_cone_tracing::lobes;

class LobesPass : public Pass {
  In<VoxelFragments> fragments{this, "fragments", "surface samples, those of the grid"};
  DirectLight light{this};
  Out<NormalLobes> lobes{this, "lobes", "directions into which the surfaces in voxels reflect, all levels"};

  Reads readsFrom() const override { return Reads::lights | Reads::materials; }

  void run(PassContext& frame) override {
    RadianceGrid result;
    result.grid = fragments->grid;
    result.grid.resolution = evenlyHalved(fragments->grid.resolution);
    const glm::ivec3& size = result.grid.resolution;
    result.radiance = frame.volume(size, gpu::Format::rgba32f, "lobes of normals",
                                   gpu::fullLevelCount(size.x, size.y, size.z));
    const VoxelSums sums = claimSums(frame, *fragments, size, true, result.occupied);
    const gpu::BufferRef radiances = radiancesOf(frame, *fragments, sums);
    light.reflect(frame, *fragments, sums, light.brightest(frame, 0.5f * fragments->grid.voxelSize),
                  radiances);
    const std::uint64_t voxels =
        std::min<std::uint64_t>(fragments->capacity, GridPlacement{.resolution = size}.voxelCount());
    const gpu::BufferRef lobesOfVoxels =
        frame.emptyElements(lobe_sums::lobeSums, voxels, "sums of voxels' lobes");
    forEachFragment(frame, frame.program(lobe_sums::Variant{}),
                    {lobe_sums::size({sums.brickCount}), lobe_sums::radiances(radiances), sums.bindings(),
                     lobe_sums::lobeSums(lobesOfVoxels)},
                    *fragments);
    result.radiance->clear(glm::vec4(0.0f), 0);
    frame.dispatchIndirect(frame.program(resolve::kProgram),
                           {resolve::size({sums.brickCount}), resolve::brickList(result.occupied.bricks),
                            resolve::brickCount(result.occupied.count), sums.bindings(),
                            resolve::lobeSums(lobesOfVoxels), resolve::lobeImage(result.radiance)},
                           *result.occupied.count, OccupiedBricks::argumentsBytes(0));
    fillLevels(frame, result, Opacity::average);
    lobes = NormalLobes{result.grid, result.radiance};
  }
};

}  // namespace

void addLobes(TechniqueRegistry& registry) {
  registry.add<LobesPass>("lobes", "Lobes of the normals of lit surfaces (Crassin et al. 2011, Sec. 5)");
}

}  // namespace lumivox::voxel_cone_tracing

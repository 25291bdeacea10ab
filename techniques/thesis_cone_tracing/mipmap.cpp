// Makes coarser levels of dense grids (thesis Gomes 2015, Sec. 4.2.1): the mean of eight children in one
// read, and for six directional grids the children as seen along each axis (Fig. 64).
#include "drawn.h"
#include "lumivox/base/error.h"
#include "lumivox/pipeline/ports/directional_radiance_grid.h"
#include "lumivox/plugin/technique.h"
#include "thesis_cone_tracing_shaders.h"

namespace lumivox::thesis_cone_tracing {

using namespace shaders::thesis_cone_tracing;

namespace {

class MipmapPass : public Pass {
  In<RadianceGrid> radiance{this, "radiance", "the finest level"};
  Param<bool> drawn{this, "drawn", false, kDrawnMeaning};
  Out<RadianceGrid> mips{this, "mips", "the same grid with one level per halving", Levels::all};

  void run(PassContext& frame) override {
    RadianceGrid result = *radiance;
    const glm::ivec3& size = result.grid.resolution;
    const int levels = gpu::fullLevelCount(size.x, size.y, size.z);
    if (result.radiance->description().levels < levels)
      throw Error(
          "thesis_cone_tracing.mipmap: the grid 'radiance' has no room for coarser levels; expected 'mips on' in voxel_cone_tracing.inject");
    for (int level = 1; level < levels; ++level) {
      const glm::ivec3 coarse = levelResolution(size, level);
      forEachVoxel(frame, {mipmap::kProgram, mipmap_drawn::kProgram},
                   {mipmap::parameters({.coarse = coarse, .fineLevel = level - 1}),
                    mipmap::radianceGrid(result.radiance, gpu::Sampling::linearOneMip),
                    mipmap::radianceImage(result.radiance, level)},
                   coarse, drawn);
    }
    result.filledLevels = levels;
    result.opacity = RadianceGrid::Opacity::ofFinestVoxel;
    mips = result;
  }
};

class MipmapDirectionalPass : public Pass {
  In<DirectionalRadianceGrid> radiance{this, "radiance", "the finest level of six full grids"};
  Param<bool> drawn{this, "drawn", false, kDrawnMeaning};
  Out<DirectionalRadianceGrid> mips{this, "mips", "the same with one level per halving", Levels::all};

  void run(PassContext& frame) override {
    DirectionalRadianceGrid result = *radiance;
    const auto& faces = result.faces;
    const glm::ivec3& size = result.grid.resolution;
    if (result.finest != nullptr || size != glm::ivec3(size.x))
      throw Error(
          "thesis_cone_tracing.mipmap_directional: expected six full grids of as many voxels along all axes, such as thesis_cone_tracing.correct_opacity_directional gives");
    result.filledLevels = gpu::fullLevelCount(size.x, size.y, size.z);
    constexpr auto kNearest = gpu::Sampling::nearest;
    for (int level = 1; level < result.filledLevels; ++level) {
      const glm::ivec3 coarse = levelResolution(size, level);
      forEachVoxel(frame, {mipmap_directional::kProgram, mipmap_directional_drawn::kProgram, 6},
                   {mipmap_directional::parameters({.coarse = coarse, .fineLevel = level - 1}),
                    mipmap_directional::positiveX(faces[0], kNearest),
                    mipmap_directional::negativeX(faces[1], kNearest),
                    mipmap_directional::positiveY(faces[2], kNearest),
                    mipmap_directional::negativeY(faces[3], kNearest),
                    mipmap_directional::positiveZ(faces[4], kNearest),
                    mipmap_directional::negativeZ(faces[5], kNearest),
                    mipmap_directional::positiveXImage(faces[0], level),
                    mipmap_directional::negativeXImage(faces[1], level),
                    mipmap_directional::positiveYImage(faces[2], level),
                    mipmap_directional::negativeYImage(faces[3], level),
                    mipmap_directional::positiveZImage(faces[4], level),
                    mipmap_directional::negativeZImage(faces[5], level)},
                   coarse, drawn);
    }
    mips = result;
  }
};

}  // namespace

void addMipmap(TechniqueRegistry& registry) {
  registry.add<MipmapPass>("mipmap", "Coarser levels by the mean of eight children (Sec. 4.2.1)");
  registry.add<MipmapDirectionalPass>("mipmap_directional",
                                      "Coarser levels of six grids, as seen along each axis (Fig. 64)");
}

}  // namespace lumivox::thesis_cone_tracing

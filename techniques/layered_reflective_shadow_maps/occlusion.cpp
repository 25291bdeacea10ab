// Makes the opacities that cones read: thesis Gomes 2015, Sec. 3.3, "the occlusion textures are mipmapped".
#include <algorithm>

#include "layered_reflective_shadow_maps_shaders.h"
#include "opacity_levels.h"
#include "passes.h"

namespace lumivox::layered_reflective_shadow_maps {
namespace {

namespace occlusion = shaders::layered_reflective_shadow_maps::occlusion;

/// The size of a grid with voxels added at its high ends, so that halving leaves no odd number above the few
/// voxels of the coarsest levels. Voxels that share children would make walls thicker from level to level.
glm::ivec3 evenlyHalved(const glm::ivec3& size) {
  constexpr int kCoarse = 4;  // sizes may be odd below twice this, along the longest side
  int multiple = 1;
  while (2 * kCoarse * multiple <= std::max({size.x, size.y, size.z})) multiple *= 2;
  return (size + (multiple - 1)) / multiple * multiple;
}

class OcclusionPass : public Pass {
  enum class Rule { facing, average };  // in the order of coarser_level.glsl

  In<OccupancyGrid> opacity{this, "opacity", "the finest level"};
  Param<Rule> rule{
      this, "rule", Rule::facing,
      "opacity of a parent; facing: that of its children seen along the axis that they face; average: their mean",
      published(Rule::average)};
  Out<OpacityLevels> levels{this, "levels", "the same opacities with one level per halving", Levels::all};

  void run(PassContext& frame) override {
    const glm::ivec3& given = opacity->grid.resolution;
    OpacityLevels result{.grid = opacity->grid};
    glm::ivec3& size = result.grid.resolution = evenlyHalved(given);
    result.filledLevels = gpu::fullLevelCount(size.x, size.y, size.z);
    result.opacity = frame.volume(size, gpu::Format::r8, "levels of opacity", result.filledLevels);
    result.opacityOf =
        rule == Rule::facing ? RadianceGrid::Opacity::ofVoxel : RadianceGrid::Opacity::ofFinestVoxel;
    const occlusion::Constants constants{.rule = static_cast<int>(static_cast<Rule>(rule))};
    frame.dispatch(frame.program(occlusion::Variant{occlusion::Variant::levelFinest}, constants),
                   {occlusion::parameters({.coarse = size, .fineLevel = 0, .fine = given}),
                    occlusion::opacity(opacity->opacity, gpu::Sampling::nearest),
                    occlusion::opacityImage(result.opacity)},
                   size);
    for (int level = 1; level < result.filledLevels; ++level) {
      const glm::ivec3 coarse = levelResolution(size, level);
      frame.dispatch(
          frame.program(occlusion::Variant{occlusion::Variant::levelCoarser}, constants),
          {occlusion::parameters(
               {.coarse = coarse, .fineLevel = level - 1, .fine = levelResolution(size, level - 1)}),
           occlusion::opacity(result.opacity, gpu::Sampling::nearest),
           occlusion::opacityImage(result.opacity, level)},
          coarse);
    }
    levels = result;
  }
};

}  // namespace

void addOcclusion(TechniqueRegistry& registry) {
  registry.add<OcclusionPass>("occlusion", "Coarser levels of opacities (thesis Gomes 2015, Sec. 3.3)");
}

}  // namespace lumivox::layered_reflective_shadow_maps

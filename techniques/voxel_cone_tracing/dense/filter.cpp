// Makes coarser levels of a dense grid of isotropic voxels: Crassin et al. 2011, Sec. 5; thesis Gomes 2015,
// Sec. 4.2.1.
#include "levels.h"
#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {

glm::ivec3 evenlyHalved(const glm::ivec3& size) {
  constexpr int kCoarse = 4;  // sizes may be odd below twice this, along the longest side
  int multiple = 1;
  while (2 * kCoarse * multiple <= std::max({size.x, size.y, size.z})) multiple *= 2;
  return (size + (multiple - 1)) / multiple * multiple;
}

bool continuesLevels(PassContext& frame, const ChangedBricks& changed) {
  if (changed.levels == nullptr) return false;
  return changed.continues(frame.kept("levels of static geometry in unchanged light", changed.levels,
                                      [] { return std::shared_ptr<const void>(std::make_shared<int>(0)); }));
}

void fillLevels(PassContext& frame, RadianceGrid& grid, Opacity opacity, bool onlyChanges) {
  namespace filter = shaders::voxel_cone_tracing::filter;
  const gpu::TextureDescription& texture = grid.radiance->description();
  const glm::ivec3 finest(texture.width, texture.height, texture.depth);
  const OccupiedBricks& bricks = onlyChanges ? grid.changed.bricks : grid.occupied;
  const filter::Constants constants{.rule = static_cast<int>(opacity)};
  for (int level = 1; level < texture.levels; ++level) {
    const glm::ivec3 coarse = levelResolution(finest, level), fine = levelResolution(finest, level - 1);
    // Where bricks are halved evenly, levels follow the bricks down to one voxel per brick.
    const bool followsBricks = bricks.bricks != nullptr && (OccupiedBricks::kSide >> level) >= 1 &&
                               finest % OccupiedBricks::kSide == glm::ivec3(0);
    const shader::BindingSet bindings{
        filter::parameters({.coarse = coarse, .fineLevel = level - 1, .fine = fine}),
        filter::radianceGrid(grid.radiance, gpu::Sampling::nearest),
        filter::radianceImage(grid.radiance, level), filter::brickList(bricks.bricks),
        filter::brickCount(bricks.count)};
    const auto& program = frame.program(filter::Variant{followsBricks}, constants);
    if (!followsBricks) {
      frame.dispatch(program, bindings, coarse);
      continue;
    }
    if (!onlyChanges) grid.radiance->clear(glm::vec4(0.0f), level);
    frame.dispatchIndirect(program, bindings, *bricks.count, OccupiedBricks::argumentsBytes(level));
  }
  grid.filledLevels = texture.levels;
  grid.opacity =
      opacity == Opacity::facing ? RadianceGrid::Opacity::ofVoxel : RadianceGrid::Opacity::ofFinestVoxel;
}

namespace {

class FilterPass : public Pass {
  In<RadianceGrid> radiance{this, "radiance", "the finest level"};
  Param<Opacity> opacity{
      this, "opacity", Opacity::facing,
      "opacity of a parent; facing: that of its children seen along the axis that they face; average: their mean"};
  Out<RadianceGrid> mips{this, "mips", "the same grid with one level per halving", Levels::all};

  void run(PassContext& frame) override {
    RadianceGrid filtered = *radiance;
    const glm::ivec3& size = filtered.grid.resolution;
    if (filtered.radiance->description().levels < gpu::fullLevelCount(size.x, size.y, size.z))
      throw Error(
          "voxel_cone_tracing.filter: the grid 'radiance' has no room for coarser levels; expected 'mips on' in voxel_cone_tracing.inject");
    fillLevels(frame, filtered, opacity, continuesLevels(frame, filtered.changed));
    mips = filtered;
  }
};

}  // namespace

void addFilter(TechniqueRegistry& registry) {
  registry.add<FilterPass>("filter", "Pre-filtered coarser levels (Crassin et al. 2011, Sec. 5)");
}

}  // namespace lumivox::voxel_cone_tracing

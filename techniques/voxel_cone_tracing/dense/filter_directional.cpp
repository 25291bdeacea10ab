// Makes coarser levels of six directional grids: Crassin et al. 2011, Sec. 8.1; thesis Gomes 2015, Sec. 3.1.3
// and 4.2.1, Fig. 64.
#include "levels.h"
#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {
namespace {

namespace filter = shaders::voxel_cone_tracing::filter_directional;

void fillLevel(PassContext& frame, const DirectionalRadianceGrid& result, int level, bool onlyChanges) {
  const glm::ivec3 coarse = levelResolution(result.grid.resolution, level),
                   fine = levelResolution(result.grid.resolution, level - 1);
  const int first = result.firstLevelOfFaces(), written = level - first;
  const bool fromFinest = level - 1 < first;
  const int read = fromFinest ? 0 : level - 1 - first;
  const OccupiedBricks& bricks = onlyChanges ? result.changed.bricks : result.occupied;
  // Where bricks are halved evenly, levels follow the bricks down to one voxel per brick.
  const bool followsBricks = bricks.bricks != nullptr && (OccupiedBricks::kSide >> level) >= 1 &&
                             result.grid.resolution % OccupiedBricks::kSide == glm::ivec3(0);
  const int perSide = OccupiedBricks::kSide >> level;
  const auto source = [&](int face) -> const gpu::TextureRef& {
    return fromFinest ? result.finest : result.faces[static_cast<std::size_t>(face)];
  };
  const auto target = [&](int face) -> const gpu::TextureRef& {
    return result.faces[static_cast<std::size_t>(face)];
  };
  const shader::BindingSet bindings{
      filter::parameters(
          {.coarse = coarse, .levelOfFaces = read, .fine = fine, .perBrick = perSide * perSide * perSide}),
      filter::positiveX(source(0), gpu::Sampling::nearest),
      filter::negativeX(source(1), gpu::Sampling::nearest),
      filter::positiveY(source(2), gpu::Sampling::nearest),
      filter::negativeY(source(3), gpu::Sampling::nearest),
      filter::positiveZ(source(4), gpu::Sampling::nearest),
      filter::negativeZ(source(5), gpu::Sampling::nearest),
      filter::positiveXImage(target(0), written),
      filter::negativeXImage(target(1), written),
      filter::positiveYImage(target(2), written),
      filter::negativeYImage(target(3), written),
      filter::positiveZImage(target(4), written),
      filter::negativeZImage(target(5), written),
      filter::brickList(bricks.bricks),
      filter::brickCount(bricks.count)};
  const auto& program = frame.program(filter::Variant{followsBricks});
  if (!followsBricks) {
    frame.dispatch(program, bindings, coarse);
    return;
  }
  for (int face = 0; face < 6 && !onlyChanges; ++face) target(face)->clear(glm::vec4(0.0f), written);
  frame.dispatchIndirect(program, bindings, *bricks.count, OccupiedBricks::argumentsBytes(level));
}

class FilterDirectionalPass : public Pass {
  In<DirectionalRadianceGrid> radiance{this, "radiance", Presence::optional,
                                       "the finest level of six grids (thesis Table 1: six full grids)"};
  In<RadianceGrid> finest{
      this, "finest", Presence::optional,
      "in place of 'radiance': an isotropic finest level, so that only coarser levels have six grids (thesis Sec. 3.1.3)"};
  Out<DirectionalRadianceGrid> mips{this, "mips", "the same with one level per halving", Levels::all};

  void run(PassContext& frame) override {
    DirectionalRadianceGrid result = input(frame);
    fillLevels(frame, result, continuesLevels(frame, result.changed));
    mips = result;
  }

  /// Coarser levels beside a finest one that is changed in place.
  struct KeptFaces {
    std::array<gpu::TextureRef, 6> faces;
    std::shared_ptr<ChangedBricks::Levels> levels = std::make_shared<ChangedBricks::Levels>();
  };

  /// The finest level, with room for the others.
  DirectionalRadianceGrid input(PassContext& frame) const {
    if (radiance.present() == finest.present())
      throw Error(std::string("voxel_cone_tracing.filter_directional: ") +
                  (radiance.present() ? "two finest levels" : "no finest level") +
                  "; expected one of the inputs 'radiance' and 'finest' to be connected");
    if (radiance.present()) return *radiance;
    DirectionalRadianceGrid result;
    result.grid = finest->grid;
    result.finest = finest->radiance;
    result.unit = finest->unit;
    result.holdsMedia = finest->holdsMedia;
    result.occupied = finest->occupied;
    result.changed = finest->changed;
    const auto rooms = [&] {
      const glm::ivec3 size = levelResolution(result.grid.resolution, 1);
      std::array<gpu::TextureRef, 6> faces;
      for (gpu::TextureRef& face : faces)
        face = frame.volume(size, result.finest->description().format, "coarser levels of one side",
                            gpu::fullLevelCount(size.x, size.y, size.z));
      return faces;
    };
    if (finest->changed.levels == nullptr) {
      result.faces = rooms();
      return result;
    }
    // These levels are not in the textures of the finest one, so that others cannot fill them.
    const KeptFaces& kept = frame.kept("coarser levels of static geometry in unchanged light",
                                       finest->changed.levels, [&] { return KeptFaces{rooms()}; });
    result.faces = kept.faces;
    result.changed.levels = kept.levels;
    return result;
  }
};

}  // namespace

void fillLevels(PassContext& frame, DirectionalRadianceGrid& grid, bool onlyChanges) {
  const glm::ivec3 size = grid.grid.resolution;
  grid.filledLevels = gpu::fullLevelCount(size.x, size.y, size.z);
  for (int level = 1; level < grid.filledLevels; ++level) fillLevel(frame, grid, level, onlyChanges);
}

void addFilterDirectional(TechniqueRegistry& registry) {
  registry.add<FilterDirectionalPass>(
      "filter_directional",
      "Coarser levels of six directional grids (Crassin et al. 2011, Sec. 8.1; thesis Sec. 3.1.3)");
}

}  // namespace lumivox::voxel_cone_tracing

// Injection of direct light: Crassin et al. 2011, Sec. 6; thesis Gomes 2015, Sec. 4.2.1. The mean of what the
// fragments of each occupied voxel reflect, independent of their order.
#include <algorithm>

#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/light_bounds.h"
#include "lumivox/toolkit/media.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {
namespace {

using namespace shaders::voxel_cone_tracing;

constexpr float kLargestHalf = 32768.0f;  // half floats end at 65504; filtering adds nothing to the largest

/// The size of a grid with voxels added at its high ends so that halving it leaves no odd number above the
/// few voxels of the coarsest levels. A level that is not of half the size of the finer one has voxels that
/// share children, and an opaque child makes both opaque: walls grow thicker from level to level.
glm::ivec3 evenlyHalved(const glm::ivec3& size) {
  constexpr int kCoarse = 4;  // voxels along the longest side from which on sizes may be odd
  int multiple = 1;
  while (2 * kCoarse * multiple <= std::max({size.x, size.y, size.z})) multiple *= 2;
  return (size + (multiple - 1)) / multiple * multiple;
}

class InjectPass : public Pass {
  enum class Precision { float_, half };

  In<VoxelFragments> fragments{this, "fragments", "surface samples"};
  In<ShadowMap> shadow{this, "shadow", Presence::optional,
                       "lights and their visibility; without it the grid is dark but opaque"};
  In<ScatteringGrid> media{this, "media", Presence::optional,
                           "media between lights and surfaces, which dim the light on its way"};
  Param<int> mediumSteps{this, "medium_steps", 16, within(1, 1024),
                         "most steps through a medium that varies, towards a light"};
  Param<bool> storeMedia{
      this, "store_media", false,
      "the media lie in the voxels beside the surfaces and scatter light there, evenly to all sides, so that one set of cones sees both and 'gather' takes no media of its own (thesis Sec. 4.5)"};
  Param<float> ambient{
      this, "ambient", 0.0f, within(0.0f, 1e9f),
      "irradiance that all surfaces receive besides that of the lights, W/m^2: cones then see what no light reaches (thesis Fig. 66)"};
  Param<bool> twoSided{this, "two_sided", true,
                       "light on the back of a triangle counts; off, as published: only on the front"};
  Param<Precision> precision{this, "precision", Precision::float_, "of the grid: 16 or 8 bytes a voxel"};
  Out<RadianceGrid> radiance{this, "radiance", "reflected radiance and opacity; the finest level only",
                             Levels::finest};

  Reads readsFrom() const override { return Reads::lights | Reads::materials; }

  /// Room for the sums of occupied voxels, and where they lie (bricks.glsl).
  struct Sums {
    glm::ivec3 brickCount{0};
    gpu::BufferRef bricks, voxels;
    shader::BindingSet bindings() const { return {add::bricks(bricks), add::sums(voxels)}; }
  };

  void run(PassContext& frame) override {
    RadianceGrid result;
    result.grid = fragments->grid;
    const glm::ivec3 size = result.grid.resolution = evenlyHalved(fragments->grid.resolution);
    const bool half = precision == Precision::half;
    result.radiance = frame.volume(size, half ? gpu::Format::rgba16f : gpu::Format::rgba32f, "radiance grid",
                                   gpu::fullLevelCount(size.x, size.y, size.z));
    result.filledLevels = 1;
    // A grid cannot say anything of what lies nearer than half a voxel.
    const float brightest =
        largestRadiance(frame.sceneDescription(), frame.snapshot(), 0.5f * result.grid.voxelSize) +
        ambient / glm::pi<float>();
    if (half) result.unit = brightest / kLargestHalf;

    const Sums sums = claimSums(frame, size, result.occupied);
    const gpu::BufferRef radiances =
        frame.buffer(std::max<std::uint64_t>(fragments->capacity, 1) * 3 * add::radiances.elementBytes,
                     "reflected radiance per fragment");
    light(frame, sums, radiances, brightest);
    forEachFragment(frame, frame.program(add::kProgram),
                    {add::size({sums.brickCount}), add::radiances(radiances), sums.bindings()}, *fragments);
    resolve(frame, sums, brightest, result);
    radiance = result;
  }

  /// Finds the occupied bricks, and gives every occupied voxel its place among the sums. There are no more of
  /// them than fragments, so that nothing that happens on the device need be known here.
  Sums claimSums(PassContext& frame, const glm::ivec3& size, OccupiedBricks& occupied) const {
    Sums sums;
    sums.brickCount = (size + (OccupiedBricks::kSide - 1)) / OccupiedBricks::kSide;
    const std::uint64_t bricks = GridPlacement{.resolution = sums.brickCount}.voxelCount(),
                        voxels = GridPlacement{.resolution = size}.voxelCount(), most = fragments->capacity;
    sums.bricks = frame.emptyElements(claim::bricks, bricks, "occupied voxels of bricks");
    sums.voxels = frame.emptyElements(add::sums, std::min(most, voxels), "sums of voxels");
    occupied.bricks = frame.elements(claim::brickList, std::min(most, bricks), "occupied bricks");
    occupied.count = frame.buffer(OccupiedBricks::argumentsBytes(3), "occupied brick count");
    const gpu::BufferRef totals = frame.uploaded(std::array<std::uint32_t, 2>{}, "claimed bricks and voxels");
    const auto brickCount = claim::size({sums.brickCount});
    forEachFragment(frame, frame.program(mark::kProgram), {brickCount, mark::bricks(sums.bricks)},
                    *fragments);
    frame.dispatch(frame.program(claim::kProgram),
                   {brickCount, claim::bricks(sums.bricks), claim::brickList(occupied.bricks),
                    claim::brickTotals(totals)},
                   sums.brickCount);
    frame.dispatch(frame.program(arguments::kProgram),
                   {arguments::brickTotals(totals), arguments::brickCount(occupied.count)}, {1, 1, 1});
    return sums;
  }

  /// The radiance that each fragment reflects, and of each voxel the number and the brightest of its
  /// fragments.
  void light(PassContext& frame, const Sums& sums, const gpu::BufferRef& radiances, float mostRadiance) {
    const LightBinding lights(shadow);
    const MediaBinding bound(frame, media, shadow.present());
    const inject::Variant variant{.lights = shadow.present(),
                                  .shadows = shadow.present(),
                                  .reflected = fragments->reflected != nullptr,
                                  .medium = bound.axis};
    forEachFragment(frame, frame.program(variant),
                    {inject::grid({.gridLow = fragments->grid.low,
                                   .voxelSize = fragments->grid.voxelSize,
                                   .lightCount = lights.count,
                                   .mostRadiance = mostRadiance,
                                   .twoSided = twoSided,
                                   .mediumSteps = mediumSteps,
                                   .brickCount = sums.brickCount,
                                   .ambient = ambient}),
                     inject::radiances(radiances), inject::reflected(fragments->reflected), sums.bindings(),
                     lights, bound},
                    *fragments);
  }

  /// The finest level from the sums: of the occupied bricks alone, or of all voxels where media lie in them.
  void resolve(PassContext& frame, const Sums& sums, float mostRadiance, RadianceGrid& result) {
    result.holdsMedia = storeMedia && media.present();
    const LightBinding lights(shadow);
    const MediaBinding bound(frame, media, result.holdsMedia);
    const auto& program = frame.program(
        resolve::Variant{.lights = result.holdsMedia && shadow.present(), .medium = bound.axis});
    const OccupiedBricks occupied = result.occupied;
    const shader::BindingSet bindings{
        resolve::parameters({.brickCount = sums.brickCount,
                             .unit = result.unit,
                             .resolution = result.grid.resolution,
                             .coverageSum = fragments->coverage == VoxelFragments::Coverage::sum,
                             .gridLow = result.grid.low,
                             .voxelSize = result.grid.voxelSize,
                             .lightCount = lights.count,
                             .mediumSteps = mediumSteps,
                             .mostRadiance = mostRadiance}),
        resolve::brickList(occupied.bricks),
        resolve::brickCount(occupied.count),
        resolve::radianceImage(result.radiance),
        sums.bindings(),
        lights,
        bound};
    if (result.holdsMedia) {
      result.occupied = {};
      frame.dispatch(program, bindings, result.grid.resolution);
    } else {
      result.radiance->clear(glm::vec4(0.0f), 0);
      frame.dispatchIndirect(program, bindings, *occupied.count, OccupiedBricks::argumentsBytes(0));
    }
  }
};

}  // namespace

void addInject(TechniqueRegistry& registry) {
  registry.add<InjectPass>("inject", "Direct light into the finest level (Crassin et al. 2011, Sec. 6)");
}

}  // namespace lumivox::voxel_cone_tracing

// Gathers one bounce near the visible surfaces: Thiedemann et al. 2011, Sec. 5; thesis Gomes 2015, Sec. 3.2.3
// and 4.4.6. Bits tell where a ray ends, reflective shadow maps how bright that place is.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/ports/directional_radiance_grid.h"
#include "lumivox/toolkit/environment.h"
#include "lumivox/toolkit/grid_placement.h"
#include "lumivox/toolkit/loop_limit.h"
#include "lumivox/toolkit/ray_stop.h"
#include "near_field_voxels_shaders.h"
#include "passes.h"

namespace lumivox::near_field_voxels {

namespace {

namespace gather = shaders::near_field_voxels::gather;

// In the order of their numbers in gather.comp.
enum class HitPoint { middle, entry, centre, printed };
enum class Rotation { hash, tile, none };

class GatherPass : public Pass {
  enum class Sequence { r2, hammersley };
  enum class OffsetUnit { plane, diagonal };
  enum class Beyond { grid, radius };
  enum class Radiance { map, voxels };
  enum class Frames { sum, apart };
  // In the order of their halvings.
  enum class Pixels { full, half, quarter };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<BinaryGrid> bits{this, "bits", "occupied voxels, at which rays end: one bit each"};
  In<ReflectiveShadowMap> map{
      this, "map", Presence::optional,
      "what the lights see: the radiance of hits; without it only the environment shines", Needs::anyLight};
  In<RadianceGrid> voxels{this, "voxels", Presence::optional,
                          "with 'radiance voxels': the radiance of hits, on the grid of 'bits'"};
  In<DirectionalRadianceGrid> directions{
      this, "directions", Presence::optional,
      "with 'radiance voxels', in place of 'voxels': the same by the six faces of a voxel; a ray sees three"};
  Param<int> rays{this, "rays", 32, within(1, 1 << 20), "rays per pixel, distributed as the cosine"};
  Param<Pixels> pixelsOf{this, "pixels", Pixels::full,
                         "pixels that send rays; full: all; half: one of 2 x 2; quarter: one of 4 x 4"};
  Param<Frames> framesOf{
      this, "frames", Frames::sum,
      "rays of several frames; sum: added while nothing changes, in runs that accumulate; apart: each frame has rays of its own and their light alone, for a filter over frames"};
  RayMethod method{this};
  Param<Sequence> sequence{
      this, "sequence", Sequence::r2,
      "sequence of directions; r2: the R2 sequence, which accumulated frames continue; hammersley: Hammersley's points",
      published(Sequence::hammersley)};
  Param<Rotation> rotation{
      this, "rotation", Rotation::hash,
      "rotation of the sequence; hash: per pixel, by a hash; tile: by a small tile of random numbers; none: the same for all pixels",
      published(Rotation::tile)};
  Param<float> spread{
      this, "spread", 1.0f, within(0.0f, 1.0f),
      "square of the largest sine between a ray and the normal; below 1 the lobe is narrower"};
  Param<float> offset{this, "offset", 1.0f, within(0.0f, 100.0f),
                      "distance of a ray's start along the geometric normal, in units of 'offset_unit'"};
  Param<OffsetUnit> offsetUnit{
      this, "offset_unit", OffsetUnit::plane,
      "unit of 'offset'; plane: the distance beyond which no voxel touches the surface's plane, plus a sixteenth of a voxel; diagonal: the diagonal of a voxel",
      published(OffsetUnit::diagonal)};
  Param<float> start{this, "start", 0.0f, within(0.0f, 1000.0f),
                     "distance of a ray's start along its direction, after the offset, in voxels"};
  Param<float> radius{this, "radius",
                      0.0f, within(0.0f, 1e9f),
                      "m",  "largest distance from which light is gathered; 0: the whole grid"};
  Param<Beyond> beyond{
      this, "beyond", Beyond::grid,
      "rays that see the environment; grid: those that leave the grid within the radius; radius: all without a hit within the radius",
      published(Beyond::radius)};
  Param<float> occlusionDistance{
      this,
      "occlusion_distance",
      0.0f,
      within(0.0f, 1e9f),
      "m",
      "distance within which voxels occlude; 0: a tenth of the diagonal of the scene's bounds, as in the reference"};
  Param<Radiance> radiance{
      this, "radiance", Radiance::map,
      "radiance of a hit; map: by projection into 'map'; voxels: of its voxel in 'voxels'"};
  Param<HitPoint> hit{
      this, "hit", HitPoint::middle,
      "point of a hit that is projected into 'map'; middle: midway through the voxel along the ray; entry: where the ray enters; centre: the voxel's centre; printed: x and y of the entry, z of the centre",
      published(HitPoint::printed)};
  RayStop stop{this};
  BackProjection projection{this};
  PublishedForm asPublished{
      this,
      "Sec. 3.2.3 and Listings 4.45 to 4.49 with their errors: the estimator has one factor 1 / pi too many, cosines to the light count from 0.001 on, and 'tolerance' scales only the side of the map's texel, before the bounds by 'cap' and the voxel"};
  Out<Image> arriving{this, "arriving", Contributes::nothing, Needs::anyLight,
                      "mean arriving radiance, E / pi, at the pixels that send rays, W/(sr m^2)"};
  Out<Image> occlusion{this, "occlusion", Contributes::nothing, Needs::triangles,
                       "unoccluded share of their rays, in the first channel"};
  Out<Image> fetches{
      this, "fetches", Contributes::nothing, Needs::nothing,
      "in r: texels of the stacks that the pixel's rays read; 0 where these are not counted: with 'stop plane' and with 'directions'"};

  Reads readsFrom() const override {
    return Reads::camera | Reads::environment | Reads::geometry | Reads::history |
           (framesOf == Frames::apart ? Reads::time : Reads::nothing);
  }
  bool uses(const InBase& input) const override {
    if (&input == &map) return arriving.wanted() && radiance == Radiance::map;
    if (stop.isInput(input)) return stop.atPlanes();
    if (&input == &voxels && directions.present()) return false;
    return (&input != &voxels && &input != &directions) ||
           (arriving.wanted() && radiance == Radiance::voxels);
  }
  std::string checkParameters() const override {
    const std::string ofStop =
        stop.check(method.axis() == gather::Variant::bitRulePrinted, "method", "printed");
    return ofStop.empty() ? projection.check() : ofStop;
  }

  bool readsMap() const { return radiance == Radiance::map && map.present() && map->lightCount > 0; }

  /// Whether every voxel of `part` is one of `all` under the same number. A grid that halves evenly may have
  /// a voxel more along an axis.
  static bool covers(const GridPlacement& all, const GridPlacement& part) {
    return all.low == part.low && all.voxelSize == part.voxelSize &&
           glm::all(glm::greaterThanEqual(all.resolution, part.resolution));
  }

  /// Error where the connected inputs do not belong together.
  void checkInputs() const {
    if (!arriving.wanted()) return;
    if (radiance == Radiance::voxels) {
      if (!voxels.present() && !directions.present())
        throw Error(
            "near_field_voxels.gather: 'radiance voxels' reads 'voxels' or 'directions'; expected one of them to "
            "be connected");
      const bool faces = directions.present();
      const GridPlacement& grid = faces ? directions->grid : voxels->grid;
      if (!covers(grid, bits->grid))
        throw Error(
            fmt::format("near_field_voxels.gather: 'bits' have {}, and '{}' {}; expected one grid for both",
                        inWords(bits->grid), faces ? "directions" : "voxels", inWords(grid)));
      if (faces && directions->finest != nullptr)
        throw Error(
            "near_field_voxels.gather: the finest level of 'directions' is the same for all sides; expected "
            "faces, as voxel_cone_tracing.inject_directional makes them");
    }
    if (readsMap()) requireWhole(*map, "near_field_voxels.gather");
  }

  float reachOf(PassContext& frame) const {
    return occlusionDistance > 0.0f ? float(occlusionDistance)
                                    : static_cast<float>(ambientOcclusionDistance(frame.snapshot().bounds));
  }

  gather::Rays parametersOf(PassContext& frame, int framesBefore) const {
    const float voxel = bits->grid.voxelSize, never = -1.0f;
    const bool light = arriving.wanted() || !occlusion.wanted();
    return {.environment = frame.sceneDescription().environment,
            .spread = spread,
            .seed = seedWords(frame),
            .every = every(),
            .rays = rays,
            .framesBefore = framesBefore,
            .portion = framesOf == Frames::apart ? frame.frameIndex() + frame.accumulated() : framesBefore,
            .offset = offset,
            .start = start,
            .reach = !light          ? never
                     : radius > 0.0f ? radius / voxel
                                     : std::numeric_limits<float>::infinity(),
            .occlusionReach = occlusion.wanted() ? reachOf(frame) / voxel : never,
            .beyondRadius = beyond == Beyond::radius,
            .scale = asPublished ? std::numbers::inv_pi_v<float> : 1.0f};
  }
  int every() const { return 1 << static_cast<int>(static_cast<Pixels>(pixelsOf)); }

  gather::Constants constantsOf(const PassContext& frame) const {
    return {.taps = projection.taps(),
            .frontTest = projection.front(),
            .hitPoint = static_cast<int>(static_cast<HitPoint>(hit)),
            .rotation = static_cast<int>(static_cast<Rotation>(rotation)),
            .hammersley = sequence == Sequence::hammersley,
            .offsetByDiagonal = offsetUnit == OffsetUnit::diagonal,
            .printedTests = asPublished,
            .environmentMap = environmentMapOf(frame)};
  }

  void run(PassContext& frame) override {
    checkInputs();
    const int apart = every();
    const glm::ivec3 samples =
        (pixels(frame) + glm::ivec3(apart - 1, apart - 1, 0)) / glm::ivec3(apart, apart, 1);
    const gpu::TextureDescription ofSamples{
        .format = gpu::Format::rgba32f, .width = samples.x, .height = samples.y};
    const auto summed = [&](bool wanted, const char* label) {
      if (!wanted) return History<gpu::TextureRef>{};
      return framesOf == Frames::apart ? History<gpu::TextureRef>{nullptr, frame.texture(ofSamples, label)}
                                       : frame.history(ofSamples, label);
    };
    const auto written = [&](bool wanted, const char* label) {
      return wanted ? frame.texture(ofSamples, label) : nullptr;
    };
    const History<gpu::TextureRef> light = summed(arriving.wanted(), "light of all rays"),
                                   lost = summed(arriving.wanted(), "what its sum has lost"),
                                   open = summed(occlusion.wanted(), "unoccluded rays");
    const gpu::TextureRef arrives = written(arriving.wanted(), "arriving radiance"),
                          unoccluded = written(occlusion.wanted(), "unoccluded share"),
                          counted = written(fetches.wanted(), "texels that rays read");
    const bool goesOn = (!arriving.wanted() || light.previous) && (!occlusion.wanted() || open.previous);
    gather::Rays parameters =
        parametersOf(frame, goesOn && framesOf == Frames::sum ? frame.accumulated() : 0);
    const bool fromMap = arriving.wanted() && readsMap(),
               stored = arriving.wanted() && radiance == Radiance::voxels,
               fromFaces = stored && directions.present(), fromVoxels = stored && !fromFaces;
    // Each way to count doubles the program's variants; laws of the walk are those of boxes.
    const bool counts = fetches.wanted() && !stop.atPlanes() && !fromFaces;
    if (fetches.wanted()) {
      fetches = Image{counted, false};
      if (!counts) counted->clear(glm::vec4(0.0f));
    }
    if (!arriving.wanted() && !occlusion.wanted() && !counts) return;
    const gather::Variant variant{.arriving = arriving.wanted(),
                                  .radiance = fromMap      ? gather::Variant::radianceMap
                                              : fromFaces  ? gather::Variant::radianceFaces
                                              : fromVoxels ? gather::Variant::radianceVoxels
                                                           : gather::Variant::radianceNone,
                                  .occlusion = occlusion.wanted(),
                                  .fetches = counts,
                                  .mapLobes = fromMap && map->specular != nullptr,
                                  .planes = stop.atPlanes(),
                                  .bitRule = method.axis()};
    const shader::BoundProgram& program = frame.program(variant, constantsOf(frame));
    // Read only after earlier frames, but always bound.
    const auto earlier = [&](const History<gpu::TextureRef>& sum) -> const gpu::TextureRef& {
      return sum.previous ? sum.previous : gbuffer->position;
    };
    const VoxelPlanes planes = stop.planes(frame, *bits, "near_field_voxels.gather");
    shader::BindingSet bound{GBufferBinding(*gbuffer),
                             EnvironmentBinding(frame),
                             method.binding(frame, *bits),
                             planes,
                             gather::arrivingImage(arrives),
                             gather::lightSum(light.current),
                             gather::lostSum(lost.current),
                             gather::occlusionImage(unoccluded),
                             gather::openSum(open.current),
                             gather::fetchImage(counts ? counted : nullptr),
                             gather::earlierLight(earlier(light), gpu::Sampling::nearest),
                             gather::earlierLost(earlier(lost), gpu::Sampling::nearest),
                             gather::earlierOpen(earlier(open), gpu::Sampling::nearest)};
    if (fromMap) bound.add(ReflectiveShadowMapBinding(*map));
    if (variant.mapLobes) bound.add(gather::rsmSpecular(map->specular, gpu::Sampling::nearest));
    if (fromFaces) {
      const auto& faces = directions->faces;
      constexpr gpu::Sampling kNearest = gpu::Sampling::nearest;
      bound.add(
          shader::BindingSet{gather::positiveX(faces[0], kNearest), gather::negativeX(faces[1], kNearest),
                             gather::positiveY(faces[2], kNearest), gather::negativeY(faces[3], kNearest),
                             gather::positiveZ(faces[4], kNearest), gather::negativeZ(faces[5], kNearest),
                             gather::radiance({.radianceUnit = directions->unit})});
    }
    if (fromVoxels) {
      bound.add(gather::radianceGrid(voxels->radiance, gpu::Sampling::nearest));
      bound.add(gather::radiance({.radianceUnit = voxels->unit}));
    }
    dispatchAll(frame, program, bound, parameters, fromMap ? map->lightCount : 0, samples);
    if (arriving.wanted()) arriving = Image{arrives};
    if (occlusion.wanted()) occlusion = Image{unoccluded, false};
  }

  /// Dispatches portions of the rays and, where there are very many, of the lights, to keep loops within what
  /// drivers run.
  void dispatchAll(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bound,
                   gather::Rays& parameters, int lights, glm::ivec3 samples) const {
    const std::int64_t ofRay = method.turns(*bits) + stop.turns(*bits), ofLight = 1 + 4;
    // Half of the limit at most, which leaves room for a ray.
    const int lightsAtOnce = portionOf(lights, 2 * ofLight);
    forEachPortion(rays, ofRay + lightsAtOnce * ofLight, [&](int firstRay, int raysAtOnce) {
      for (int light = 0; light == 0 || light < lights; light += lightsAtOnce) {
        const int count = std::min(lightsAtOnce, lights - light);
        parameters.firstRay = firstRay;
        parameters.raysAtOnce = raysAtOnce;
        parameters.first = firstRay == 0 && light == 0;
        parameters.last = firstRay + raysAtOnce == rays && light + count == lights;
        parameters.addsRest = light == 0;
        frame.dispatch(
            program,
            {bound, gather::rays(parameters),
             projection.binding(stop.voxelsOfMap() * bits->grid.voxelSize, asPublished, light, count)},
            samples);
      }
    });
  }
};

}  // namespace

void addGather(TechniqueRegistry& registry) {
  registry.add<GatherPass>(
      "gather",
      "One bounce by rays through bits, with the radiance of hits from reflective shadow maps (Thiedemann et al. 2011)");
}

}  // namespace lumivox::near_field_voxels

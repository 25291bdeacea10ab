// Voxel cone tracing on a dense isotropic grid: Crassin et al. 2011, "Interactive indirect illumination using
// voxel cone tracing"; thesis Gomes 2015, Sec. 4.2.1. Injection of direct light, pre-filtering, final
// gathering.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/media.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {
namespace {

namespace markShader = shaders::voxel_cone_tracing::mark;
namespace claimShader = shaders::voxel_cone_tracing::claim;
namespace argumentsShader = shaders::voxel_cone_tracing::arguments;
namespace injectShader = shaders::voxel_cone_tracing::inject;
namespace addShader = shaders::voxel_cone_tracing::add;
namespace resolveShader = shaders::voxel_cone_tracing::resolve;
namespace filterShader = shaders::voxel_cone_tracing::filter;
namespace gatherShader = shaders::voxel_cone_tracing::gather;

constexpr glm::ivec3 kVoxelGroup{4, 4, 4};  // local size of the passes over voxels, and of that over bricks
constexpr glm::ivec3 kImageGroup{8, 8, 1};
constexpr float kLargestHalf = 32768.0f;  // half floats end at 65504; filtering adds nothing to the largest

/// What no voxel can reflect: all lights at half a voxel's distance, nearer than which a grid cannot say
/// anything. The albedo is at most 1.
float largestRadiance(const Scene& scene, const SceneSnapshot& snapshot, float voxelSize) {
  const auto largest = [](const glm::vec3& v) { return std::max({v.x, v.y, v.z}); };
  float sum = 0.0f;
  for (const LightState& light : snapshot.lights) {
    const float distance = 0.5f * voxelSize;
    const float irradiance = light.kind == LightKind::directional
                                 ? largest(light.power)
                                 : largest(light.power) / (distance * distance);
    sum += irradiance / glm::pi<float>();
  }
  // Area lights fill at most the hemisphere: the irradiance is at most pi times their radiance.
  float brightest = 0.0f;
  for (const Object& object : scene.objects) {
    for (const Part& part : object.parts) {
      brightest =
          std::max(brightest, largest(scene.materials[static_cast<std::size_t>(part.material)].emission));
    }
  }
  sum += brightest;
  return sum > 0.0f ? sum : 1.0f;
}

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
  In<VoxelFragments> fragments{this, "fragments", "surface samples"};
  In<ShadowMap> shadow{this, "shadow", Presence::optional,
                       "lights and their visibility; without it the grid is dark but opaque"};
  In<ScatteringGrid> media{this, "media", Presence::optional,
                           "media between lights and surfaces, which dim the light on its way"};
  Param<int> mediumSteps{
      this, "medium_steps", 16, {1, 1024}, "most steps through a medium that varies, towards a light"};
  Param<bool> storeMedia{
      this, "store_media", false,
      "the media lie in the voxels beside the surfaces and scatter light there, evenly to all sides, so that one set of cones sees both and 'gather' takes no media of its own (thesis Sec. 4.5)"};
  Param<float> ambient{
      this,
      "ambient",
      0.0f,
      {0.0f, 1e9f},
      "",
      "irradiance that all surfaces receive besides that of the lights, W/m^2: cones then see what no light reaches (thesis Fig. 66)"};
  Param<bool> twoSided{this, "two_sided", true,
                       "light on the back of a triangle counts; off, as published: only on the front"};
  Param<std::string> precision{
      this, "precision", "float", {"float", "half"}, "of the grid: 16 or 8 bytes a voxel"};
  Out<RadianceGrid> radiance{this, "radiance", "reflected radiance and opacity; the finest level only"};

  Reads readsFrom() const override { return Reads::lights | Reads::materials; }

  /// Room for the sums of occupied voxels, and where they lie (bricks.glsl).
  struct Sums {
    glm::ivec3 brickCount{0};
    gpu::BufferRef bricks, voxels;
  };

  void run(PassContext& frame) override {
    RadianceGrid result;
    result.grid = fragments->grid;
    const glm::ivec3 size = result.grid.resolution = evenlyHalved(fragments->grid.resolution);
    gpu::TextureDescription description;
    description.kind = gpu::TextureKind::d3;
    description.format = precision == "half" ? gpu::Format::rgba16f : gpu::Format::rgba32f;
    description.width = size.x;
    description.height = size.y;
    description.depth = size.z;
    description.levels = gpu::fullLevelCount(size.x, size.y, size.z);
    result.radiance = frame.texture(description, "radiance grid");
    result.filledLevels = 1;

    const Sums sums = claimSums(frame, size, result.occupied);
    const gpu::BufferRef radiances =
        frame.buffer(std::max<std::uint64_t>(fragments->capacity, 1) * 3 * sizeof(float),
                     "reflected radiance per fragment");
    const float range = largestRadiance(frame.sceneDescription(), frame.snapshot(), result.grid.voxelSize) +
                        ambient / glm::pi<float>();
    if (precision == "half") result.unit = range / kLargestHalf;

    light(frame, sums, *radiances, range);
    frame.shaders().dispatchIndirect(
        frame.program(addShader::kProgram),
        {addShader::size({sums.brickCount}), addShader::fragmentCount(*fragments->count),
         addShader::fragments(*fragments->fragments), addShader::radiances(*radiances),
         addShader::bricks(*sums.bricks), addShader::sums(*sums.voxels)},
        *fragments->count, sizeof(std::uint32_t));
    frame.device().barrier();
    resolve(frame, sums, range, result);
    radiance = result;
  }

  /// Finds the occupied bricks, and gives every occupied voxel its place among the sums. There are no more of
  /// them than fragments, so that nothing that happens on the device need be known here.
  Sums claimSums(PassContext& frame, const glm::ivec3& size, OccupiedBricks& occupied) const {
    constexpr std::uint64_t kWord = sizeof(std::uint32_t);
    constexpr std::uint64_t kBrickBytes = 3 * kWord, kVoxelBytes = 6 * kWord;  // Brick, VoxelSums
    const auto volume = [](const glm::ivec3& extent) {
      return static_cast<std::uint64_t>(extent.x) * static_cast<std::uint64_t>(extent.y) *
             static_cast<std::uint64_t>(extent.z);
    };
    Sums sums;
    sums.brickCount = (size + (OccupiedBricks::kSide - 1)) / OccupiedBricks::kSide;
    const std::uint64_t most = std::max<std::uint64_t>(fragments->capacity, 1);
    sums.bricks = frame.buffer(volume(sums.brickCount) * kBrickBytes, "occupied voxels of bricks");
    sums.voxels = frame.buffer(std::min(most, volume(size)) * kVoxelBytes, "sums of voxels");
    occupied.bricks = frame.buffer(std::min(most, volume(sums.brickCount)) * kWord, "occupied bricks");
    occupied.count = frame.buffer(OccupiedBricks::argumentsBytes(3), "occupied brick count");
    const gpu::BufferRef totals = frame.buffer(2 * kWord, "claimed bricks and voxels");
    for (const gpu::BufferRef& zeroed : {sums.bricks, sums.voxels, totals}) zeroed->clear();
    frame.shaders().dispatchIndirect(
        frame.program(markShader::kProgram),
        {markShader::size({sums.brickCount}), markShader::fragmentCount(*fragments->count),
         markShader::fragments(*fragments->fragments), markShader::bricks(*sums.bricks)},
        *fragments->count, kWord);
    frame.device().barrier();
    frame.dispatch(frame.program(claimShader::kProgram),
                   {claimShader::size({sums.brickCount}), claimShader::bricks(*sums.bricks),
                    claimShader::brickList(*occupied.bricks), claimShader::brickTotals(*totals)},
                   sums.brickCount, kVoxelGroup);
    frame.dispatch(frame.program(argumentsShader::kProgram),
                   {argumentsShader::brickTotals(*totals), argumentsShader::brickCount(*occupied.count)},
                   {1, 1, 1}, {1, 1, 1});
    return sums;
  }

  /// What each fragment reflects, and of each voxel the number and the brightest of its fragments.
  void light(PassContext& frame, const Sums& sums, const gpu::Buffer& radiances, float mostRadiance) {
    injectShader::Variant variant;
    variant.lights = variant.shadows = shadow.present();
    variant.reflected = fragments->reflected != nullptr;
    injectShader::Grid grid{};
    grid.gridLow = fragments->grid.low;
    grid.voxelSize = fragments->grid.voxelSize;
    grid.lightCount = shadow.present() ? shadow->lightCount : 0;
    grid.mostRadiance = mostRadiance;
    grid.twoSided = twoSided ? 1 : 0;
    grid.mediumSteps = mediumSteps;
    grid.brickCount = sums.brickCount;
    grid.ambient = ambient;
    MediaBinding bound;
    if (variant.lights != 0 && media.present()) {
      bound = MediaBinding(frame, *media);
      variant.medium =
          bound.varying() ? injectShader::Variant::mediumVarying : injectShader::Variant::mediumEven;
    }
    std::vector<gpu::ResourceBinding> bindings{injectShader::grid(grid),
                                               injectShader::fragmentCount(*fragments->count),
                                               injectShader::fragments(*fragments->fragments),
                                               injectShader::radiances(radiances),
                                               injectShader::bricks(*sums.bricks),
                                               injectShader::sums(*sums.voxels)};
    if (shadow.present()) {
      bindings.push_back(injectShader::lights(*shadow->lights));
      bindings.push_back(injectShader::views(*shadow->views));
      bindings.push_back(injectShader::shadowDepth(*shadow->depth, gpu::Sampling::shadow));
    }
    if (fragments->reflected != nullptr) bindings.push_back(injectShader::reflected(*fragments->reflected));
    bound.addTo(bindings);
    frame.shaders().dispatchIndirect(frame.program(injectShader::kProgram, variant.key()), bindings,
                                     *fragments->count, sizeof(std::uint32_t));
    frame.device().barrier();
  }

  /// The finest level from the sums: of the occupied bricks alone, or of all voxels where media lie in them.
  void resolve(PassContext& frame, const Sums& sums, float mostRadiance, RadianceGrid& result) {
    resolveShader::Parameters parameters{};
    parameters.brickCount = sums.brickCount;
    parameters.unit = result.unit;
    parameters.resolution = result.grid.resolution;
    parameters.coverageSum = fragments->coverage == VoxelFragments::Coverage::sum ? 1 : 0;
    parameters.gridLow = result.grid.low;
    parameters.voxelSize = result.grid.voxelSize;
    parameters.mediumSteps = mediumSteps;
    parameters.mostRadiance = mostRadiance;
    std::vector<gpu::ResourceBinding> bindings{resolveShader::bricks(*sums.bricks),
                                               resolveShader::sums(*sums.voxels),
                                               resolveShader::radianceImage(*result.radiance)};
    if (!(storeMedia && media.present())) {
      result.radiance->clear(glm::vec4(0.0f), 0);
      bindings.push_back(resolveShader::parameters(parameters));
      bindings.push_back(resolveShader::brickList(*result.occupied.bricks));
      bindings.push_back(resolveShader::brickCount(*result.occupied.count));
      frame.shaders().dispatchIndirect(frame.program(resolveShader::kProgram, resolveShader::Variant{}.key()),
                                       bindings, *result.occupied.count, OccupiedBricks::argumentsBytes(0));
      frame.device().barrier();
      return;
    }
    result.holdsMedia = true;
    result.occupied = {};
    const MediaBinding bound(frame, *media);
    resolveShader::Variant variant;
    variant.medium =
        bound.varying() ? resolveShader::Variant::mediumVarying : resolveShader::Variant::mediumEven;
    if (shadow.present()) {
      variant.lights = 1;
      parameters.lightCount = shadow->lightCount;
      bindings.push_back(resolveShader::lights(*shadow->lights));
      bindings.push_back(resolveShader::views(*shadow->views));
      bindings.push_back(resolveShader::shadowDepth(*shadow->depth, gpu::Sampling::shadow));
    }
    bindings.push_back(resolveShader::parameters(parameters));
    bound.addTo(bindings);
    frame.dispatch(frame.program(resolveShader::kProgram, variant.key()), bindings, result.grid.resolution,
                   kVoxelGroup);
  }
};

class FilterPass : public Pass {
  In<RadianceGrid> radiance{this, "radiance", "the finest level"};
  Param<std::string> opacity{
      this,
      "opacity",
      "facing",
      {"facing", "average", "trilinear"},
      "how children make a parent: seen through along the axis that they face; their plain mean; or that mean as published, in one read by the texture's filter, which misses children where sizes are odd"};
  Out<RadianceGrid> mips{this, "mips", "the same grid with one level per halving"};

  void run(PassContext& frame) override {
    const gpu::Texture& texture = *radiance->radiance;
    const gpu::TextureDescription& description = texture.description();
    const auto levelSize = [&](int level) {
      return glm::max(
          glm::ivec3(description.width >> level, description.height >> level, description.depth >> level),
          glm::ivec3(1));
    };
    filterShader::Constants constants;
    constants.rule = opacity == "facing" ? 0 : opacity == "average" ? 1 : 2;
    const gpu::Sampling sampling =
        opacity == "trilinear" ? gpu::Sampling::linearOneMip : gpu::Sampling::nearest;
    // Whether the voxels of a level are those of the bricks: down to one a brick, where bricks are halved
    // evenly.
    const auto followsBricks = [&](int level) {
      const int side = OccupiedBricks::kSide;
      return radiance->occupied.bricks != nullptr && (side >> level) >= 1 &&
             levelSize(0) % side == glm::ivec3(0);
    };
    for (int level = 1; level < description.levels; ++level) {
      filterShader::Parameters parameters{};
      parameters.coarse = levelSize(level);
      parameters.fineLevel = level - 1;
      parameters.fine = levelSize(level - 1);
      std::vector<gpu::ResourceBinding> bindings{filterShader::parameters(parameters),
                                                 filterShader::radianceGrid(texture, sampling),
                                                 filterShader::radianceImage(texture, level)};
      if (!followsBricks(level)) {
        frame.dispatch(
            frame.program(filterShader::kProgram, filterShader::Variant{}.key(), constants.values()),
            bindings, parameters.coarse, kVoxelGroup);
        continue;
      }
      filterShader::Variant variant;
      variant.occupied = 1;
      bindings.push_back(filterShader::brickList(*radiance->occupied.bricks));
      bindings.push_back(filterShader::brickCount(*radiance->occupied.count));
      radiance->radiance->clear(glm::vec4(0.0f), level);
      frame.shaders().dispatchIndirect(
          frame.program(filterShader::kProgram, variant.key(), constants.values()), bindings,
          *radiance->occupied.count, OccupiedBricks::argumentsBytes(level));
      frame.device().barrier();
    }
    RadianceGrid filtered = *radiance;
    filtered.filledLevels = description.levels;
    filtered.opacity =
        opacity == "facing" ? RadianceGrid::Opacity::ofVoxel : RadianceGrid::Opacity::ofFinestVoxel;
    mips = filtered;
  }
};

class GatherPass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<RadianceGrid> grid{this, "grid", "pre-filtered radiance, one mip per halving"};
  In<ScatteringGrid> media{this, "media", Presence::optional,
                           "media that dim what the cones see; light that they scatter is left out"};
  Param<int> cones{this, "cones", 6, {1, 256}, "diffuse cones per pixel"};
  Param<std::string> distribution{
      this,
      "distribution",
      "cosine",
      {"cosine", "published"},
      "cones of equal weight distributed as the cosine, or one upright and four at 45 degrees"};
  Param<float> coneRatio{this,
                         "cone_ratio",
                         1.15470053837925152902f,  // 2 tan 30 degrees
                         {0.01f, 8.0f},
                         "",
                         "diameter of one of those five over its height; no number is published"};
  Param<bool> asPublished{
      this, "as_published", false,
      "Listings 4.12 and 4.13 to the letter: the five cones with the weights 1 and 0.707, not normalised, from two voxels on by samples of two voxels and more; 'cones', 'distribution', 'step', 'offset', 'start', 'clearance' and 'footprint' have no say"};
  Param<float> step{this, "step", 0.5f, {0.05f, 2.0f}, "", "step along a cone as a share of its diameter"};
  Param<float> offset{this, "offset", 1.0f, {0.0f, 8.0f}, "", "start of a cone along the normal, in voxels"};
  Param<float> start{this, "start", 1.0f, {0.0f, 8.0f}, "", "start of a cone along its axis, in voxels"};
  Param<float> clearance{
      this,
      "clearance",
      0.5f,
      {0.0f, 1e3f},
      "",
      "largest voxels that are read as a share of their height over the surface; as published: no limit, 1000"};
  Param<float> footprint{
      this,
      "footprint",
      0.5f,
      {0.25f, 1.0f},
      "",
      "voxels that are read as a share of the diameter of the cone; as published: 1, which reads twice as wide as the cone"};
  Param<float> reach{this, "reach", 0.0f, {0.0f, 1e9f}, "m", "length of a cone; 0: to the end of the grid"};
  Param<float> jitter{
      this,
      "jitter",
      0.0f,
      {0.0f, 1.0f},
      "",
      "most by which a cone's first step is shorter, as a share of it, by chance for each pixel and cone: noise in place of bands"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "indirect light reflected by the diffuse lobe"};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::glossyMaterial,
                    "indirect light reflected by the Phong lobe"};

  Reads readsFrom() const override { return Reads::camera; }

  void run(PassContext& frame) override {
    const RadianceGrid& input = *grid;
    if (input.holdsMedia && media.present())
      throw Error(
          "voxel_cone_tracing.gather: the voxels of 'grid' hold the media already, and 'media' would dim what the cones see once more; expected 'media' to be left out, or 'store_media off' in voxel_cone_tracing.inject");
    gatherShader::Variant variant;
    variant.diffuse = diffuse.wanted();
    variant.glossy = glossy.wanted() && gbuffer->specular != nullptr;
    variant.environment = frame.traits().environment;
    MediaBinding bound;
    if (media.present()) {
      bound = MediaBinding(frame, *media);
      variant.medium =
          bound.varying() ? gatherShader::Variant::mediumVarying : gatherShader::Variant::mediumEven;
    }
    gatherShader::Constants constants;
    constants.coneCount = cones;
    constants.publishedCones = distribution == "published" ? 1 : 0;
    constants.asPublished = asPublished ? 1 : 0;
    constants.opacityOfFinestVoxel = input.opacity == RadianceGrid::Opacity::ofFinestVoxel ? 1 : 0;
    gatherShader::Parameters parameters{};
    parameters.gridLow = input.grid.low;
    parameters.voxelSize = input.grid.voxelSize;
    parameters.gridExtent = glm::vec3(input.grid.resolution) * input.grid.voxelSize;
    parameters.stepShare = step;
    parameters.eyeWorld = frame.snapshot().camera.eye;
    parameters.maxDistance =
        reach > 0.0f ? static_cast<float>(reach) : 2.0f * glm::length(parameters.gridExtent);
    parameters.environment = frame.sceneDescription().environment;
    parameters.offset = offset;
    parameters.startShare = start;
    parameters.clearance = clearance;
    parameters.footprint = footprint;
    parameters.unit = input.unit;
    parameters.coarsest = static_cast<float>(input.radiance->description().levels - 1);
    parameters.coneRatio = coneRatio;
    parameters.jitter = jitter;
    parameters.seed = {static_cast<std::uint32_t>(frame.seed()),
                       static_cast<std::uint32_t>(frame.seed() >> 32)};

    using gpu::Sampling;
    std::vector<gpu::ResourceBinding> bindings{
        gatherShader::parameters(parameters), gatherShader::gPosition(*gbuffer->position, Sampling::nearest),
        gatherShader::gNormal(*gbuffer->normal, Sampling::nearest),
        gatherShader::gGeometricNormal(*gbuffer->geometricNormal, Sampling::nearest),
        gatherShader::radianceGrid(*input.radiance, Sampling::linearMipsBorder)};
    bound.addTo(bindings);
    Image diffuseImage, glossyImage;
    if (variant.diffuse) {
      diffuseImage.texture = frame.image(gpu::Format::rgba32f, "indirect diffuse radiance");
      bindings.push_back(gatherShader::gDiffuse(*gbuffer->diffuse, Sampling::nearest));
      bindings.push_back(gatherShader::diffuseImage(*diffuseImage.texture));
    }
    if (variant.glossy) {
      glossyImage.texture = frame.image(gpu::Format::rgba32f, "indirect glossy radiance");
      bindings.push_back(gatherShader::gSpecular(*gbuffer->specular, Sampling::nearest));
      bindings.push_back(gatherShader::glossyImage(*glossyImage.texture));
    }
    frame.dispatch(frame.program(gatherShader::kProgram, variant.key(), constants.values()), bindings,
                   {frame.snapshot().camera.width, frame.snapshot().camera.height, 1}, kImageGroup);
    if (variant.diffuse) diffuse = diffuseImage;
    if (variant.glossy) glossy = glossyImage;
  }
};

}  // namespace
}  // namespace lumivox::voxel_cone_tracing

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::voxel_cone_tracing;
  registry.describe("Voxel cone tracing on a dense isotropic grid",
                    "Crassin et al. 2011; thesis Gomes 2015, Sec. 4.2.1");
  registry.add<InjectPass>("inject", "Direct light into the finest level (Crassin et al. 2011, Sec. 6)");
  registry.add<FilterPass>("filter", "Pre-filtered coarser levels (Crassin et al. 2011, Sec. 5)");
  registry.add<GatherPass>("gather", "Final gathering with cones (Crassin et al. 2011, Sec. 7)");
}

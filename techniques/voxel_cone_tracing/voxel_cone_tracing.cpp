// Voxel cone tracing on a dense isotropic grid: Crassin et al. 2011, "Interactive indirect illumination using
// voxel cone tracing"; thesis Gomes 2015, Sec. 4.2.1. Injection of direct light, pre-filtering, final
// gathering.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/media.h"
#include "lumivox/plugin/technique.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {
namespace {

namespace injectShader = shaders::voxel_cone_tracing::inject;
namespace addShader = shaders::voxel_cone_tracing::add;
namespace resolveShader = shaders::voxel_cone_tracing::resolve;
namespace filterShader = shaders::voxel_cone_tracing::filter;
namespace gatherShader = shaders::voxel_cone_tracing::gather;

constexpr glm::ivec3 kVoxelGroup{4, 4, 4};  // local size of the passes over voxels
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
  Param<bool> twoSided{this, "two_sided", true,
                       "light on the back of a triangle counts; off, as published: only on the front"};
  Param<std::string> precision{
      this, "precision", "float", {"float", "half"}, "of the grid: 16 or 8 bytes a voxel"};
  Out<RadianceGrid> radiance{this, "radiance", "reflected radiance and opacity; the finest level only"};

  Reads readsFrom() const override { return Reads::lights | Reads::materials; }

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

    // Counts, largest values and sums: one 32-bit integer a voxel each that fragments can lie in; reading
    // beyond gives 0.
    gpu::TextureDescription words = description;
    words.width = fragments->grid.resolution.x;
    words.height = fragments->grid.resolution.y;
    words.depth = fragments->grid.resolution.z;
    words.format = gpu::Format::r32ui;
    words.levels = 1;
    const auto zeroed = [&](const char* label) {
      gpu::TextureRef texture = frame.texture(words, label);
      texture->clear(glm::vec4(0.0f));
      return texture;
    };
    const gpu::TextureRef counts = zeroed("fragments per voxel"),
                          brightest = zeroed("brightest fragment per voxel");
    const gpu::TextureRef red = zeroed("sum of red"), green = zeroed("sum of green"),
                          blue = zeroed("sum of blue"), coverage = zeroed("sum of coverage");
    const gpu::BufferRef radiances =
        frame.buffer(std::max<std::uint64_t>(fragments->capacity, 1) * 3 * sizeof(float),
                     "reflected radiance per fragment");
    const float range = largestRadiance(frame.sceneDescription(), frame.snapshot(), result.grid.voxelSize);
    if (precision == "half") result.unit = range / kLargestHalf;

    light(frame, *counts, *brightest, *radiances, range);
    frame.shaders().dispatchIndirect(
        frame.program(addShader::kProgram),
        {addShader::fragmentCount(*fragments->count), addShader::fragments(*fragments->fragments),
         addShader::radiances(*radiances), addShader::counts(*counts), addShader::brightest(*brightest),
         addShader::sumRed(*red), addShader::sumGreen(*green), addShader::sumBlue(*blue),
         addShader::sumCoverage(*coverage)},
        *fragments->count, sizeof(std::uint32_t));
    frame.device().barrier();
    frame.dispatch(
        frame.program(resolveShader::kProgram),
        {resolveShader::parameters(
             {size, result.unit, fragments->coverage == VoxelFragments::Coverage::sum ? 1 : 0}),
         resolveShader::counts(*counts), resolveShader::brightest(*brightest), resolveShader::sumRed(*red),
         resolveShader::sumGreen(*green), resolveShader::sumBlue(*blue),
         resolveShader::sumCoverage(*coverage), resolveShader::radianceImage(*result.radiance)},
        size, kVoxelGroup);
    radiance = result;
  }

  /// What each fragment reflects, and of each voxel the number and the brightest of its fragments.
  void light(PassContext& frame, const gpu::Texture& counts, const gpu::Texture& brightest,
             const gpu::Buffer& radiances, float mostRadiance) {
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
                                               injectShader::counts(counts),
                                               injectShader::brightest(brightest)};
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
};

class FilterPass : public Pass {
  In<RadianceGrid> radiance{this, "radiance", "the finest level"};
  Param<std::string> opacity{
      this,
      "opacity",
      "facing",
      {"facing", "average"},
      "how children make a parent: seen through along the axis that they face, or, as published, their plain mean"};
  Out<RadianceGrid> mips{this, "mips", "the same grid with one level per halving"};

  void run(PassContext& frame) override {
    const gpu::Texture& texture = *radiance->radiance;
    const gpu::TextureDescription& description = texture.description();
    const auto levelSize = [&](int level) {
      return glm::max(
          glm::ivec3(description.width >> level, description.height >> level, description.depth >> level),
          glm::ivec3(1));
    };
    for (int level = 1; level < description.levels; ++level) {
      filterShader::Parameters parameters{};
      parameters.coarse = levelSize(level);
      parameters.fineLevel = level - 1;
      parameters.fine = levelSize(level - 1);
      parameters.average = opacity == "average" ? 1 : 0;
      frame.dispatch(
          frame.program(filterShader::kProgram),
          {filterShader::parameters(parameters), filterShader::radianceGrid(texture, gpu::Sampling::nearest),
           filterShader::radianceImage(texture, level)},
          parameters.coarse, kVoxelGroup);
    }
    RadianceGrid filtered = *radiance;
    filtered.filledLevels = description.levels;
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
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "indirect light reflected by the diffuse lobe"};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::glossyMaterial,
                    "indirect light reflected by the Phong lobe"};

  Reads readsFrom() const override { return Reads::camera; }

  void run(PassContext& frame) override {
    const RadianceGrid& input = *grid;
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

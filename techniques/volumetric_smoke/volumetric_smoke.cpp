// Light in participating media on a voxel grid: thesis Gomes 2015, Sec. 2.5 and 4.5, after Vos 2014,
// "Volumetric light effects in Killzone: Shadow Fall". Particles, insertion into the grid, dithered ray
// marching, bilateral upsampling.
#include "volumetric_smoke.h"

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/grid_placement.h"

namespace lumivox::volumetric_smoke {

using namespace shaders::volumetric_smoke;

namespace {

constexpr std::uint64_t kCoordinates = 3;         // floats of a particle in a buffer
constexpr double kUnitsPerParticle = 16777216.0;  // kUnits in insert.comp

/// Sec. 4.5: the particle system, which Table 2 calls particle update.
class ParticlesPass : public Pass {
  Out<Particles> particles{this, "particles", "positions of the particles of every medium"};

  Reads readsFrom() const override { return Reads::time | Reads::media; }
  Needs needs() const override { return Needs::particles; }

  void run(PassContext& frame) override {
    Particles result;
    const std::vector<Medium>& media = frame.sceneDescription().media;
    for (std::size_t i = 0; i < media.size(); ++i) {
      const Medium& medium = media[i];
      if (medium.particles == 0) continue;
      const ParticleClock clock = particleClock(medium, frame.snapshot().time);
      const auto count = static_cast<std::uint32_t>(medium.particles);
      Particles::Group group{static_cast<int>(i), medium.particles,
                             frame.elements(particles::offsets, kCoordinates * count, "particles")};
      frame.dispatchList(frame.program(particles::kProgram),
                         {particles::parameters({.count = count,
                                                 .seed = medium.seed,
                                                 .lives = clock.lives,
                                                 .share = clock.share,
                                                 .life = static_cast<float>(medium.life),
                                                 .spread = static_cast<float>(medium.spread),
                                                 .drift = static_cast<float>(medium.drift),
                                                 .rise = static_cast<float>(medium.rise)}),
                          particles::offsets(group.offsets)},
                         count);
      result.groups.push_back(std::move(group));
    }
    particles = result;
  }
};

/// Sec. 4.5, Listing 4.50: inserts particles, uniform media and volume files into the grid.
class InsertPass : public Pass {
  enum class Deposit { clouds, counts };

  In<Particles> particles{this, "particles", Presence::optional, "positions of the particles"};
  In<OccupancyGrid> space{this, "space", Presence::optional,
                          "occupied voxels; particles distribute their mass among the free ones",
                          Needs::particles};
  Param<int> resolution{this, "resolution", 64, within(8, kLargestGrid),
                        "voxels along the longest side of the box that encloses all particles of a medium"};
  Param<Deposit> deposit{
      this, "deposit", Deposit::clouds,
      "clouds: each particle as its cloud; counts: each particle whole, in the voxel of its centre",
      published(Deposit::counts)};
  Out<ScatteringGrid> media{this, "media", "density, extinction and scattering of every medium"};

  Reads readsFrom() const override { return Reads::geometry | Reads::media; }
  Needs needs() const override { return Needs::medium; }

  void run(PassContext& frame) override {
    ScatteringGrid result;
    const std::vector<Medium>& all = frame.sceneDescription().media;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Medium& medium = all[i];
      ScatteringGrid::Medium one;
      one.name = medium.name;
      one.bounds = mediumBounds(medium, frame.snapshot());
      one.extinction = medium.extinction;
      one.albedo = medium.albedo;
      one.anisotropy = medium.anisotropy;
      if (medium.volume) {
        uploadVolume(frame, *medium.volume, one);
      } else if (medium.particles > 0) {
        const auto& groups = particles->groups;
        const auto group = std::ranges::find(groups, static_cast<int>(i), &Particles::Group::medium);
        if (group == groups.end())
          throw Error("volumetric_smoke.insert: the particles of medium '" + medium.name +
                      "' are missing; expected them from the input 'particles'");
        insert(frame, medium, *group, one);
      }
      result.media.push_back(std::move(one));
    }
    media = result;
  }

  /// Uploads the texture of a volume file once.
  void uploadVolume(PassContext& frame, const DensityVolume& volume, ScatteringGrid::Medium& result) {
    result.grid = {glm::vec3(volume.low - frame.snapshot().origin), static_cast<float>(volume.voxelSize),
                   volume.resolution};
    result.density = frame.kept("density of medium " + result.name, &volume, [&] {
      const gpu::TextureRef texture =
          frame.volume(volume.resolution, gpu::Format::r32f, "density of a volume file");
      texture->uploadFloats(0, volume.values);
      return texture;
    });
  }

  void insert(PassContext& frame, const Medium& medium, const Particles::Group& group,
              ScatteringGrid::Medium& result) {
    result.grid = placeGrid(result.bounds, resolution);
    const glm::ivec3 size = result.grid.resolution;
    const float voxelSize = result.grid.voxelSize;
    // Trilinear densities end half a voxel outside of the grid.
    result.bounds.low = result.grid.low - 0.5f * voxelSize;
    result.bounds.high = result.grid.low + voxelSize * (glm::vec3(size) + 0.5f);
    const gpu::TextureRef low = frame.emptyVolume(size, gpu::Format::r32ui, "particle units"),
                          high = frame.emptyVolume(size, gpu::Format::r32ui, "particle units, high words");
    insert::Parameters parameters{.source = glm::vec3(medium.source - frame.snapshot().origin),
                                  .count = static_cast<std::uint32_t>(group.count),
                                  .gridLow = result.grid.low,
                                  .voxelSize = voxelSize,
                                  .resolution = size,
                                  // A cloud smaller than a voxel could miss all centres.
                                  .radius = std::max(static_cast<float>(medium.radius), voxelSize)};
    gpu::TextureRef occupancy;
    if (space.present()) {
      parameters.spaceLow = space->grid.low;
      parameters.spaceVoxelSize = space->grid.voxelSize;
      occupancy = space->opacity;
    }
    using Variant = insert::Variant;
    const Variant variant{space.present(),
                          deposit == Deposit::counts ? Variant::depositCounts : Variant::depositClouds};
    frame.dispatchList(frame.program(variant),
                       {insert::parameters(parameters), insert::offsets(group.offsets), insert::lowWords(low),
                        insert::highWords(high), insert::occupancy(occupancy, gpu::Sampling::nearest)},
                       static_cast<std::uint64_t>(group.count));

    result.density = frame.volume(size, gpu::Format::r32f, "density of particles");
    const double voxelVolume = std::pow(static_cast<double>(voxelSize), 3.0);
    const auto densityPerUnit = static_cast<float>(particleMass(medium) / kUnitsPerParticle / voxelVolume);
    frame.dispatch(frame.program(density::kProgram),
                   {density::parameters({size, densityPerUnit}), density::lowWords(low),
                    density::highWords(high), density::densityImage(result.density)},
                   size);
  }
};

class MarchPass : public Pass {
  enum class LightDepth { volume, march };
  enum class Start { dithered, middle };
  enum class Phase { normalised, asPublished };

  In<GBuffer> gbuffer{this, "gbuffer", "where the rays end"};
  In<ScatteringGrid> media{this, "media", "media that the rays cross"};
  In<ShadowMap> shadow{this, "shadow", Presence::optional,
                       "lights and their visibility; without it media only dim"};
  Param<Resolution> resolution{this, "resolution", Resolution::half,
                               "one ray a pixel, or one for 2 x 2 pixels, to be upsampled"};
  Param<int> steps{this, "steps", 32, within(1, 4096), "steps along a ray's way through the media"};
  Param<LightDepth> lightDepth{
      this, "light_depth", LightDepth::volume,
      "optical depth of heterogeneous media towards the lights; volume: once a frame, at a grid of points; march: at every step of every ray"};
  Param<int> lightResolution{this, "light_resolution", 32, within(4, 256),
                             "points along each side of that grid; each light has a grid"};
  Param<int> cells{
      this,
      "cells",
      8,
      within(0, 1024),
      "cubes between voxels over which densities are integrated exactly, from each step towards the eye and towards the lights; 0: one density sample a step",
      published(0)};
  Param<int> lightSteps{this, "light_steps", 32, within(1, 1024),
                        "largest number of steps of a march towards a light"};
  Param<Start> start{
      this, "start", Start::dithered,
      "position of the sample in a step; dithered: different in neighbouring pixels; middle: the middle"};
  Param<Phase> phase{
      this, "phase", Phase::normalised,
      "Henyey-Greenstein phase function; normalised: with the factor (1-g^2); as_published: with (1-g)^2, which loses energy",
      published(Phase::asPublished)};
  Out<Image> scattered{
      this, "scattered", Contributes::scattered, Needs::medium,
      "light that media scatter once to the camera, W/(sr m^2); with `half` an image of half "
      "the size, to be upsampled"};
  Out<Image> transmittance{this, "transmittance", Contributes::nothing, Needs::medium,
                           "share of the light behind the media that they transmit; size as above"};

  Reads readsFrom() const override { return Reads::camera | Reads::lights; }
  Needs needs() const override { return Needs::medium; }

  void run(PassContext& frame) override {
    const CameraView& camera = frame.snapshot().camera;
    const int perSample = resolution == Resolution::half ? 2 : 1;
    const glm::ivec2 size = samplesOf(camera, perSample);
    makeImages(frame, size, scattered, transmittance);
    const MediaBinding bound(frame, *media);
    const LightBinding lights(shadow);
    const march::Constants constants{.stepCount = steps,
                                     .lightSteps = lightSteps,
                                     .dithered = start == Start::dithered,
                                     .phaseIsPublished = phase == Phase::asPublished,
                                     .exactCells = cells};
    march::Parameters parameters{.size = size, .lightCount = lights.count};
    gpu::TextureRef transmittances;
    if (lights.count > 0 && bound.axis == MediaBinding::varying && lightDepth == LightDepth::volume)
      transmittances = makeTransmittances(frame, bound, lights, parameters);
    const march::Variant variant{bound.axis == MediaBinding::varying, lights.count > 0,
                                 transmittances != nullptr};
    frame.dispatch(
        frame.program(variant, constants),
        {viewOf(camera, perSample), march::parameters(parameters), GBufferBinding(*gbuffer), lights, bound,
         march::lightTransmittance(transmittances, gpu::Sampling::linear),
         march::scatteredImage(scattered->texture), march::transmittanceImage(transmittance->texture)},
        {size, 1});
  }

  /// Makes the transmittances to all lights, side by side along z. Null where so many lights do not fit into
  /// a texture.
  gpu::TextureRef makeTransmittances(PassContext& frame, const MediaBinding& bound,
                                     const LightBinding& lights, march::Parameters& parameters) {
    const int lightCount = lights.count;
    constexpr float kSpacings = 2.0f;
    constexpr int kFewest = 4;  // fewest points along a side of a useful grid
    const int side = std::min<int>(lightResolution, frame.device().info().maxTextureSize3d / lightCount);
    if (side < kFewest) {
      frame.warn(
          "so many lights have no room in one texture of light transmittances; every step marches to them");
      return nullptr;
    }
    Bounds box;
    for (const ScatteringGrid::Medium& medium : media->media) {
      if (medium.density == nullptr) continue;
      box.grow(medium.bounds.low);
      box.grow(medium.bounds.high);
    }
    parameters.gridSide = side;
    parameters.gridLow = box.low;
    parameters.gridHigh = box.high;
    // The look-up at a place just inside a lit surface then uses points outside it.
    const glm::vec3 spacing = (box.high - box.low) / static_cast<float>(side);
    parameters.nearReach = cells > 0 ? kSpacings * std::max({spacing.x, spacing.y, spacing.z}) : 0.0f;
    const glm::ivec3 size(side, side, side * lightCount);
    gpu::TextureRef transmittances = frame.volume(size, gpu::Format::rgba32f, "transmittances to the lights");
    using Variant = light_depth::Variant;
    frame.dispatch(frame.program(Variant{Variant::mediumVarying}),
                   {light_depth::parameters({box.low, side, box.high, lightCount, lightSteps}), lights, bound,
                    light_depth::transmittanceImage(transmittances)},
                   size);
    return transmittances;
  }
};

class UpsamplePass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "where the pixels' rays end"};
  In<ScatteringGrid> media{this, "media", "media that the rays cross"};
  In<Image> scatteredSamples{this, "scattered", "from the march", Contributes::scattered};
  In<Image> transmittanceSamples{this, "transmittance", "from the march", Contributes::nothing};
  Param<float> similarity{
      this, "similarity", 0.05f, within(1e-4f, 10.0f),
      "relative difference between the lengths of two rays at which a sample's weight falls to 1/16"};
  Out<Image> scattered{this, "scattered", Contributes::scattered, Needs::medium,
                       "light that media scatter once to the camera, W/(sr m^2)"};
  Out<Image> transmittance{this, "transmittance", Contributes::nothing, Needs::medium,
                           "share of the light behind the media that they transmit"};

  Reads readsFrom() const override { return Reads::camera; }
  Needs needs() const override { return Needs::medium; }

  void run(PassContext& frame) override {
    const CameraView& camera = frame.snapshot().camera;
    // Compares both sides: half of one pixel is one.
    const gpu::TextureDescription& samples = scatteredSamples->texture->description();
    const int perSample = samples.width < camera.width || samples.height < camera.height ? 2 : 1;
    makeImages(frame, {camera.width, camera.height}, scattered, transmittance);
    frame.dispatch(
        frame.program(upsample::kProgram),
        {viewOf(camera, perSample), upsample::parameters({similarity}), GBufferBinding(*gbuffer),
         MediaBinding(frame, *media),
         upsample::scatteredSamples(scatteredSamples->texture, gpu::Sampling::nearest),
         upsample::transmittanceSamples(transmittanceSamples->texture, gpu::Sampling::nearest),
         upsample::scatteredImage(scattered->texture), upsample::transmittanceImage(transmittance->texture)},
        pixels(frame));
  }
};

}  // namespace
}  // namespace lumivox::volumetric_smoke

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::volumetric_smoke;
  registry.describe("Smoke and fog: particles in a voxel grid, dithered ray marching",
                    "Vos 2014; thesis Gomes 2015, Sec. 2.5 and 4.5");
  registry.add<ParticlesPass>("particles", "Rising particles (thesis Sec. 4.5)");
  registry.add<InsertPass>("insert", "Media as densities in grids (thesis Listing 4.50)");
  registry.add<MarchPass>("march",
                          "Single scattering and transmittance along rays (thesis Listings 4.51-4.53)");
  addMarchAsPublished(registry);
  registry.add<UpsamplePass>("upsample", "Bilateral upsampling of the march (thesis Sec. 4.5)");
}

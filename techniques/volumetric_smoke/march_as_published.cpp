// Listings 4.51 to 4.53 of thesis Gomes 2015 as printed; ours is MarchPass.
#include <algorithm>
#include <cmath>

#include "volumetric_smoke.h"

namespace lumivox::volumetric_smoke {

using namespace shaders::volumetric_smoke;

namespace {

// Tiny particles in huge voxels still give a number where their density vanishes.
constexpr double kLargestAmount = 1e30;

class MarchAsPublishedPass : public Pass {
  enum class Dither { asPublished, bayer };
  enum class Cosine { asPublished, unitVectors };
  enum class Phase { asPublished, normalised };

  In<GBuffer> gbuffer{this, "gbuffer", "where the rays end"};
  In<ScatteringGrid> media{this, "media",
                           "media that the rays cross; of particles, the count in a voxel is read"};
  In<ShadowMap> shadow{this, "shadow", Presence::optional,
                       "lights and their visibility; without it nothing is scattered"};
  Param<Resolution> resolution{this, "resolution", Resolution::half,
                               "one ray a pixel, or one for 2 x 2 pixels, to be upsampled"};
  Param<int> steps{this, "steps", 32, within(1, 4096),
                   "steps from the camera to the surface, wherever the media are"};
  Param<Dither> dither{
      this, "dither", Dither::asPublished,
      "dither matrix of Listing 4.51; as_published: with its entry 0.22; bayer: with 0.25 in its place"};
  Param<Cosine> cosine{
      this, "cosine", Cosine::asPublished,
      "cosine of the scattering angle; as_published: by the whole ray and the light's position, in units of half the scene's longest side (Listing 4.52); unit_vectors: of unit vectors"};
  Param<Phase> phase{
      this, "phase", Phase::asPublished,
      "factor of the phase function; as_published: (1-g)^2 of Listing 4.53; normalised: (1-g^2)"};
  Out<Image> scattered{
      this, "scattered", Contributes::scattered, Needs::medium,
      "mean over the steps of irradiance times the phase function where there is light; with "
      "`half` an image of half the size, to be upsampled"};
  Out<Image> transmittance{this, "transmittance", Contributes::nothing, Needs::medium,
                           "1, since the published media attenuate nothing; size as above"};

  Reads readsFrom() const override { return Reads::camera | Reads::lights | Reads::media; }
  Needs needs() const override { return Needs::medium; }

  void run(PassContext& frame) override {
    const CameraView& camera = frame.snapshot().camera;
    const int perSample = resolution == Resolution::half ? 2 : 1;
    const glm::ivec2 size = samplesOf(camera, perSample);
    makeImages(frame, size, scattered, transmittance);
    transmittance->texture->clear(glm::vec4(1.0f));
    const LightBinding lights(shadow);
    if (lights.count == 0) {
      scattered->texture->clear(glm::vec4(0.0f));
      return;
    }
    const MediaBinding bound(frame, *media);
    const march_as_published::Constants constants{.stepCount = steps,
                                                  .ditherIsPublished = dither == Dither::asPublished,
                                                  .cosineIsPublished = cosine == Cosine::asPublished,
                                                  .phaseIsPublished = phase == Phase::asPublished};
    const Bounds& scene = frame.snapshot().gridBounds;
    const glm::vec3 extent = scene.high - scene.low;
    march_as_published::Parameters parameters{
        .size = size,
        .lightCount = lights.count,
        .unit = std::max(0.5f * std::max({extent.x, extent.y, extent.z}), 1e-30f),
        .sceneCentre = 0.5f * (scene.low + scene.high)};
    const std::vector<Medium>& all = frame.sceneDescription().media;
    for (std::size_t i = 0; i < media->media.size(); ++i) {
      const ScatteringGrid::Medium& medium = media->media[i];
      float& amount = parameters.amountPerDensity[i / 4][static_cast<glm::length_t>(i % 4)];
      amount = 1.0f;
      if (i < all.size() && all[i].particles > 0 && all[i].radius > 0.0)
        amount = static_cast<float>(
            std::min(std::pow(double(medium.grid.voxelSize), 3.0) / particleMass(all[i]), kLargestAmount));
    }
    const march_as_published::Variant variant{bound.axis == MediaBinding::varying};
    frame.dispatch(
        frame.program(variant, constants),
        {viewOf(camera, perSample), march_as_published::parameters(parameters), GBufferBinding(*gbuffer),
         lights, bound, march_as_published::scatteredImage(scattered->texture)},
        {size, 1});
  }
};

}  // namespace

void addMarchAsPublished(TechniqueRegistry& registry) {
  registry.add<MarchAsPublishedPass>(
      "march_as_published",
      "The ray march of thesis Listings 4.51 to 4.53 to the letter, its errors included");
}

}  // namespace lumivox::volumetric_smoke

// Listings 4.51 to 4.53 of thesis Gomes 2015 as they are printed; ours is MarchPass.
#include <array>
#include <cmath>

#include "volumetric_smoke.h"
#include "volumetric_smoke_shaders.h"

namespace lumivox::volumetric_smoke {
namespace {

namespace code = shaders::volumetric_smoke::march_as_published;

class MarchAsPublishedPass : public Pass {
  enum class Dither { asPublished, bayer };
  friend constexpr auto words(Dither) { return std::array{"as_published", "bayer"}; }
  enum class Cosine { asPublished, unitVectors };
  friend constexpr auto words(Cosine) { return std::array{"as_published", "unit_vectors"}; }
  enum class Phase { asPublished, normalised };
  friend constexpr auto words(Phase) { return std::array{"as_published", "normalised"}; }

  In<GBuffer> gbuffer{this, "gbuffer", "where the rays end"};
  In<ScatteringGrid> media{this, "media",
                           "what they go through; of particles the count in a voxel is looked up"};
  In<ShadowMap> shadow{this, "shadow", Presence::optional,
                       "lights and their visibility; without it nothing is scattered"};
  Param<Resolution> resolution{this, "resolution", Resolution::half,
                               "one ray a pixel, or one for 2 x 2 pixels, to be upsampled"};
  Param<int> steps{this, "steps", 32, within(1, 4096),
                   "steps from the camera to the surface, wherever the media are"};
  Param<Dither> dither{this, "dither", Dither::asPublished,
                       "the matrix of Listing 4.51 with its entry 0.22, or with 0.25 in its place"};
  Param<Cosine> cosine{
      this, "cosine", Cosine::asPublished,
      "that of Listing 4.52, of the ray's whole way, with half the longest side of the scene for a unit, and the light's position, or of "
      "unit vectors"};
  Param<Phase> phase{this, "phase", Phase::asPublished, "the factor (1-g)^2 of Listing 4.53, or (1-g^2)"};
  Out<Image> scattered{
      this, "scattered", Contributes::scattered, Needs::medium,
      "mean over the steps of irradiance times the phase function where there is light; with "
      "`half` an image of half the size, to be upsampled"};
  Out<Image> transmittance{this, "transmittance", Contributes::nothing, Needs::medium,
                           "1: as published media dim nothing; size as above"};

  Reads readsFrom() const override { return Reads::camera | Reads::lights | Reads::media; }
  Needs needs() const override { return Needs::medium; }

  void run(PassContext& frame) override {
    const CameraView& camera = frame.snapshot().camera;
    const int perSample = resolution == Resolution::half ? 2 : 1;
    const glm::ivec2 size = samplesOf(camera, perSample);
    const Result result(frame, size);
    result.transmittance->clear(glm::vec4(1.0f));
    scattered = Image{result.scattered};
    transmittance = Image{result.transmittance};
    const LightBinding lights(shadow);
    if (lights.count == 0) {
      result.scattered->clear(glm::vec4(0.0f));
      return;
    }
    const MediaBinding bound(frame, *media);
    code::Constants constants;
    constants.stepCount = steps;
    constants.ditherIsPublished = dither == Dither::asPublished;
    constants.cosineIsPublished = cosine == Cosine::asPublished;
    constants.phaseIsPublished = phase == Phase::asPublished;
    code::Parameters parameters{.size = size, .lightCount = lights.count};
    const Bounds& scene = frame.snapshot().gridBounds;
    const glm::vec3 extent = scene.high - scene.low;
    parameters.sceneCentre = 0.5f * (scene.low + scene.high);
    parameters.unit = std::max(0.5f * std::max({extent.x, extent.y, extent.z}), 1e-30f);
    const std::vector<Medium>& all = frame.sceneDescription().media;
    for (std::size_t i = 0; i < media->media.size(); ++i) {
      const ScatteringGrid::Medium& medium = media->media[i];
      float& amount = parameters.amountPerDensity[i / 4][static_cast<glm::length_t>(i % 4)];
      amount = 1.0f;
      if (i < all.size() && all[i].particles > 0 && all[i].radius > 0.0)
        amount = static_cast<float>(std::pow(double(medium.grid.voxelSize), 3.0) / particleMass(all[i]));
    }
    const code::Variant variant{bound.axis == MediaBinding::varying};
    frame.dispatch(frame.program(variant, constants),
                   {code::view(viewOf<code::View>(camera, perSample)), code::parameters(parameters),
                    GBufferBinding(*gbuffer), lights, bound, code::scatteredImage(result.scattered)},
                   {size, 1});
  }
};

}  // namespace

void addMarchAsPublished(TechniqueRegistry& registry) {
  registry.add<MarchAsPublishedPass>(
      "march_as_published",
      "The ray march of thesis Listings 4.51 to 4.53 to the letter, its slips included");
}

}  // namespace lumivox::volumetric_smoke

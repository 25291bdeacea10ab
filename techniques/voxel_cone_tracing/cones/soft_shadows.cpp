// Soft shadows by cones to the lights: Crassin et al. 2011; thesis Gomes 2015, Sec. 2.4, Fig. 15.
#include <cmath>
#include <vector>

#include "light_discs.h"
#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/environment.h"
#include "lumivox/toolkit/light_samples.h"
#include "lumivox/toolkit/media.h"
#include "march.h"

namespace lumivox::voxel_cone_tracing {
namespace {

namespace shadows = shaders::voxel_cone_tracing::soft_shadows;

/// Mirror of LightDisc in soft_shadows.comp (std430).
struct DiscData {
  glm::vec4 centreRadius, normal;
};

/// Makes the lights without shadow maps, for a pass that finds their visibility itself.
class LightsPass : public Pass {
  enum class Cones { sample, light };

  Param<int> areaSamples{this, "area_samples", 16, within(1, 1024),
                         "point samples that represent all emissive triangles together"};
  Param<Cones> cones{
      this, "cones", Cones::sample,
      "disc at which a cone is aimed; sample: one for each point sample, of the area that it represents; light: one for each light, as wide as its power is spread, which takes one cone a light"};
  Out<LightDiscs> lights{this, "lights",
                         "every light as point samples, and the discs at which cones are aimed"};

  Reads readsFrom() const override { return Reads::geometry | Reads::materials | Reads::lights; }
  Needs needs() const override { return Needs::anyLight; }

  void run(PassContext& frame) override {
    constexpr int kNoShadow = 1;  // texels along a side of the views, which are never drawn
    LightSet set = sampleLights(frame.sceneDescription(), frame.snapshot(), areaSamples, kNoShadow);
    for (LightSampleData& sample : set.samples) sample.firstView = -1, sample.viewCount = 0;
    std::vector<DiscData> discs;
    std::vector<std::uint32_t> discOfSample;
    for (const LightDisc& disc : set.discs) {
      if (cones == Cones::light)
        discs.push_back({glm::vec4(disc.centre, disc.radius), glm::vec4(disc.normal, 0.0f)});
      for (int i = 0; i < disc.sampleCount; ++i) {
        const LightSampleData& sample = set.samples[static_cast<std::size_t>(disc.firstSample + i)];
        const bool area = sample.kind == LightSampleKind::area;
        if (cones == Cones::sample)
          discs.push_back({glm::vec4(sample.position, std::sqrt(sample.patchRadiusSquared)),
                           glm::vec4(area ? sample.direction : glm::vec3(0.0f), 0.0f)});
        discOfSample.push_back(static_cast<std::uint32_t>(discs.size() - 1));
      }
    }
    lights = LightDiscs{
        frame.uploaded(set.samples, "light samples"), frame.uploaded(discs, "discs of lights"),
        frame.uploaded(discOfSample, "discs of light samples"), static_cast<int>(set.samples.size())};
  }
};

class SoftShadowsPass : public Pass {
  // In the order of soft_shadows.comp.
  enum class Radius { larger, eye, light };
  enum class Opacity { surfaces, medium };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  StoreInput store{this};
  In<LightDiscs> lights{this, "lights", Presence::optional, "lights; without it only emission is seen"};
  In<ScatteringGrid> media{this, "media", Presence::optional,
                           "media that attenuate light between lights and surfaces"};
  Param<int> mediumSteps{this, "medium_steps", 32, within(1, 1024),
                         "largest number of steps through a heterogeneous medium towards a light"};
  Param<Radius> radius{
      this, "radius", Radius::larger,
      "radius of a cone; light: grows towards the light's disc; eye: that of the eye's cone at the surface, as published; larger: the larger of the two"};
  Param<Opacity> opacity{
      this, "opacity", Opacity::surfaces,
      "meaning of a voxel's opacity; surfaces: a closed surface blocks all light; medium: a medium, as for the other cones, which with trilinear reading lets exp(-2) = 0.14 of the light through a sheet"};
  Param<float> step{this, "step", 0.125f, within(0.05f, 2.0f),
                    "step along a cone as a share of its diameter"};
  Param<float> offset{
      this, "offset", 1.5f, within(0.0f, 8.0f),
      "distance of a cone's start along the normal, and of its end before an area light, in voxels"};
  Param<float> start{this, "start", 0.5f, within(0.0f, 8.0f),
                     "distance of a cone's start along its axis, in voxels"};
  Param<float> clearance{
      this, "clearance", 1.0f / 3.0f, within(0.0f, 1e3f),
      "largest voxel that is read, as a share of its height over the surface and over an area light's surface; above a third voxels reach that surface"};
  Param<float> footprint{this, "footprint", 0.5f, within(0.25f, 1.0f),
                         "size of the voxels that are read, as a share of the cone's diameter"};
  Out<Image> radiance{this, "radiance", Contributes::direct, Needs::nothing,
                      "emission and light that is reflected once, W/(sr m^2)"};

  Reads readsFrom() const override { return Reads::camera | Reads::lights | Reads::environment; }

  void run(PassContext& frame) override {
    const StoreBinding input = store.binding();
    if (input.holdsMedia && media.present())
      throw Error(
          "voxel_cone_tracing.soft_shadows: the voxels of 'grid' already contain the media, and 'media' would dim the light once more; expected 'media' to be left out, or 'store_media off' in voxel_cone_tracing.inject");
    const shader::BindingSet bound =
        lights.present()
            ? shader::BindingSet{shader::StorageSlot{"Lights"}(lights->lights), shadows::discs(lights->discs),
                                 shadows::discOfSample(lights->discOfSample)}
            : shader::BindingSet{};
    const MediaBinding boundMedia(frame, media, lights.present());
    const shadows::Variant variant{.lights = lights.present(),
                                   .glossy = gbuffer->specular != nullptr,
                                   .emission = frame.traits().emission,
                                   .medium = boundMedia.axis,
                                   .store = input.axis,
                                   .faces = input.faces};
    const shadows::Constants constants{.radiusOf = static_cast<int>(static_cast<Radius>(radius)),
                                       .asMedium = opacity == Opacity::medium,
                                       .environmentMap = environmentMapOf(frame)};
    const CameraView& camera = frame.snapshot().camera;
    radiance = Image{frame.image("direct radiance")};
    frame.dispatch(
        frame.program(variant, constants),
        {shadows::directLight({.eyeWorld = camera.eye,
                               .lightCount = lights.present() ? lights->lightCount : 0,
                               .environment = frame.sceneDescription().environment,
                               .mediumSteps = mediumSteps}),
         shadows::shadows({.stepShare = step,
                           .offset = offset,
                           .startShare = start,
                           .clearance = clearance,
                           .footprint = footprint,
                           .pixelWidth = 2.0f * camera.tanHalfFov / static_cast<float>(camera.height)}),
         GBufferBinding(*gbuffer), shadows::emissionImage(gbuffer->emission), bound, boundMedia, input,
         EnvironmentBinding(frame), EnvironmentViewBinding(frame), shadows::radianceImage(radiance->texture)},
        pixels(frame));
  }
};

}  // namespace

void addSoftShadows(TechniqueRegistry& registry) {
  registry.add<LightsPass>("lights", "Every light as point samples, without shadow maps");
  registry.add<SoftShadowsPass>(
      "soft_shadows",
      "Direct light, with cones to the lights for shadows (Crassin et al. 2011; thesis Sec. 2.4)");
}

}  // namespace lumivox::voxel_cone_tracing

// Direct light by rasterisation, the common ground of all techniques and the template for new ones: g-buffer,
// shadow maps for every kind of light, shading, and the sum of the components.
#include <algorithm>

#include "direct_lighting_shaders.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/environment.h"
#include "lumivox/toolkit/light_views.h"
#include "lumivox/toolkit/media.h"
#include "lumivox/toolkit/visible_surface.h"

namespace lumivox::direct_lighting {
namespace {

using namespace shaders::direct_lighting;

class GBufferPass : public Pass {
  Out<GBuffer> gbuffer{this, "gbuffer",
                       "position, normals and material of the nearest surface in each pixel"};

  Reads readsFrom() const override { return Reads::geometry | Reads::materials | Reads::camera; }

  void run(PassContext& frame) override {
    const SceneTraits& traits = frame.traits();
    GBuffer result;
    result.position = frame.image("g-buffer position");
    result.normal = frame.image("g-buffer normal");
    result.geometricNormal = frame.image("g-buffer geometric normal");
    result.diffuse = frame.image("g-buffer diffuse albedo");
    if (traits.glossy) result.specular = frame.image("g-buffer specular");
    if (traits.emission) result.emission = frame.image("g-buffer emission");
    drawVisible(frame,
                {result.position, result.normal, result.geometricNormal, result.diffuse, result.specular,
                 result.emission},
                gbuffer::Variant{.glossy = traits.glossy, .emission = traits.emission}, {});
    gbuffer = result;
  }
};

class ShadowMapPass : public LightViewPass {
 public:
  ShadowMapPass() : LightViewPass(512, within(16, 8192), 128, within(16, 4096)) {}

 private:
  Out<ShadowMap> depth{this, "depth", "every light as point samples, with depth seen from each"};

  void run(PassContext& frame) override {
    const LightViews views = placed(frame);
    const ShadowMap result{views.lights, views.views,
                           views.layers(frame, gpu::Format::depth32f, "shadow depth"), views.lightCount(),
                           views.layerCount()};
    const gpu::RasterState state{
        .depthTest = true, .depthWrite = true, .depthBiasSlope = 1.5f, .depthBiasConstant = 2.0f};
    const auto targets = [&](int layer) {
      return gpu::RenderTargets{.depth = result.depth.get(), .depthLayer = layer};
    };
    drawLightViews(frame, views, state, targets, [&](const LightViewDrawn& drawn, const SceneDraw& draw) {
      drawPart(frame, draw, shadow_map::Variant{}, {shadow_map::view({drawn.view.worldToClip})});
    });
    if (views.layerCount() == 0) result.depth->clear(glm::vec4(1.0f));
    depth = result;
  }
};

class ShadePass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<ShadowMap> shadow{this, "shadow", Presence::optional,
                       "lights and their visibility; without it only emission is seen"};
  In<ScatteringGrid> media{this, "media", Presence::optional,
                           "media that attenuate light between lights and surfaces"};
  Param<int> mediumSteps{this, "medium_steps", 32, within(1, 1024),
                         "largest number of steps through a heterogeneous medium towards a light"};
  Param<bool> shadows{this, "shadows", true, "shadow test; off: light passes through everything"};
  Param<bool> areaLights{
      this, "area_lights", true,
      "light of emissive surfaces on others; off: another pass adds it, and only the emissive surfaces themselves are shown"};
  Out<Image> radiance{this, "radiance", Contributes::direct, Needs::nothing,
                      "emission and light that is reflected once, W/(sr m^2)"};

  Reads readsFrom() const override { return Reads::camera | Reads::lights | Reads::environment; }

  void run(PassContext& frame) override {
    const LightBinding lights(shadow);
    const MediaBinding bound(frame, media, shadow.present());
    const shade::Variant variant{.lights = shadow.present(),
                                 .shadows = shadow.present() && shadows,
                                 .glossy = gbuffer->specular != nullptr,
                                 .emission = gbuffer->emission != nullptr,
                                 .medium = bound.axis};
    const auto withoutExtent = static_cast<int>(frame.snapshot().lights.size());  // they come first
    const int lightCount = areaLights ? lights.count : std::min(lights.count, withoutExtent);
    radiance = Image{frame.image("direct radiance")};
    frame.dispatch(frame.program(variant, shade::Constants{.environmentMap = environmentMapOf(frame)}),
                   {EnvironmentViewBinding(frame),
                    shade::directLight({.eyeWorld = frame.snapshot().camera.eye,
                                        .lightCount = lightCount,
                                        .environment = frame.sceneDescription().environment,
                                        .mediumSteps = mediumSteps}),
                    GBufferBinding(*gbuffer), shade::emissionImage(gbuffer->emission), lights, bound,
                    shade::radianceImage(radiance->texture)},
                   pixels(frame));
  }
};

class ComposePass : public Pass {
  In<Image> direct{this, "direct", "direct light", Contributes::direct};
  In<Image> diffuse{this,
                    "diffuse",
                    Presence::optional,
                    "indirect light reflected by the diffuse lobe",
                    Needs::nothing,
                    Contributes::indirectDiffuse};
  In<Image> glossy{this,
                   "glossy",
                   Presence::optional,
                   "indirect light reflected by the Phong lobe",
                   Needs::nothing,
                   Contributes::indirectGlossy};
  In<Image> transmittance{this,
                          "transmittance",
                          Presence::optional,
                          "share of the surfaces' light that media transmit to the camera",
                          Needs::nothing,
                          Contributes::nothing};
  In<Image> scattered{
      this,           "scattered",           Presence::optional, "light that media scatter to the camera",
      Needs::nothing, Contributes::scattered};
  Out<Image> radiance{this, "radiance", Contributes::final, Needs::nothing,
                      "sum of the components, W/(sr m^2)"};

  void run(PassContext& frame) override {
    const compose::Variant variant{.diffuse = diffuse.present(),
                                   .glossy = glossy.present(),
                                   .transmittance = transmittance.present(),
                                   .scattered = scattered.present()};
    radiance = Image{frame.image("final radiance")};
    using gpu::Sampling;
    frame.dispatch(frame.program(variant),
                   {compose::directRadiance(direct->texture, Sampling::nearest),
                    compose::diffuseRadiance(textureOf(diffuse), Sampling::nearest),
                    compose::glossyRadiance(textureOf(glossy), Sampling::nearest),
                    compose::mediaTransmittance(textureOf(transmittance), Sampling::nearest),
                    compose::scatteredRadiance(textureOf(scattered), Sampling::nearest),
                    compose::radianceImage(radiance->texture)},
                   pixels(frame));
  }
};

}  // namespace
}  // namespace lumivox::direct_lighting

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::direct_lighting;
  registry.describe("Direct light by rasterisation: g-buffer, shadow maps, shading, composition",
                    "Williams 1978; Saito & Takahashi 1990");
  registry.add<GBufferPass>("gbuffer", "Attributes of the visible surfaces (Saito & Takahashi 1990)");
  registry.add<ShadowMapPass>("shadow_map",
                              "Depth from every light (Williams 1978); area lights as point samples");
  registry.add<ShadePass>("shade", "Emission and direct light through the diffuse and the Phong lobe");
  registry.add<ComposePass>("compose", "Sum of direct and indirect components");
}

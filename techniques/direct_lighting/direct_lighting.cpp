// Direct light by rasterisation, the common ground of all techniques and the template for new ones: what the
// camera sees, shadow maps for every kind of light, shading, and the sum of the components.
#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "direct_lighting_shaders.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/light_views.h"
#include "lumivox/toolkit/media.h"

namespace lumivox::direct_lighting {
namespace {

using namespace shaders::direct_lighting;

/// World to clip space of a camera, z in [0,1]. Depth is clamped when drawing, so that near only sets the
/// precision. In single precision a depth that begins at a ten thousandth of the far end tells surfaces apart
/// that are 6e-4 of it from each other: from outside of the scene it begins where the scene does.
glm::mat4 worldToClip(const SceneSnapshot& snapshot) {
  const CameraView& camera = snapshot.camera;
  const glm::vec3 farCorner =
      glm::max(glm::abs(snapshot.bounds.low - camera.eye), glm::abs(snapshot.bounds.high - camera.eye));
  const float far = std::max(glm::length(farCorner), 1e-6f) * 1.01f;
  const float aspect = static_cast<float>(camera.width) / static_cast<float>(camera.height);
  // Along the axis, of what is seen in a corner of the image.
  const glm::vec3 nearest = glm::clamp(camera.eye, snapshot.bounds.low, snapshot.bounds.high);
  const float before = 0.99f * glm::length(nearest - camera.eye) /
                       glm::length(glm::vec3(1.0f, camera.tanHalfFov, camera.tanHalfFov * aspect));
  const float near = std::max(far * 1e-4f, before);
  const float fov = 2.0f * std::atan(camera.tanHalfFov);
  glm::mat4 projection = glm::perspectiveRH_ZO(fov, aspect, near, far);
  // The image moves against the rays; clip space is 2 wide, and w is minus the depth's coordinate.
  projection[2][0] += 2.0f * camera.shift.x / static_cast<float>(camera.width);
  projection[2][1] -= 2.0f * camera.shift.y / static_cast<float>(camera.height);
  return projection * glm::lookAtRH(camera.eye, camera.eye + camera.forward, camera.up);
}

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
    const glm::ivec3 size = pixels(frame);
    const gpu::TextureRef depth =
        frame.texture({gpu::TextureKind::d2, gpu::Format::depth32f, size.x, size.y, 1, 1}, "g-buffer depth");

    gpu::RenderTargets targets{.depth = depth.get()};
    for (const gpu::TextureRef& texture : {result.position, result.normal, result.geometricNormal,
                                           result.diffuse, result.specular, result.emission}) {
      targets.colours.push_back({texture.get(), -1});
    }
    while (targets.colours.back().texture == nullptr) targets.colours.pop_back();
    const gpu::Drawing drawing =
        frame.device().drawTo(targets, {.depthTest = true, .depthWrite = true, .depthClamp = true});
    for (const SceneDraw& draw : frame.scene().draws())
      drawPart(frame, draw, gbuffer::Variant{.glossy = traits.glossy, .emission = traits.emission},
               {gbuffer::view({worldToClip(frame.snapshot())}),
                gbuffer::eye({frame.snapshot().camera.eye, glm::vec2(pixels(frame)),
                              static_cast<float>(draw.model)})});
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
    const gpu::RasterState state{.depthTest = true,
                                 .depthWrite = true,
                                 .depthClamp = true,
                                 .depthBiasSlope = 1.5f,
                                 .depthBiasConstant = 2.0f};
    const auto targets = [&](int layer) {
      return gpu::RenderTargets{.depth = result.depth.get(), .depthLayer = layer};
    };
    drawLightViews(frame, views, state, targets, [&](const LightViewDrawn& drawn, const SceneDraw& draw) {
      drawPart(frame, draw, shadow_map::Variant{}, {shadow_map::view({drawn.view.worldToClip})});
    });
    depth = result;
  }
};

class ShadePass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<ShadowMap> shadow{this, "shadow", Presence::optional,
                       "lights and their visibility; without it only emission is seen"};
  In<ScatteringGrid> media{this, "media", Presence::optional,
                           "media between lights and surfaces, which dim the light on its way"};
  Param<int> mediumSteps{this, "medium_steps", 32, within(1, 1024),
                         "most steps through a medium that varies, towards a light"};
  Param<bool> shadows{this, "shadows", true, "test visibility; off: lights shine through everything"};
  Param<bool> areaLights{this, "area_lights", true,
                         "light of emissive surfaces; off: another pass brings it, and they alone are seen"};
  Out<Image> radiance{this, "radiance", Contributes::direct, Needs::nothing,
                      "emission and light that is reflected once, W/(sr m^2)"};

  Reads readsFrom() const override { return Reads::camera | Reads::lights | Reads::environment; }

  void run(PassContext& frame) override {
    const LightBinding lights(shadow);
    const MediaBinding bound(frame, media, shadow.present());
    const shade::Variant variant{.lights = shadow.present(),
                                 .shadows = shadow.present() && shadows,
                                 .glossy = gbuffer->specular != nullptr,
                                 .emission = frame.traits().emission,
                                 .medium = bound.axis};
    const auto withoutExtent = static_cast<int>(frame.snapshot().lights.size());  // they come first
    const int lightCount = areaLights ? lights.count : std::min(lights.count, withoutExtent);
    radiance = Image{frame.image("direct radiance")};
    frame.dispatch(frame.program(variant),
                   {shade::directLight({.eyeWorld = frame.snapshot().camera.eye,
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
                          "what media leave of the light of surfaces on its way to the camera",
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

// Direct light by rasterisation, the common ground of all techniques and the template for new ones: what the
// camera sees, shadow maps for every kind of light, shading, and the sum of the components.
#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "direct_lighting_shaders.h"
#include "lumivox/pipeline/gpu_scene.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/light_samples.h"
#include "lumivox/toolkit/media.h"

namespace lumivox::direct_lighting {
namespace {

namespace gbufferShader = shaders::direct_lighting::gbuffer;
namespace shadowShader = shaders::direct_lighting::shadow_map;
namespace shadeShader = shaders::direct_lighting::shade;
namespace composeShader = shaders::direct_lighting::compose;

constexpr glm::ivec3 kImageGroup{8, 8, 1};  // local size of the picture-sized compute shaders

glm::ivec3 pixelsOf(const SceneSnapshot& snapshot) {
  return {snapshot.camera.width, snapshot.camera.height, 1};
}

/// World to clip space of a camera, z in [0,1]. Depth is clamped when drawing, so that near only sets the
/// precision.
glm::mat4 worldToClip(const SceneSnapshot& snapshot) {
  const CameraView& camera = snapshot.camera;
  const glm::vec3 farCorner =
      glm::max(glm::abs(snapshot.bounds.low - camera.eye), glm::abs(snapshot.bounds.high - camera.eye));
  const float far = std::max(glm::length(farCorner), 1e-6f) * 1.01f;
  const float near = far * 1e-4f;
  const float aspect = static_cast<float>(camera.width) / static_cast<float>(camera.height);
  const float fov = 2.0f * std::atan(camera.tanHalfFov);
  return glm::perspectiveRH_ZO(fov, aspect, near, far) *
         glm::lookAtRH(camera.eye, camera.eye + camera.forward, camera.up);
}

/// The picture-sized textures are kept in 32-bit floats: positions and radiances of any scale.
gpu::TextureRef floatImage(PassContext& frame, const char* label) {
  return frame.image(gpu::Format::rgba32f, label);
}

class GBufferPass : public Pass {
  Out<GBuffer> gbuffer{this, "gbuffer",
                       "position, normals and material of the nearest surface in each pixel"};

  Reads readsFrom() const override { return Reads::geometry | Reads::materials | Reads::camera; }

  void run(PassContext& frame) override {
    const SceneTraits& traits = frame.traits();
    GBuffer result;
    result.position = floatImage(frame, "g-buffer position");
    result.normal = floatImage(frame, "g-buffer normal");
    result.geometricNormal = floatImage(frame, "g-buffer geometric normal");
    result.diffuse = floatImage(frame, "g-buffer diffuse albedo");
    if (traits.glossy) result.specular = floatImage(frame, "g-buffer specular");
    if (traits.emission) result.emission = floatImage(frame, "g-buffer emission");
    gpu::TextureDescription depth;
    depth.format = gpu::Format::depth32f;
    depth.width = frame.snapshot().camera.width;
    depth.height = frame.snapshot().camera.height;
    const gpu::TextureRef depthTexture = frame.texture(depth, "g-buffer depth");

    gpu::RenderTargets targets;
    for (const gpu::TextureRef& texture : {result.position, result.normal, result.geometricNormal,
                                           result.diffuse, result.specular, result.emission}) {
      targets.colours.push_back({texture.get(), -1});
    }
    while (targets.colours.back().texture == nullptr) targets.colours.pop_back();
    targets.depth = depthTexture.get();
    gpu::RasterState state;
    state.depthTest = state.depthWrite = state.depthClamp = true;
    drawScene(frame, targets, state);
    gbuffer = result;
  }

  static void drawScene(PassContext& frame, const gpu::RenderTargets& targets,
                        const gpu::RasterState& state) {
    const SceneTraits& traits = frame.traits();
    const gbufferShader::View view{worldToClip(frame.snapshot())};
    const gbufferShader::Eye eye{frame.snapshot().camera.eye, glm::vec2(pixelsOf(frame.snapshot()))};
    GpuScene& scene = frame.scene();
    const gpu::Drawing drawing = frame.device().drawTo(targets, state);
    for (const SceneDraw& draw : scene.draws()) {
      // A draw uses the variant that its own material needs; with --keep-everything all do everything, with
      // neutral textures.
      const bool keep = frame.keepsEverything();
      gbufferShader::Variant variant;
      variant.textures = keep || draw.diffuseTexture != nullptr;
      variant.masks = keep || draw.maskTexture != nullptr;
      variant.glossy = traits.glossy;
      variant.emission = traits.emission;
      const gpu::Texture& diffuse =
          draw.diffuseTexture != nullptr ? *draw.diffuseTexture : scene.whiteTexture();
      const gpu::Texture& mask = draw.maskTexture != nullptr ? *draw.maskTexture : scene.whiteTexture();
      frame.shaders().drawIndexed(
          frame.program(gbufferShader::kProgram, variant.key()),
          {gbufferShader::positions(scene.positions()), gbufferShader::normals(scene.normals()),
           gbufferShader::texcoords(scene.texcoords()), gbufferShader::objects(scene.objects()),
           gbufferShader::materials(scene.materials()), gbufferShader::view(view), gbufferShader::eye(eye),
           gbufferShader::draw({draw.object, draw.material}),
           gbufferShader::diffuseTexture(diffuse, gpu::Sampling::linearMipsRepeat),
           gbufferShader::maskTexture(mask, gpu::Sampling::linearMipsRepeat)},
          scene.indices(), draw.firstIndex, draw.indexCount);
    }
  }
};

class ShadowMapPass : public Pass {
  Param<int> size{this, "size", 512, {16, 8192}, "texels along a side of the view of a light without extent"};
  Param<int> areaSamples{
      this, "area_samples", 16, {1, 1024}, "point samples that stand for all emissive triangles together"};
  Param<int> areaSize{
      this, "area_size", 128, {16, 4096}, "texels along a side of each cube face of an area sample"};
  Out<ShadowMap> depth{this, "depth", "every light as point samples, with depth seen from each"};

  Reads readsFrom() const override { return Reads::geometry | Reads::materials | Reads::lights; }
  Needs needs() const override { return Needs::anyLight; }

  void run(PassContext& frame) override {
    const Scene& description = frame.sceneDescription();
    // One array holds all layers, so that they share one size: the larger one when both kinds of light are
    // there.
    const bool onlyArea = frame.snapshot().lights.empty();
    const int side = onlyArea ? static_cast<int>(areaSize) : static_cast<int>(size);
    const LightSet set = sampleLights(description, frame.snapshot(), areaSamples, side);

    ShadowMap result;
    result.lightCount = static_cast<int>(set.samples.size());
    result.layerCount = static_cast<int>(set.views.size());
    result.lights =
        frame.buffer(std::max<std::size_t>(set.samples.size(), 1) * sizeof(LightSampleData), "light samples");
    result.views =
        frame.buffer(std::max<std::size_t>(set.views.size(), 1) * sizeof(glm::mat4), "shadow views");
    std::vector<glm::mat4> matrices;
    for (const LightView& view : set.views) matrices.push_back(view.worldToClip);
    if (!set.samples.empty()) result.lights->upload(std::as_bytes(std::span(set.samples)));
    if (!matrices.empty()) result.views->upload(std::as_bytes(std::span(matrices)));

    gpu::TextureDescription layers;
    layers.kind = gpu::TextureKind::d2Array;
    layers.format = gpu::Format::depth32f;
    layers.width = layers.height = side;
    layers.depth = std::max(result.layerCount, 1);
    result.depth = frame.texture(layers, "shadow depth");
    for (int layer = 0; layer < result.layerCount; ++layer)
      drawLayer(frame, result, set.views[static_cast<std::size_t>(layer)], layer);
    depth = result;
  }

  static void drawLayer(PassContext& frame, const ShadowMap& result, const LightView& view, int layer) {
    GpuScene& scene = frame.scene();
    gpu::RenderTargets targets;
    targets.depth = result.depth.get();
    targets.depthLayer = layer;
    gpu::RasterState state;
    state.depthTest = state.depthWrite = state.depthClamp = true;
    state.depthBiasSlope = 1.5f;
    state.depthBiasConstant = 2.0f;
    const gpu::Drawing drawing = frame.device().drawTo(targets, state);
    const std::size_t count = view.used ? scene.draws().size() : 0;
    for (std::size_t i = 0; i < count; ++i) {
      const SceneDraw& draw = scene.draws()[i];
      shadowShader::Variant variant;
      variant.masks = frame.keepsEverything() || draw.maskTexture != nullptr;
      const gpu::Texture& mask = draw.maskTexture != nullptr ? *draw.maskTexture : scene.whiteTexture();
      frame.shaders().drawIndexed(
          frame.program(shadowShader::kProgram, variant.key()),
          {shadowShader::positions(scene.positions()), shadowShader::texcoords(scene.texcoords()),
           shadowShader::objects(scene.objects()), shadowShader::view({view.worldToClip}),
           shadowShader::draw({draw.object, draw.material}),
           shadowShader::maskTexture(mask, gpu::Sampling::linearMipsRepeat)},
          scene.indices(), draw.firstIndex, draw.indexCount);
    }
  }
};

class ShadePass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<ShadowMap> shadow{this, "shadow", Presence::optional,
                       "lights and their visibility; without it only emission is seen"};
  In<ScatteringGrid> media{this, "media", Presence::optional,
                           "media between lights and surfaces, which dim the light on its way"};
  Param<int> mediumSteps{
      this, "medium_steps", 32, {1, 1024}, "most steps through a medium that varies, towards a light"};
  Param<bool> shadows{this, "shadows", true, "test visibility; off: lights shine through everything"};
  Out<Image> radiance{this, "radiance", Contributes::direct, Needs::nothing,
                      "emission and light that is reflected once, W/(sr m^2)"};

  Reads readsFrom() const override { return Reads::camera | Reads::lights; }

  void run(PassContext& frame) override {
    const SceneTraits& traits = frame.traits();
    shadeShader::Variant variant;
    variant.lights = shadow.present();
    variant.shadows = variant.lights && shadows;
    variant.glossy = gbuffer->specular != nullptr;
    variant.emission = traits.emission;
    shadeShader::Parameters parameters{};
    parameters.eyeWorld = frame.snapshot().camera.eye;
    parameters.lightCount = shadow.present() ? shadow->lightCount : 0;
    parameters.environment = frame.sceneDescription().environment;
    parameters.mediumSteps = mediumSteps;
    MediaBinding bound;
    if (variant.lights != 0 && media.present()) {
      bound = MediaBinding(frame, *media);
      variant.medium =
          bound.varying() ? shadeShader::Variant::mediumVarying : shadeShader::Variant::mediumEven;
    }
    Image result{floatImage(frame, "direct radiance")};
    using gpu::Sampling;
    std::vector<gpu::ResourceBinding> bindings{
        shadeShader::parameters(parameters),
        shadeShader::gPosition(*gbuffer->position, Sampling::nearest),
        shadeShader::gNormal(*gbuffer->normal, Sampling::nearest),
        shadeShader::gGeometricNormal(*gbuffer->geometricNormal, Sampling::nearest),
        shadeShader::gDiffuse(*gbuffer->diffuse, Sampling::nearest),
        shadeShader::radianceImage(*result.texture)};
    if (variant.glossy) bindings.push_back(shadeShader::gSpecular(*gbuffer->specular, Sampling::nearest));
    if (variant.emission) bindings.push_back(shadeShader::gEmission(*gbuffer->emission, Sampling::nearest));
    if (variant.lights) bindings.push_back(shadeShader::lights(*shadow->lights));
    if (variant.shadows) {
      bindings.push_back(shadeShader::views(*shadow->views));
      bindings.push_back(shadeShader::shadowDepth(*shadow->depth, Sampling::shadow));
    }
    bound.addTo(bindings);
    frame.dispatch(frame.program(shadeShader::kProgram, variant.key()), bindings, pixelsOf(frame.snapshot()),
                   kImageGroup);
    radiance = result;
  }
};

class ComposePass : public Pass {
  In<Image> direct{this, "direct", "direct light"};
  In<Image> diffuse{this, "diffuse", Presence::optional, "indirect light reflected by the diffuse lobe"};
  In<Image> glossy{this, "glossy", Presence::optional, "indirect light reflected by the Phong lobe"};
  In<Image> transmittance{this, "transmittance", Presence::optional,
                          "what media leave of the light of surfaces on its way to the camera"};
  In<Image> scattered{this, "scattered", Presence::optional, "light that media scatter to the camera"};
  Out<Image> radiance{this, "radiance", Contributes::final, Needs::nothing,
                      "sum of the components, W/(sr m^2)"};

  void run(PassContext& frame) override {
    composeShader::Variant variant;
    variant.diffuse = diffuse.present();
    variant.glossy = glossy.present();
    variant.transmittance = transmittance.present();
    variant.scattered = scattered.present();
    Image result{floatImage(frame, "final radiance")};
    using gpu::Sampling;
    std::vector<gpu::ResourceBinding> bindings{
        composeShader::directRadiance(*direct->texture, Sampling::nearest),
        composeShader::radianceImage(*result.texture)};
    if (variant.diffuse)
      bindings.push_back(composeShader::diffuseRadiance(*diffuse->texture, Sampling::nearest));
    if (variant.glossy)
      bindings.push_back(composeShader::glossyRadiance(*glossy->texture, Sampling::nearest));
    if (variant.transmittance)
      bindings.push_back(composeShader::mediaTransmittance(*transmittance->texture, Sampling::nearest));
    if (variant.scattered)
      bindings.push_back(composeShader::scatteredRadiance(*scattered->texture, Sampling::nearest));
    frame.dispatch(frame.program(composeShader::kProgram, variant.key()), bindings,
                   pixelsOf(frame.snapshot()), kImageGroup);
    radiance = result;
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

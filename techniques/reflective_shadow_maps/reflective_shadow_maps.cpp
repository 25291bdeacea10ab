// Reflective shadow maps: Dachsbacher & Stamminger 2005, "Reflective shadow maps"; thesis Gomes 2015,
// Sec. 2.2. What every light sees, as a source of one-bounce light, and gathering from it without visibility.
#include <algorithm>
#include <cmath>

#include "lumivox/pipeline/gpu_scene.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/light_samples.h"
#include "lumivox/toolkit/list_dispatch.h"
#include "reflective_shadow_maps_shaders.h"

namespace lumivox::reflective_shadow_maps {
namespace {

namespace renderShader = shaders::reflective_shadow_maps::render;
namespace accumulateShader = shaders::reflective_shadow_maps::accumulate;
namespace chooseShader = shaders::reflective_shadow_maps::choose;
namespace gatherShader = shaders::reflective_shadow_maps::gather;

constexpr glm::ivec3 kImageGroup{8, 8, 1};
constexpr glm::ivec3 kListGroup{64, 1, 1};
// Turns of all loops of an invocation together: software drivers cut them off, without a word, at 65535.
constexpr int kLoopLimit = 60000;
constexpr std::uint32_t kFan = 16;                                 // kFan in sum_tree.glsl
constexpr std::size_t kSurfaceLightBytes = 3 * sizeof(glm::vec4);  // SurfaceLight in shaders/common/rsm.glsl

class RenderPass : public Pass {
  Param<int> size{this, "size", 256, {8, 4096}, "texels along a side of the view of a light without extent"};
  Param<int> areaSamples{
      this, "area_samples", 16, {1, 1024}, "point samples that stand for all emissive triangles together"};
  Param<int> areaSize{
      this, "area_size", 64, {8, 2048}, "texels along a side of each cube face of an area sample"};
  Out<ReflectiveShadowMap> map{this, "map", "what each light sees: position, normal, area, reflected flux"};

  Reads readsFrom() const override { return Reads::geometry | Reads::materials | Reads::lights; }
  Needs needs() const override { return Needs::anyLight; }

  void run(PassContext& frame) override {
    // One array holds all layers, so that they share one size: that of the lights without extent where there
    // are some.
    const bool onlyArea = frame.snapshot().lights.empty();
    const int side = onlyArea ? static_cast<int>(areaSize) : static_cast<int>(size);
    const LightSet set = sampleLights(frame.sceneDescription(), frame.snapshot(), areaSamples, side);

    ReflectiveShadowMap result;
    result.lightCount = static_cast<int>(set.samples.size());
    result.layerCount = static_cast<int>(set.views.size());
    std::vector<LightSampleData> samples = set.samples;
    std::vector<glm::mat4> matrices;
    for (const LightView& view : set.views) matrices.push_back(view.worldToClip);
    if (samples.empty()) samples.emplace_back();
    if (matrices.empty()) matrices.emplace_back(1.0f);
    result.lights = frame.buffer(samples.size() * sizeof(LightSampleData), "light samples");
    result.views = frame.buffer(matrices.size() * sizeof(glm::mat4), "light views");
    result.lights->upload(std::as_bytes(std::span(samples)));
    result.views->upload(std::as_bytes(std::span(matrices)));

    gpu::TextureDescription layers;
    layers.kind = gpu::TextureKind::d2Array;
    layers.width = layers.height = side;
    layers.depth = std::max(result.layerCount, 1);
    layers.format = gpu::Format::rgba32f;
    result.position = frame.texture(layers, "positions");
    result.normal = frame.texture(layers, "normals and areas");
    result.flux = frame.texture(layers, "reflected flux");
    gpu::TextureDescription depth = layers;
    depth.format = gpu::Format::depth32f;
    depth.kind = gpu::TextureKind::d2;
    depth.depth = 1;
    const gpu::TextureRef depthTexture = frame.texture(depth, "depth");
    if (set.samples.empty()) {
      for (const gpu::TextureRef& texture : {result.position, result.normal, result.flux})
        texture->clear(glm::vec4(0.0f));
    }
    for (std::size_t light = 0; light < set.samples.size(); ++light) {
      const int first = static_cast<int>(set.samples[light].directionLayer.w);
      const int views = static_cast<int>(set.samples[light].power.w);
      for (int layer = first; layer < first + views; ++layer)
        drawLayer(frame, result, *depthTexture, set.views[static_cast<std::size_t>(layer)],
                  static_cast<int>(light), layer);
    }
    map = result;
  }

  static void drawLayer(PassContext& frame, const ReflectiveShadowMap& result, const gpu::Texture& depth,
                        const LightView& view, int light, int layer) {
    GpuScene& scene = frame.scene();
    gpu::RenderTargets targets;
    for (const gpu::TextureRef& texture : {result.position, result.normal, result.flux})
      targets.colours.push_back({texture.get(), layer});
    targets.depth = &depth;
    gpu::RasterState state;
    state.depthTest = state.depthWrite = state.depthClamp = true;
    const renderShader::View block{view.worldToClip, light,
                                   0.5f * static_cast<float>(result.flux->description().width)};
    const bool keep = frame.keepsEverything();
    const gpu::Drawing drawing = frame.device().drawTo(targets, state);
    const std::size_t count = view.used ? scene.draws().size() : 0;
    for (std::size_t i = 0; i < count; ++i) {
      const SceneDraw& draw = scene.draws()[i];
      renderShader::Variant variant;
      variant.textures = keep || draw.diffuseTexture != nullptr;
      variant.masks = keep || draw.maskTexture != nullptr;
      const gpu::Texture& diffuse =
          draw.diffuseTexture != nullptr ? *draw.diffuseTexture : scene.whiteTexture();
      const gpu::Texture& mask = draw.maskTexture != nullptr ? *draw.maskTexture : scene.whiteTexture();
      frame.shaders().drawIndexed(
          frame.program(renderShader::kProgram, variant.key()),
          {renderShader::positions(scene.positions()), renderShader::normals(scene.normals()),
           renderShader::texcoords(scene.texcoords()), renderShader::objects(scene.objects()),
           renderShader::materials(scene.materials()), renderShader::lights(*result.lights),
           renderShader::view(block), renderShader::draw({draw.object, draw.material}),
           renderShader::diffuseTexture(diffuse, gpu::Sampling::linearMipsRepeat),
           renderShader::maskTexture(mask, gpu::Sampling::linearMipsRepeat)},
          scene.indices(), draw.firstIndex, draw.indexCount);
    }
  }
};

/// One over the sum of the printed weights, the squares of the pattern's distances (gather.comp).
float publishedScale(int samples) {
  double sum = 0.0;
  for (int i = 0; i < samples; ++i) {
    double whole = 0.0;
    const double distance = std::modf(0.5 + 0.7548776662466927 * (i + 1), &whole);
    sum += distance * distance;
  }
  return static_cast<float>(1.0 / sum);
}

class GatherPass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<ReflectiveShadowMap> map{this, "map", Presence::optional,
                              "what the lights see; without it there is no indirect light"};
  Param<std::string> method{
      this,
      "method",
      "flux",
      {"flux", "projected", "all"},
      "texels in proportion to their flux, or, as published, around the projection of the surface point into each light's view, or all of them: exact and slow"};
  Param<int> samples{this,
                     "samples",
                     400,
                     {1, kLoopLimit},
                     "texels that are gathered, with 'projected' shared among the lights; unused with 'all'"};
  Param<float> reach{
      this,
      "reach",
      1.0f,
      {0.01f, 1.0f},
      "",
      "with 'projected': radius of the pattern as a share of the half turn around a light, or of the width of the view of a directional light, with 'published' of a spot light too"};
  Param<std::string> weights{
      this,
      "weights",
      "exact",
      {"exact", "published"},
      "with 'projected': weight of a sample by the density of the pattern, or the printed square of its distance over the sum of these squares"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "indirect light reflected by the diffuse lobe, without occlusion, W/(sr m^2)"};

  void run(PassContext& frame) override {
    Image result{frame.image(gpu::Format::rgba32f, "indirect diffuse radiance")};
    gatherShader::Parameters parameters{};
    using gpu::Sampling;
    std::vector<gpu::ResourceBinding> bindings{gatherShader::gPosition(*gbuffer->position, Sampling::nearest),
                                               gatherShader::gNormal(*gbuffer->normal, Sampling::nearest),
                                               gatherShader::gDiffuse(*gbuffer->diffuse, Sampling::nearest),
                                               gatherShader::diffuseImage(*result.texture)};
    if (!map.present() || map->lightCount == 0) {
      result.texture->clear(glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
      diffuse = result;
      return;
    }
    parameters.width = map->flux->description().width;
    parameters.lightCount = map->lightCount;
    parameters.samples = samples;
    parameters.reach = reach;
    gatherShader::Variant variant;
    gpu::BufferRef chosen;
    if (method == "flux") {
      variant.method = gatherShader::Variant::methodChosen;
      chosen = choose(frame, parameters.width, map->layerCount);
      bindings.push_back(gatherShader::chosen(*chosen));
    } else {
      variant.method =
          method == "all" ? gatherShader::Variant::methodAll : gatherShader::Variant::methodProjected;
      bindings.push_back(gatherShader::rsmPosition(*map->position, Sampling::nearest));
      bindings.push_back(gatherShader::rsmNormal(*map->normal, Sampling::nearest));
      bindings.push_back(gatherShader::rsmFlux(*map->flux, Sampling::nearest));
      bindings.push_back(gatherShader::lights(*map->lights));
      bindings.push_back(gatherShader::views(*map->views));
      parameters.samples = std::max(samples / map->lightCount, 1);
      parameters.publishedScale = weights == "published" ? publishedScale(parameters.samples) : 0.0f;
    }
    const auto add = [&] {
      std::vector<gpu::ResourceBinding> all = bindings;
      all.push_back(gatherShader::parameters(parameters));
      frame.dispatch(frame.program(gatherShader::kProgram, variant.key()), all,
                     {frame.snapshot().camera.width, frame.snapshot().camera.height, 1}, kImageGroup);
    };
    if (method == "all") {
      result.texture->clear(glm::vec4(0.0f));
      const int rows = parameters.width * map->layerCount, atOnce = kLoopLimit / (parameters.width + 1);
      for (parameters.firstRow = 0; parameters.firstRow < rows; parameters.firstRow += atOnce) {
        parameters.rows = std::min(atOnce, rows - parameters.firstRow);
        add();
      }
    } else {
      add();
    }
    diffuse = result;
  }

  /// Texels in proportion to their flux, as SurfaceLight, by a tree of sums (sum_tree.glsl).
  gpu::BufferRef choose(PassContext& frame, int width, int layers) {
    const auto count = static_cast<std::uint32_t>(static_cast<int>(samples));
    const auto side = static_cast<std::uint32_t>(width);
    // From the texels to the root.
    std::vector<std::uint32_t> sizes{side * side * static_cast<std::uint32_t>(layers)};
    std::uint32_t total = 0;
    do {
      sizes.push_back((sizes.back() + kFan - 1) / kFan);
      total += sizes.back();
    } while (sizes.back() > 1);
    const gpu::BufferRef tree = frame.buffer(total * sizeof(float), "sums of flux");
    const gpu::BufferRef chosen = frame.buffer(count * kSurfaceLightBytes, "chosen texels");
    using gpu::Sampling;
    std::uint32_t firstOfAddends = 0, firstOfSums = total;
    for (std::size_t level = 1; level < sizes.size(); ++level) {
      firstOfSums -= sizes[level];
      accumulateShader::Variant variant;
      variant.of = level == 1 ? accumulateShader::Variant::ofTexels : accumulateShader::Variant::ofSums;
      frame.dispatch(
          frame.program(accumulateShader::kProgram, variant.key()),
          {accumulateShader::parameters({sizes[level - 1], side, firstOfAddends, firstOfSums}),
           accumulateShader::rsmFlux(*map->flux, Sampling::nearest), accumulateShader::tree(*tree)},
          listItems(sizes[level], kListGroup.x), kListGroup);
      firstOfAddends = firstOfSums;
    }
    const auto levels = static_cast<std::uint32_t>(sizes.size() - 1);
    frame.dispatch(frame.program(chooseShader::kProgram),
                   {chooseShader::parameters({sizes.front(), side, levels, count}),
                    chooseShader::rsmPosition(*map->position, Sampling::nearest),
                    chooseShader::rsmNormal(*map->normal, Sampling::nearest),
                    chooseShader::rsmFlux(*map->flux, Sampling::nearest), chooseShader::tree(*tree),
                    chooseShader::chosen(*chosen)},
                   {static_cast<int>(count), 1, 1}, kListGroup);
    return chosen;
  }
};

}  // namespace
}  // namespace lumivox::reflective_shadow_maps

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::reflective_shadow_maps;
  registry.describe("Reflective shadow maps: what each light sees as a source of one-bounce light",
                    "Dachsbacher & Stamminger 2005; thesis Gomes 2015, Sec. 2.2");
  registry.add<RenderPass>(
      "render",
      "Position, normal and reflected flux as seen from each light (Dachsbacher & Stamminger 2005, Sec. 4.1)");
  registry.add<GatherPass>(
      "gather", "One bounce from texels of the map, unoccluded (Dachsbacher & Stamminger 2005, Sec. 3.2)");
}

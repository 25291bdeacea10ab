// Reflective shadow maps: Dachsbacher & Stamminger 2005, "Reflective shadow maps"; thesis Gomes 2015,
// Sec. 2.2. What every light sees, as a source of one-bounce light, and gathering from it without visibility.
#include <algorithm>
#include <cmath>

#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/light_views.h"
#include "lumivox/toolkit/loop_limit.h"
#include "reflective_shadow_maps_shaders.h"

namespace lumivox::reflective_shadow_maps {
namespace {

using namespace shaders::reflective_shadow_maps;

constexpr std::uint32_t kFan = 16;  // kFan in sum_tree.glsl

class RenderPass : public LightViewPass {
 public:
  RenderPass() : LightViewPass(256, within(8, 4096), 64, within(8, 2048)) {}

 private:
  Out<ReflectiveShadowMap> map{this, "map", "what each light sees: position, normal, area, reflected flux"};

  void run(PassContext& frame) override {
    const LightViews views = placed(frame);
    const auto layers = [&](const char* label) { return views.layers(frame, gpu::Format::rgba32f, label); };
    const ReflectiveShadowMap result{views.lights,
                                     views.views,
                                     layers("positions"),
                                     layers("normals and areas"),
                                     layers("reflected flux"),
                                     views.lightCount(),
                                     views.layerCount()};
    const std::array<gpu::TextureRef, 3> colours{result.position, result.normal, result.flux};
    if (result.lightCount == 0)
      for (const gpu::TextureRef& texture : colours) texture->clear(glm::vec4(0.0f));
    const gpu::TextureRef depth =
        frame.texture({gpu::TextureKind::d2, gpu::Format::depth32f, views.side, views.side, 1, 1}, "depth");
    const gpu::RasterState state{.depthTest = true, .depthWrite = true, .depthClamp = true};
    const auto targets = [&](int layer) {
      gpu::RenderTargets one{.depth = depth.get()};
      for (const gpu::TextureRef& texture : colours) one.colours.push_back({texture.get(), layer});
      return one;
    };
    drawLightViews(frame, views, state, targets, [&](const LightViewDrawn& drawn, const SceneDraw& draw) {
      drawPart(frame, draw, render::Variant{},
               {render::lights(result.lights),
                render::view({drawn.view.worldToClip, drawn.light, 0.5f * static_cast<float>(views.side)})});
    });
    map = result;
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
  enum class Method { flux, projected, all };
  enum class Weights { exact, published };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<ReflectiveShadowMap> map{this, "map", Presence::optional,
                              "what the lights see; without it there is no indirect light"};
  Param<Method> method{
      this, "method", Method::flux,
      "texels in proportion to their flux, or, as published, around the projection of the surface point into each light's view, or all of them: exact and slow"};
  Param<int> samples{this, "samples", 400, within(1, kLoopLimit),
                     "texels that are gathered, with 'projected' shared among the lights; unused with 'all'"};
  Param<float> reach{
      this, "reach", 1.0f, within(0.01f, 1.0f),
      "with 'projected': radius of the pattern as a share of the half turn around a light, or of the width of the view of a directional light, with 'published' of a spot light too"};
  Param<Weights> weights{
      this, "weights", Weights::exact,
      "with 'projected': weight of a sample by the density of the pattern, or the printed square of its distance over the sum of these squares"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "indirect light reflected by the diffuse lobe, without occlusion, W/(sr m^2)"};

  void run(PassContext& frame) override {
    diffuse = Image{frame.image("indirect diffuse radiance")};
    if (!map.present() || map->lightCount == 0) {
      diffuse->texture->clear(glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
      return;
    }
    gather::Parameters parameters{.width = map->flux->description().width,
                                  .samples = samples,
                                  .lightCount = map->lightCount,
                                  .reach = reach};
    gather::Variant variant;
    gpu::BufferRef chosen;
    if (method == Method::flux) {
      variant.method = gather::Variant::methodChosen;
      chosen = choose(frame, parameters.width, map->layerCount);
    } else {
      variant.method = method == Method::all ? gather::Variant::methodAll : gather::Variant::methodProjected;
      parameters.samples = std::max(samples / map->lightCount, 1);
      parameters.publishedScale = weights == Weights::published ? publishedScale(parameters.samples) : 0.0f;
    }
    const auto add = [&] {
      frame.dispatch(
          frame.program(variant),
          {gather::parameters(parameters), GBufferBinding(*gbuffer), ReflectiveShadowMapBinding(*map),
           gather::chosen(chosen), gather::diffuseImage(diffuse->texture)},
          pixels(frame));
    };
    if (method != Method::all) return add();
    diffuse->texture->clear(glm::vec4(0.0f));
    forEachPortion(parameters.width * map->layerCount, parameters.width, [&](int first, int count) {
      parameters.firstRow = first;
      parameters.rows = count;
      add();
    });
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
    const gpu::BufferRef tree = frame.elements(choose::tree, total, "sums of flux");
    const gpu::BufferRef chosen = frame.elements(choose::chosen, count, "chosen texels");
    const ReflectiveShadowMapBinding texels(*map);
    std::uint32_t firstOfAddends = 0, firstOfSums = total;
    for (std::size_t level = 1; level < sizes.size(); ++level) {
      firstOfSums -= sizes[level];
      using Variant = accumulate::Variant;
      const Variant variant{level == 1 ? Variant::ofTexels : Variant::ofSums};
      frame.dispatchList(frame.program(variant),
                         {accumulate::parameters({sizes[level - 1], side, firstOfAddends, firstOfSums}),
                          texels, accumulate::tree(tree)},
                         sizes[level]);
      firstOfAddends = firstOfSums;
    }
    const auto levels = static_cast<std::uint32_t>(sizes.size() - 1);
    frame.dispatchList(frame.program(choose::kProgram),
                       {choose::parameters({sizes.front(), side, levels, count}), texels, choose::tree(tree),
                        choose::chosen(chosen)},
                       count);
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

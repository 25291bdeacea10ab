// Reflective shadow maps: Dachsbacher & Stamminger 2005, "Reflective shadow maps"; thesis Gomes 2015, Sec.
// 2.2. Every light's view is a source of one-bounce light, which is gathered without visibility.
#include <algorithm>
#include <cmath>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/light_views.h"
#include "lumivox/toolkit/loop_limit.h"
#include "passes.h"
#include "reflective_shadow_maps_shaders.h"

namespace lumivox::reflective_shadow_maps {
namespace {

using namespace shaders::reflective_shadow_maps;

class RenderPass : public LightViewPass {
 public:
  RenderPass() : LightViewPass(256, within(8, 4096), 64, within(8, 2048)) {}

 private:
  enum class Lobes { directional, diffuse, none };

  Param<Lobes> lobes{
      this, "lobes", Lobes::diffuse,
      "what Phong lobes of the seen surfaces add to the flux of 'map'; diffuse: all that they reflect, as if it left to all sides; directional: the same, and the lobes beside it, by which choose and near_field_voxels.gather turn it in its direction; none: nothing. 'surfaces' has the flux of 'none', since paths reflect by the lobes themselves",
      published(Lobes::none)};
  Out<ReflectiveShadowMap> map{this, "map", "what each light sees: position, normal, area, reflected flux"};
  Out<ReflectiveShadowMap> surfaces{
      this, "surfaces", "the same map with the albedo and the Phong lobe of what each light sees"};

  void run(PassContext& frame) override {
    const LightViews views = placed(frame);
    const auto layers = [&](const char* label) { return views.layers(frame, gpu::Format::rgba32f, label); };
    ReflectiveShadowMap result{.lights = views.lights,
                               .views = views.views,
                               .position = layers("positions"),
                               .normal = layers("normals and areas"),
                               .flux = layers("reflected flux"),
                               .lightCount = views.lightCount(),
                               .layerCount = views.layerCount()};
    std::vector<gpu::TextureRef> colours{result.position, result.normal, result.flux};
    const bool glossy = frame.traits().glossy, own = surfaces.wanted(), turns = lobes == Lobes::directional;
    const render::Variant variant{.surfaces = own,
                                  .glossy = glossy && (own || turns),
                                  .lobes = glossy && map.wanted() && lobes != Lobes::none};
    const auto add = [&](const char* label) { return colours.emplace_back(layers(label)); };
    // Each output is what it is without the other: the flux of paths is diffuse alone.
    ReflectiveShadowMap ofPaths = result;
    if (own) ofPaths.albedo = add("albedos of what lights see");
    if (variant.glossy) ofPaths.specular = add("Phong lobes of what lights see");
    if (own && variant.lobes) ofPaths.flux = add("diffusely reflected flux");
    if (turns) result.specular = ofPaths.specular;
    map = result;
    if (own) surfaces = ofPaths;
    if (result.lightCount == 0)
      for (const gpu::TextureRef& texture : colours) texture->clear(glm::vec4(0.0f));
    const gpu::TextureRef depth =
        frame.texture({gpu::TextureKind::d2, gpu::Format::depth32f, views.side, views.side, 1, 1}, "depth");
    const gpu::RasterState state{.depthTest = true, .depthWrite = true};
    const auto targets = [&](int layer) {
      gpu::RenderTargets one{.depth = depth.get()};
      for (const gpu::TextureRef& texture : colours) one.colours.push_back({texture.get(), layer});
      return one;
    };
    drawLightViews(frame, views, state, targets, [&](const LightViewDrawn& drawn, const SceneDraw& draw) {
      drawPart(frame, draw, variant,
               {render::lights(result.lights),
                render::view({drawn.view.worldToClip, drawn.light, 0.5f * static_cast<float>(views.side)})});
    });
  }
};

/// Reciprocal of the sum of the printed weights, the squares of the pattern's distances (gather.comp).
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
  enum class Method { lights, projected, all };
  enum class Weights { exact, published };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<SurfaceLights> lights{
      this, "lights", Presence::optional,
      "with 'lights': lights to gather from, by choose; without it there is no indirect light"};
  In<ReflectiveShadowMap> map{
      this, "map", Presence::optional,
      "with 'projected' and 'all': what the lights see; without it there is no indirect light"};
  Param<Method> method{
      this, "method", Method::lights,
      "what is gathered; lights: all of 'lights'; projected: texels of 'map' around the projection of the surface point into each light's view; all: all texels of 'map', exact and slow",
      published(Method::projected)};
  Param<int> samples{this, "samples", 400, within(1, kLoopLimit),
                     "with 'projected': number of gathered texels, shared among the lights"};
  Param<float> reach{
      this, "reach", 1.0f, within(0.01f, 1.0f),
      "with 'projected': radius of the sampling pattern, as a share of the half turn around a light, or of the width of a directional light's view (with 'weights published' of a spot light's view too)"};
  Param<Weights> weights{
      this, "weights", Weights::exact,
      "with 'projected': weight of a sample; exact: by the density of the pattern; published: its squared distance over the sum of the squared distances",
      published(Weights::published)};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "indirect light reflected by the diffuse lobe, without occlusion, W/(sr m^2)"};

  bool uses(const InBase& input) const override {
    if (&input == &lights) return method == Method::lights;
    return &input != &map || method != Method::lights;
  }

  void run(PassContext& frame) override {
    diffuse = Image{frame.image("indirect diffuse radiance")};
    const bool dark = method == Method::lights ? !lights.present() || lights->count == 0
                                               : !map.present() || map->lightCount == 0;
    if (dark) {
      diffuse->texture->clear(glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
      return;
    }
    gather::Parameters parameters{};
    const auto add = [&](int axis, const shader::BindingSet& from) {
      const bool glossy = axis == gather::Variant::methodLights && frame.traits().glossy;
      frame.dispatch(frame.program(gather::Variant{axis, glossy}),
                     {gather::parameters(parameters), GBufferBinding(*gbuffer), from,
                      gather::diffuseImage(diffuse->texture)},
                     pixels(frame));
    };
    const auto addAll = [&](int items, int turns, int axis, const shader::BindingSet& from) {
      forEachPortion(items, turns, [&](int first, int count) {
        parameters.first = first;
        parameters.count = count;
        add(axis, from);
      });
    };
    using Variant = gather::Variant;
    if (method == Method::lights)
      return addAll(lights->count, 0, Variant::methodLights, {gather::taken(lights->lights)});
    parameters.width = map->flux->description().width;
    if (method == Method::projected && map->captured)
      throw Error(
          "'method projected' of a map without views of lights, such as a captured one; expected lights or all");
    const ReflectiveShadowMapBinding texels(*map);
    if (method == Method::all)
      return addAll(map->flux->description().height * map->layerCount, parameters.width, Variant::methodAll,
                    texels);
    parameters.lightCount = map->lightCount;
    parameters.samples = std::max(samples / map->lightCount, 1);
    parameters.reach = reach;
    parameters.publishedScale = weights == Weights::published ? publishedScale(parameters.samples) : 0.0f;
    add(Variant::methodProjected, texels);
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
  addChoose(registry);
  registry.add<GatherPass>(
      "gather", "One bounce from texels of the map, unoccluded (Dachsbacher & Stamminger 2005, Sec. 3.2)");
}

// Light from element to element (Dong et al. 2007, Sec. 4.3; steps 8 to 11 of Algorithm 1).
#include <algorithm>
#include <utility>

#include "light.h"
#include "passes.h"

namespace lumivox::implicit_visibility {

using namespace shaders::implicit_visibility;

NodeBinding::NodeBinding(const SurfaceElements& elements, int bins) {
  add(shader::UniformSlot<pull_up::Nodes>{"Nodes"}(
      {elements.leafCount, elements.firstGroup, 6 * bins * bins}));
  add(shader::SampledSlot{"elementPosition"}(elements.position, gpu::Sampling::nearest));
  add(shader::SampledSlot{"elementNormal"}(elements.normal, gpu::Sampling::nearest));
}

LinkBinding::LinkBinding(const ElementLinks& links) {
  add(shader::StorageSlot{"Directions"}(links.directions));
  add(shader::StorageSlot{"First"}(links.first));
  add(shader::StorageSlot{"Links"}(links.links));
}

gpu::TextureRef emptyTexels(PassContext& frame, int texels, const std::string& label) {
  const glm::ivec2 size = SurfaceElements::sizeFor(texels);
  gpu::TextureRef result =
      frame.texture({.format = gpu::Format::rgba32f, .width = size.x, .height = size.y}, label);
  result->clear(glm::vec4(0.0f));
  return result;
}

namespace {

constexpr std::uint64_t kTogether = 8;  // invocations that share the links of a leaf, as in illuminate.comp

class IlluminatePass : public Pass {
  enum class Weight { bin, element };
  enum class AreaLight { shadow, links };

  In<SurfaceElements> elements{this, "elements", "what is lit"};
  In<ElementLinks> links{this, "links", "what leaves see, of push_links"};
  In<ShadowMap> shadow{this, "shadow", Presence::optional, "lights and their visibility", Needs::anyLight};
  Param<int> bounces{this, "bounces", 1, within(1, 4096),
                     "times that light is reflected before the surface that is seen, or comes from the "
                     "environment"};
  Param<Weight> weight{this, "weight", Weight::bin,
                       "of a link; bin: the projected solid angle of its bin, those of a side being pi; "
                       "element: A cos cos / r^2 of the element (published)"};
  Param<AreaLight> areaLight{this, "area_light", AreaLight::shadow,
                             "what brings the light of surfaces that shine; shadow: samples with shadow "
                             "maps; links: links to elements that shine (published)"};
  Param<int> lightSamples{
      this, "light_samples", 4, within(1, 32),
      "points along a side of an element at which lights and their visibility are asked for"};
  Param<bool> lightLists{
      this, "light_lists", true,
      "with 'area_light links': only links to what shines are looked at; off: all: the same "
      "bits"};
  Param<bool> asPublished{this, "as_published", false,
                          "'weight element', 'area_light links' and 'light_samples 1'"};
  Out<ElementLight> light{this, "light", Contributes::nothing, Needs::anyLight,
                          "light at elements, on both sides"};

  Reads readsFrom() const override { return Reads::environment; }
  int indirectBounces() const override { return bounces; }

  bool weighsElements() const { return asPublished || weight == Weight::element; }
  bool linksToLights() const { return asPublished || areaLight == AreaLight::links; }

  void run(PassContext& frame) override {
    ElementLight result;
    const int texels = ElementLight::radianceTexels(*elements), leafTexels = 2 * elements->leafCount;
    result.irradiance = emptyTexels(frame, leafTexels, "irradiance of elements");
    result.radiance = emptyTexels(frame, texels, "radiance of elements");
    if (linksToLights() && elements->emission != nullptr) {
      result.emission = emptyTexels(frame, texels, "emission of elements");
      result.directIrradiance = emptyTexels(frame, leafTexels, "irradiance of elements by what shines");
    }
    if (elements->leafCount > 0) illuminate(frame, result);
    light = result;
  }

  void illuminate(PassContext& frame, const ElementLight& result) {
    const shader::BindingSet common{NodeBinding(*elements, links->bins), LinkBinding(*links)};
    if (result.emission) gatherEmission(frame, common, result);
    const int texels = ElementLight::radianceTexels(*elements);
    gpu::TextureRef sent = emptyTexels(frame, texels, "radiance to be sent"),
                    next = bounces > 1 ? emptyTexels(frame, texels, "radiance of the next bounce") : sent;
    lightLeaves(frame, common, result, sent);
    pullUp(frame, common, sent, result.radiance, false);
    for (int bounce = 0; bounce < bounces; ++bounce) {
      const bool last = bounce + 1 == bounces, sky = bounce == 0 && frame.traits().environment;
      gather(frame, common, {.environment = sky}, {.adds = bounce > 0, .reflects = !last}, sent,
             result.irradiance, next, result.radiance);
      if (last) break;
      pullUp(frame, common, next, result.radiance, true);
      std::swap(sent, next);
    }
  }

  /// What shines, over the short lists of links to it (Sec. 4.3.1).
  void gatherEmission(PassContext& frame, const shader::BindingSet& common, const ElementLight& result) {
    using Variant = light_leaves::Variant;
    frame.dispatchList(frame.program(Variant{.of = Variant::ofEmitted}),
                       {common, light_leaves::emissions(elements->emission, gpu::Sampling::nearest),
                        light_leaves::reflectedImage(result.emission)},
                       static_cast<std::uint64_t>(elements->leafCount));
    pullUp(frame, common, result.emission, nullptr, false);
    gather(frame, common, {.listed = lightLists}, {.adds = false, .reflects = false}, result.emission,
           result.directIrradiance, result.radiance, result.radiance);
  }

  void lightLeaves(PassContext& frame, const shader::BindingSet& common, const ElementLight& result,
                   const gpu::TextureRef& sent) {
    const LightBinding lights(shadow);
    // Lights without extent come first; what shines comes by links or by its samples, never by both.
    const auto withoutExtent = static_cast<int>(frame.sceneDescription().lights.size());
    const int count = linksToLights() ? std::min(lights.count, withoutExtent) : lights.count;
    const bool lit = shadow.present() && count > 0;
    frame.dispatchList(frame.program(
                           light_leaves::Variant{
                               .lights = lit, .shadows = lit, .linked = result.directIrradiance != nullptr},
                           light_leaves::Constants{.samplesPerSide = asPublished ? 1 : int(lightSamples)}),
                       {common, lights, light_leaves::directLight({count}),
                        light_leaves::albedos(elements->albedo, gpu::Sampling::nearest),
                        light_leaves::arrivingFromLights(result.directIrradiance, gpu::Sampling::nearest),
                        light_leaves::reflectedImage(sent), light_leaves::radianceImage(result.radiance)},
                       static_cast<std::uint64_t>(elements->leafCount));
  }

  void gather(PassContext& frame, const shader::BindingSet& common, illuminate::Variant variant,
              const illuminate::Constants& constants, const gpu::TextureRef& sent,
              const gpu::TextureRef& irradiance, const gpu::TextureRef& reflected,
              const gpu::TextureRef& radiance) {
    variant.weight = weighsElements() ? illuminate::Variant::weightElement : illuminate::Variant::weightBin;
    shader::BindingSet bound{common,
                             illuminate::illumination({frame.sceneDescription().environment}),
                             illuminate::lights(links->lights),
                             illuminate::sentRadiance(sent, gpu::Sampling::nearest),
                             illuminate::albedos(elements->albedo, gpu::Sampling::nearest),
                             illuminate::irradianceImage(irradiance),
                             illuminate::reflectedImage(reflected),
                             illuminate::radianceImage(radiance)};
    if (weighsElements()) bound.add(illuminate::counts(linksToSameNode(frame)));
    frame.dispatchList(frame.program(variant, constants), bound,
                       kTogether * static_cast<std::uint64_t>(elements->leafCount));
  }

  /// For each link how many of its leaf's lead to the same node, which counts once.
  const gpu::BufferRef& linksToSameNode(PassContext& frame) const {
    return frame.kept("how often elements are seen", links->seen, [&] {
      const ElementLists<ElementLink>& seen = *links->seen;
      std::vector<std::uint32_t> ofNode(static_cast<std::size_t>(elements->nodeCount), 0),
          counts(seen.values.size());
      for (std::size_t leaf = 0; leaf < seen.size(); ++leaf) {
        for (const ElementLink& link : seen[leaf]) ++ofNode[link.node];
        for (std::uint64_t i = seen.first[leaf]; i < seen.first[leaf + 1]; ++i)
          counts[i] = ofNode[seen.values[i].node];
        for (const ElementLink& link : seen[leaf]) ofNode[link.node] = 0;
      }
      return frame.uploaded(counts, "how often elements are seen");
    });
  }

  /// Level by level from the leaves on; `sum`, which may be null, holds all bounces.
  void pullUp(PassContext& frame, const shader::BindingSet& common, const gpu::TextureRef& radiance,
              const gpu::TextureRef& sum, bool adds) {
    const shader::BoundProgram& program =
        frame.program(pull_up::Variant{.sums = sum != nullptr}, pull_up::Constants{.adds = adds});
    for (const ElementTree::Run& run : elements->tree->levels) {
      if (run.count == 0 || run.first < static_cast<std::uint32_t>(elements->leafCount)) continue;
      frame.dispatchList(program,
                         {common, pull_up::run({static_cast<int>(run.first), static_cast<int>(run.count)}),
                          pull_up::children(elements->children), pull_up::reflectedImage(radiance),
                          pull_up::radianceImage(sum)},
                         run.count);
    }
  }
};

}  // namespace

void addIlluminate(TechniqueRegistry& registry) {
  registry.add<IlluminatePass>(
      "illuminate",
      "Light that elements gather over their links, bounce by bounce (Dong et al. 2007, Sec. 4.3)");
}

}  // namespace lumivox::implicit_visibility

// Transports light from element to element (Dong et al. 2007, Sec. 4.3; steps 8 to 11 of Algorithm 1).
#include <algorithm>
#include <utility>

#include "../passes.h"
#include "light.h"
#include "lumivox/toolkit/environment.h"
#include "outgoing.h"

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
constexpr std::uint64_t kDirectionsTogether =
    32;  // directions of a leaf in a group, as in reflect_glossy.comp

class IlluminatePass : public Pass {
  enum class Weight { bin, element };
  enum class AreaLight { shadow, links };

  In<SurfaceElements> elements{this, "elements", "what is lit"};
  In<ElementLinks> links{this, "links", "visible elements of each leaf, from push_links"};
  In<ShadowMap> shadow{this, "shadow", Presence::optional, "lights and their visibility", Needs::anyLight};
  In<ElementLight> before{
      this, "before", Presence::history,
      "light of the frame before: elements reflect what arrived then beside direct light, so that frames in a row come to all bounces; 'bounces' counts those of the first frame"};
  Param<int> bounces{
      this, "bounces", 1, within(1, 4096),
      "number of reflections before the visible surface; light from the environment counts as the first"};
  Param<Weight> weight{
      this, "weight", Weight::bin,
      "weight of a link; bin: the projected solid angle of its bin, pi for all bins of a side; element: A cos cos / r^2 of the element",
      published(Weight::element)};
  Param<AreaLight> areaLight{
      this, "area_light", AreaLight::shadow,
      "transport of light from emissive surfaces; shadow: point samples with shadow maps; links: links to emissive elements",
      published(AreaLight::links)};
  Param<int> lightSamples{
      this,
      "light_samples",
      4,
      within(1, 32),
      "points along a side of an element at which direct light and its visibility are evaluated",
      published(1)};
  Param<bool> lightLists{
      this, "light_lists", true,
      "with 'area_light links': visit only links to emissive elements; off: visit all links, with the same bits"};
  Param<int> directions{
      this,
      "directions",
      4,
      within(0, 16),
      "directions along a side of a face of the cube into which glossy elements reflect light by their Phong lobes; 0: they reflect diffuse light alone, as in the published results (Sec. 5)",
      published(0)};
  Out<ElementLight> light{this, "light", Contributes::nothing, Needs::anyLight,
                          "light at elements, on both sides"};

  Reads readsFrom() const override { return Reads::environment; }
  int indirectBounces() const override { return bounces; }

  bool weighsElements() const { return weight == Weight::element; }
  bool linksToLights() const { return areaLight == AreaLight::links; }

  void run(PassContext& frame) override {
    ElementLight result;
    const int texels = ElementLight::radianceTexels(*elements), leafTexels = 2 * elements->leafCount;
    result.irradiance = emptyTexels(frame, leafTexels, "irradiance of elements");
    result.radiance = emptyTexels(frame, texels, "radiance of elements");
    if (linksToLights() && elements->emission != nullptr) {
      result.emission = emptyTexels(frame, texels, "emission of elements");
      result.directIrradiance = emptyTexels(frame, leafTexels, "irradiance of elements by what shines");
    }
    std::shared_ptr<const OutgoingRows> rows;
    if (directions > 0 && elements->specular != nullptr) {
      rows = frame.kept("rows of glossy elements", elements->tree,
                        [&] { return outgoingRows(frame, *elements->tree); });
      result.outgoing =
          emptyTexels(frame, outgoingTexels(*rows, directions), "radiance of glossy elements by direction");
      result.outgoingRows = rows->ofNodes;
      result.directions = directions;
    }
    if (elements->leafCount > 0) illuminate(frame, result, rows.get());
    light = result;
  }

  /// What nodes send in a bounce. `outgoing` is null where no glossy surface passes light on.
  struct Sent {
    gpu::TextureRef radiance, outgoing;
  };
  Sent empty(PassContext& frame, const OutgoingRows* rows, const std::string& what) const {
    Sent sent{emptyTexels(frame, ElementLight::radianceTexels(*elements), what), nullptr};
    if (rows != nullptr)
      sent.outgoing = emptyTexels(frame, outgoingTexels(*rows, directions), what + " by direction");
    return sent;
  }

  /// The light of the frame before, if it is that of these elements; else null. Deforming elements keep their
  /// numbers.
  const ElementLight* lightBefore(const ElementLight& result) const {
    const auto alike = [](const gpu::TextureRef& a, const gpu::TextureRef& b) {
      return (a == nullptr) == (b == nullptr) && (a == nullptr || a->description() == b->description());
    };
    return before.present() && alike(before->irradiance, result.irradiance) &&
                   alike(before->radiance, result.radiance) && alike(before->outgoing, result.outgoing)
               ? &*before
               : nullptr;
  }

  /// After a frame with n reflections one gathering gives n + 1: what arrived then is reflected with the
  /// direct light, and no bounce counts twice.
  void illuminate(PassContext& frame, const ElementLight& result, const OutgoingRows* rows) {
    const shader::BindingSet common{NodeBinding(*elements, links->bins), LinkBinding(*links)};
    const ElementLight* const earlier = lightBefore(result);
    const int count = earlier != nullptr ? 1 : int(bounces);
    if (result.emission) gatherEmission(frame, common, result);
    Sent sent = empty(frame, rows, "radiance to be sent"),
         next = count > 1 ? empty(frame, rows, "radiance of the next bounce") : sent;
    lightLeaves(frame, common, result, earlier, sent.radiance);
    pullUp(frame, common, sent.radiance, result.radiance, false);
    if (rows != nullptr) reflectDirect(frame, common, *rows, result, earlier, sent.outgoing);
    for (int bounce = 0; bounce < count; ++bounce) {
      const bool last = bounce + 1 == count, sky = bounce == 0 && frame.traits().environment;
      gather(frame, common, {.environment = sky, .outgoing = rows != nullptr},
             {.adds = bounce > 0, .reflects = !last}, sent, result, result.irradiance, next.radiance);
      if (last) break;
      pullUp(frame, common, next.radiance, result.radiance, true);
      if (rows != nullptr) {
        reflectLinks(frame, common, *rows, {.environment = sky, .outgoing = true}, {}, sent, result,
                     next.outgoing);
        pullUpOutgoing(frame, common, *rows, result.radiance, next.outgoing);
      }
      std::swap(sent, next);
    }
    if (rows != nullptr) pullUpOutgoing(frame, common, *rows, result.radiance, result.outgoing);
  }

  /// Gathers emission over the short lists of links to emitters (Sec. 4.3.1).
  void gatherEmission(PassContext& frame, const shader::BindingSet& common, const ElementLight& result) {
    using Variant = light_leaves::Variant;
    frame.dispatchList(frame.program(Variant{.of = Variant::ofEmitted}),
                       {common, light_leaves::emissions(elements->emission, gpu::Sampling::nearest),
                        light_leaves::reflectedImage(result.emission)},
                       static_cast<std::uint64_t>(elements->leafCount));
    pullUp(frame, common, result.emission, nullptr, false);
    gather(frame, common, {.listed = lightLists}, {.adds = false, .reflects = false},
           {result.emission, nullptr}, result, result.directIrradiance, result.radiance);
  }

  /// Lights without extent come first. Emitters are taken by links or by samples, never by both.
  int lightCount(PassContext& frame, const LightBinding& lights) const {
    const auto withoutExtent = static_cast<int>(frame.sceneDescription().lights.size());
    if (!shadow.present()) return 0;
    return linksToLights() ? std::min(lights.count, withoutExtent) : lights.count;
  }

  void lightLeaves(PassContext& frame, const shader::BindingSet& common, const ElementLight& result,
                   const ElementLight* earlier, const gpu::TextureRef& sent) {
    const LightBinding lights(shadow);
    const int count = lightCount(frame, lights);
    const bool lit = count > 0;
    frame.dispatchList(frame.program(light_leaves::Variant{.lights = lit,
                                                           .shadows = lit,
                                                           .linked = result.directIrradiance != nullptr,
                                                           .before = earlier != nullptr},
                                     light_leaves::Constants{.samplesPerSide = lightSamples}),
                       {common, lights, light_leaves::directLight({count}),
                        light_leaves::albedos(elements->albedo, gpu::Sampling::nearest),
                        light_leaves::arrivingFromLights(result.directIrradiance, gpu::Sampling::nearest),
                        light_leaves::arrivedBefore(earlier != nullptr ? earlier->irradiance : nullptr,
                                                    gpu::Sampling::nearest),
                        light_leaves::reflectedImage(sent), light_leaves::radianceImage(result.radiance)},
                       static_cast<std::uint64_t>(elements->leafCount));
  }

  void gather(PassContext& frame, const shader::BindingSet& common, illuminate::Variant variant,
              illuminate::Constants constants, const Sent& sent, const ElementLight& result,
              const gpu::TextureRef& irradiance, const gpu::TextureRef& reflected) {
    variant.weight = weighsElements() ? illuminate::Variant::weightElement : illuminate::Variant::weightBin;
    shader::BindingSet bound{common,
                             EnvironmentBinding(frame),
                             illuminate::illumination({frame.sceneDescription().environment}),
                             illuminate::lights(links->lights),
                             illuminate::sentRadiance(sent.radiance, gpu::Sampling::nearest),
                             OutgoingBinding(sent.outgoing, result.outgoingRows, directions),
                             illuminate::albedos(elements->albedo, gpu::Sampling::nearest),
                             illuminate::irradianceImage(irradiance),
                             illuminate::reflectedImage(reflected),
                             illuminate::radianceImage(result.radiance)};
    if (weighsElements()) bound.add(illuminate::counts(linksToSameNode(frame)));
    constants.environmentMap = environmentMapOf(frame);
    frame.dispatchList(frame.program(variant, constants), bound,
                       kTogether * static_cast<std::uint64_t>(elements->leafCount));
  }

  /// Adds what the lobes of glossy leaves reflect of direct light, the first term of the sum over bounces,
  /// and of the light that was sent in the frame before.
  void reflectDirect(PassContext& frame, const shader::BindingSet& common, const OutgoingRows& rows,
                     const ElementLight& result, const ElementLight* earlier,
                     const gpu::TextureRef& outgoing) {
    using Variant = reflect_glossy::Variant;
    const LightBinding lights(shadow);
    const int count = lightCount(frame, lights);
    if (count > 0)
      reflect(frame, rows, Variant{.of = Variant::ofLights}, {.sums = true, .samplesPerSide = lightSamples},
              count, {common, lights}, directions, result, outgoing);
    if (result.emission)
      reflectLinks(frame, common, rows, {}, {.adds = true}, {result.emission, nullptr}, result, outgoing);
    if (earlier != nullptr)
      reflectLinks(frame, common, rows, {.environment = frame.traits().environment, .outgoing = true},
                   {.adds = true}, {earlier->radiance, earlier->outgoing}, result, outgoing);
    pullUpOutgoing(frame, common, rows, result.radiance, outgoing);
  }

  /// Adds what they reflect of light over their links, to `outgoing` and to the sum over bounces.
  void reflectLinks(PassContext& frame, const shader::BindingSet& common, const OutgoingRows& rows,
                    const reflect_glossy::Variant& variant, reflect_glossy::Constants constants,
                    const Sent& sent, const ElementLight& result, const gpu::TextureRef& outgoing) {
    constants.sums = constants.addsToSum = true;
    reflect(frame, rows, variant, constants, 6 * links->bins * links->bins,
            {common, reflect_glossy::sentRadiance(sent.radiance, gpu::Sampling::nearest),
             OutgoingBinding(sent.outgoing, result.outgoingRows, directions)},
            std::min<int>(links->bins, 2 * directions), result, outgoing);
  }

  void reflect(PassContext& frame, const OutgoingRows& rows, const reflect_glossy::Variant& variant,
               reflect_glossy::Constants constants, int arrivals, const shader::BindingSet& bound,
               int resolving, const ElementLight& result, const gpu::TextureRef& outgoing) const {
    if (rows.leaves == 0) return;
    const auto all = static_cast<std::uint64_t>(6 * directions * directions);
    constants.environmentMap = environmentMapOf(frame);
    frame.dispatchList(
        frame.program(variant, constants),
        {bound, EnvironmentBinding(frame),
         reflect_glossy::reflection({frame.sceneDescription().environment, rows.leaves, directions, arrivals,
                                     static_cast<float>(resolvedExponent(resolving))}),
         reflect_glossy::outgoingNodes(rows.nodes),
         reflect_glossy::speculars(elements->specular, gpu::Sampling::nearest),
         reflect_glossy::outgoingImage(outgoing), reflect_glossy::sumImage(result.outgoing)},
        static_cast<std::uint64_t>(rows.leaves) * ((all + kDirectionsTogether - 1) / kDirectionsTogether) *
            kDirectionsTogether);
  }

  /// `radiance`: that of groups, which tells their fronts.
  void pullUpOutgoing(PassContext& frame, const shader::BindingSet& common, const OutgoingRows& rows,
                      const gpu::TextureRef& radiance, const gpu::TextureRef& outgoing) const {
    using namespace pull_up_outgoing;
    for (const ElementTree::Run& level : rows.levels)
      frame.dispatchList(
          frame.program(kProgram),
          {common, outgoingRun({static_cast<int>(level.first), static_cast<int>(level.count), directions}),
           pull_up_outgoing::children(elements->children), outgoingNodes(rows.nodes),
           pull_up_outgoing::outgoingRows(rows.ofNodes), pulledUp(radiance, gpu::Sampling::nearest),
           outgoingImage(outgoing)},
          static_cast<std::uint64_t>(level.count) * static_cast<std::uint64_t>(6 * directions * directions));
  }

  /// For each link the number of its leaf's links to the same node, which counts once.
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

  /// Pulls up level by level from the leaves; `sum`, which may be null, holds all bounces.
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

// Chooses the texels of the lights' views that become lights.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/room.h"
#include "passes.h"
#include "reflective_shadow_maps_shaders.h"

namespace lumivox::reflective_shadow_maps {
namespace {

using namespace shaders::reflective_shadow_maps;

constexpr std::uint32_t kFan = 16;  // kFan in sum_tree.glsl

/// Texels along a side of a patch. On five scenes 4, 8 and 16 err alike; 1, which gives rows of views that
/// look the same way, errs by up to a fifth more.
constexpr std::uint32_t kPatchRows = 16;

/// Number of texels of all layers together, as the tree of sums numbers them.
std::uint32_t texelsOf(const ReflectiveShadowMap& map) {
  const gpu::TextureDescription& flux = map.flux->description();
  return static_cast<std::uint32_t>(flux.width) * static_cast<std::uint32_t>(flux.height) *
         static_cast<std::uint32_t>(flux.depth);
}

/// The map, with its lobes where it has some.
shader::BindingSet bindingOf(const ReflectiveShadowMap& map) {
  shader::BindingSet result = ReflectiveShadowMapBinding(map);
  if (map.specular != nullptr)
    result.add(shader::SampledSlot{"rsmSpecular"}(map.specular, gpu::Sampling::nearest));
  return result;
}

class ChoosePass : public Pass {
  enum class Method { flux, stride };
  enum class Area { surface, shared, facing };  // in the order of taken.glsl

  In<ReflectiveShadowMap> map{this, "map", Presence::optional,
                              "what the lights see; without it there are no lights"};
  enum class Order { rows, patches };

  Param<Method> method{
      this, "method", Method::flux,
      "flux: 'lights' texels in proportion to their flux; stride: every 'stride'-th texel along both axes, with the flux and the area of its square (Lensing & Broll 2013 take all: a stride of 1)",
      published(Method::stride)};
  Param<int> wanted{this, "lights", 1024, within(1, 1048576), "with 'flux': number of chosen texels"};
  Param<int> stride{this, "stride", 1, within(1, 4096),
                    "with 'stride': side of the square of texels that one light represents"};
  Param<Area> area{
      this, "area", Area::surface,
      "area of a light; surface: the surface area that the texel covers; shared: the same, divided among the samples of an area light, which see one surface; facing: the area of a texel that faced the light (Lensing & Broll 2013, Sec. 4.1)",
      published(Area::facing)};
  Param<Order> order{
      this, "order", Order::rows,
      "with 'flux': order of texels in the distribution, in which neighbours are seldom chosen together; rows: rows of each view; patches: squares, over all views of an area light that share a direction"};
  Out<SurfaceLights> lights{this, "lights", "lights on surfaces, one for each chosen texel or square"};

  void run(PassContext& frame) override {
    if (!map.present() || map->lightCount == 0) {
      lights = SurfaceLights{frame.emptyElements(choose::taken, 1, "no lights"), 0};
      return;
    }
    requireAreas(*map);
    lights = method == Method::flux ? byFlux(frame) : byStride(frame);
  }

  Area areaOf() const { return area; }

  static void requireAreas(const ReflectiveShadowMap& map) {
    for (const gpu::TextureRef& texture : {map.position, map.normal})
      if (map.flux == nullptr || texture == nullptr || !(texture->description() == map.flux->description()))
        throw Error(
            "the map lacks positions, or normals with areas: expected textures of the size and format of its "
            "flux, as reflective_shadow_maps.render makes them");
  }

  int areaCode() const { return static_cast<int>(areaOf()); }

  /// Each sample of a light is a separate light, unless samples share their areas.
  int overlapping(PassContext& frame) const {
    if (map->overlapping > 0) return map->overlapping;
    if (areaOf() != Area::shared) return map->lightCount;
    const Scene& scene = frame.sceneDescription();
    auto lightsOfScene = static_cast<int>(scene.lights.size());
    for (const Object& object : scene.objects)
      for (const Part& part : object.parts)
        if (scene.materials[static_cast<std::size_t>(part.material)].emissive()) ++lightsOfScene;
    return std::clamp(lightsOfScene, 1, map->lightCount);
  }

  static gpu::BufferRef room(PassContext& frame, int count) {
    const auto bytesOf = [](int lights) {
      return std::vector{choose::taken.elementBytes * static_cast<std::uint64_t>(lights)};
    };
    // Small lists are taken without a check.
    if (count > 65536) requireRoom(frame, count, bytesOf, "lights on surfaces");
    return frame.elements(choose::taken, static_cast<std::uint64_t>(count), "lights on surfaces");
  }

  /// Chooses by a tree of sums (sum_tree.glsl).
  SurfaceLights byFlux(PassContext& frame) const {
    const auto count = static_cast<std::uint32_t>(static_cast<int>(wanted));
    const gpu::TextureDescription& flux = map->flux->description();
    const auto width = static_cast<std::uint32_t>(flux.width),
               height = static_cast<std::uint32_t>(flux.height);
    // TexelOrder in sum_tree.glsl: where all lights have six views, views of one direction are adjacent.
    constexpr int kCubeViews = 6;
    const bool inPatches = order == Order::patches;
    const auto layers = static_cast<std::uint32_t>(map->layerCount);
    const std::uint32_t rows = inPatches ? kPatchRows : 1u,
                        together = inPatches && map->layerCount == kCubeViews * map->lightCount
                                       ? static_cast<std::uint32_t>(map->lightCount)
                                       : 1u,
                        ways = layers / together;
    // From the texels to the root.
    std::vector<std::uint32_t> sizes{texelsOf(*map)};
    std::uint32_t total = 0;
    do {
      sizes.push_back((sizes.back() + kFan - 1) / kFan);
      total += sizes.back();
    } while (sizes.back() > 1);
    const SurfaceLights result{room(frame, wanted), wanted, overlapping(frame)};
    const gpu::BufferRef tree = frame.elements(choose::tree, total, "sums of flux");
    const shader::BindingSet texels = bindingOf(*map);
    std::uint32_t firstOfAddends = 0, firstOfSums = total;
    for (std::size_t level = 1; level < sizes.size(); ++level) {
      firstOfSums -= sizes[level];
      using Variant = accumulate::Variant;
      const Variant variant{level == 1 ? Variant::ofTexels : Variant::ofSums};
      frame.dispatchList(frame.program(variant),
                         {accumulate::parameters({sizes[level - 1], firstOfAddends, firstOfSums, width,
                                                  height, rows, together, ways}),
                          texels, accumulate::tree(tree)},
                         sizes[level]);
      firstOfAddends = firstOfSums;
    }
    const auto levels = static_cast<std::uint32_t>(sizes.size() - 1);
    frame.dispatchList(
        frame.program(choose::Variant{map->specular != nullptr}),
        {choose::parameters({sizes.front(), levels, count, areaCode(), width, height, rows, together, ways}),
         texels, choose::tree(tree), choose::taken(result.lights)},
        count);
    return result;
  }

  SurfaceLights byStride(PassContext& frame) const {
    const gpu::TextureDescription& flux = map->flux->description();
    const int across = (flux.width + stride - 1) / stride, down = (flux.height + stride - 1) / stride,
              count = across * down * flux.depth;
    const SurfaceLights result{room(frame, count), count, overlapping(frame)};
    frame.dispatchList(
        frame.program(stride::Variant{map->specular != nullptr}),
        {stride::parameters({flux.width, flux.height, stride, across, down, count, areaCode()}),
         bindingOf(*map), stride::taken(result.lights)},
        static_cast<std::uint64_t>(count));
    return result;
  }
};

}  // namespace

void addChoose(TechniqueRegistry& registry) {
  registry.add<ChoosePass>(
      "choose", "Lights on surfaces from texels of the map, chosen in proportion to their flux or evenly");
}

}  // namespace lumivox::reflective_shadow_maps

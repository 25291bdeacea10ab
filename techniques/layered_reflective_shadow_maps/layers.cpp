// Splits the views of the lights into layers, so that each can be filtered: thesis Gomes 2015, Sec. 3.3.
#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "layered_reflective_shadow_map.h"
#include "layered_reflective_shadow_maps_shaders.h"
#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/counts.h"
#include "lumivox/toolkit/light_bounds.h"
#include "lumivox/toolkit/room.h"
#include "lumivox/toolkit/voxel_rays.h"
#include "passes.h"

namespace lumivox::layered_reflective_shadow_maps {
namespace {

using namespace shaders::layered_reflective_shadow_maps;

/// Half floats end at 65504; filtering never exceeds the largest value.
constexpr float kLargestHalf = 32768.0f;

/// Layers of a texture that OpenGL guarantees (4.5, table 23.53).
constexpr int kMostLayers = 2048;

class LayersPass : public Pass {
  // In the order of INTERVALS in layers_intervals.comp.
  enum class Intervals { equal, population };
  enum class Precision { half, float_ };

  In<ReflectiveShadowMap> map{this, "map", "what the lights see"};
  Param<int> depthLayers{this, "depth_layers", 4, within(1, 16), "intervals of depth of each view"};
  Param<Intervals> intervals{
      this, "intervals", Intervals::equal,
      "intervals of depth; equal: of equal width; population: with as many texels each"};
  Param<int> normalLayers{this,
                          "normal_layers",
                          1,
                          within(1, 6),
                          "layers of an interval by normals: 1, or 6, by the largest component and its sign",
                          published(6)};
  Param<float> unit{
      this, "unit", 0.0f, within(0.0f, 1e30f),
      "with 'precision half': radiance that the number 1 stands for, W/(sr m^2); 0: chosen by the lights"};
  Param<Precision> precision{this, "precision", Precision::half,
                             "radiance, cover and normals as half floats or as floats"};
  Out<LayeredReflectiveShadowMap> layers{this, "layers", "the views in layers, filtered"};

  Reads readsFrom() const override { return Reads::geometry | Reads::materials | Reads::lights; }
  Needs needs() const override { return Needs::anyLight; }
  std::string checkParameters() const override {
    return normalLayers == 1 || normalLayers == 6 ? std::string() : "'normal_layers' must be 1 or 6";
  }

  float unitOf(PassContext& frame) const {
    if (precision == Precision::float_) return 1.0f;
    if (unit > 0.0f) return unit;
    // Surfaces nearer to a light than this share of the scene are as bright as at that distance.
    constexpr float kNearest = 1.0f / 128.0f;
    const Bounds& bounds = frame.snapshot().bounds;
    const float nearest = bounds.empty ? 1.0f : kNearest * glm::length(bounds.high - bounds.low);
    return largestRadiance(frame.sceneDescription(), frame.snapshot(), std::max(nearest, 1e-6f)) /
           kLargestHalf;
  }

  /// The largest number that radiance is stored as.
  float mostOf() const { return precision == Precision::half ? 65504.0f : std::numeric_limits<float>::max(); }

  /// The bindings of the map that all programs read.
  shader::BindingSet mapOf(float ofUnit) const {
    return {ReflectiveShadowMapBinding(*map),
            shader::UniformSlot<layers_fill::Partition>{"Partition"}({.depthLayers = depthLayers,
                                                                      .normalLayers = normalLayers,
                                                                      .unit = ofUnit,
                                                                      .viewCount = map->layerCount,
                                                                      .most = mostOf()})};
  }

  /// Bounds of the intervals of each view.
  gpu::BufferRef boundsOf(PassContext& frame, const shader::BindingSet& seen,
                          const glm::ivec3& texels) const {
    const auto views = static_cast<std::uint64_t>(map->layerCount);
    const gpu::BufferRef ranges = frame.elements(layers_range::ranges, 2 * views, "depths of views"),
                         bounds = frame.elements(layers_intervals::bounds,
                                                 views * static_cast<std::uint64_t>(depthLayers + 1),
                                                 "intervals of depth");
    ranges->clear(0xffffffffu);
    frame.dispatch(frame.program(layers_range::kProgram), {seen, layers_range::ranges(ranges)}, texels);
    const bool population = intervals == Intervals::population && depthLayers > 1;
    constexpr std::uint64_t kBins = 256;  // of bins.glsl
    const gpu::BufferRef bins =
        population ? frame.emptyElements(layers_count::bins, kBins * views, "texels by depth") : nullptr;
    if (population)
      frame.dispatch(frame.program(layers_count::kProgram),
                     {seen, layers_count::ranges(ranges), layers_count::bins(bins)}, texels);
    frame.dispatch(
        frame.program(layers_intervals::Variant{population ? layers_intervals::Variant::intervalsPopulation
                                                           : layers_intervals::Variant::intervalsEqual}),
        {seen, layers_intervals::ranges(ranges), layers_intervals::bins(bins),
         layers_intervals::bounds(bounds)},
        {map->layerCount, 1, 1});
    return bounds;
  }

  gpu::TextureDescription layersOf(int count, gpu::Format format) const {
    const gpu::TextureDescription& texels = map->position->description();
    return {gpu::TextureKind::d2Array,
            format,
            texels.width,
            texels.height,
            std::max(count, 1),
            gpu::fullLevelCount(texels.width, texels.height)};
  }

  /// Bytes of so many layers, in parts that also fit into small buffers, since they become textures.
  std::vector<std::uint64_t> bytesOf(int count, gpu::Format colours) const {
    constexpr std::uint64_t kPart = std::uint64_t{64} << 20;
    std::uint64_t bytes =
        2 * layersOf(count, colours).sizeBytes() + layersOf(count, gpu::Format::rg32f).sizeBytes();
    std::vector<std::uint64_t> parts;
    for (; bytes > kPart; bytes -= kPart) parts.push_back(kPart);
    parts.push_back(bytes);
    return parts;
  }

  void fill(PassContext& frame, const shader::BindingSet& seen, const LayeredReflectiveShadowMap& result,
            const gpu::TextureRef& slots) const {
    const gpu::TextureDescription& size = result.radiance->description();
    frame.dispatch(
        frame.program(layers_fill::kProgram),
        {seen, layers_fill::layers(result.layers), layers_fill::slotOfTexel(slots, gpu::Sampling::nearest),
         layers_fill::radianceImage(result.radiance), layers_fill::normalImage(result.normal),
         layers_fill::depthImage(result.depth)},
        {size.width, size.height, size.depth});
    const auto sizeOf = [&](int level) {
      return glm::ivec2(std::max(size.width >> level, 1), std::max(size.height >> level, 1));
    };
    for (int level = 1; level < size.levels; ++level) {
      const glm::ivec2 coarse = sizeOf(level);
      frame.dispatch(
          frame.program(layers_mip::kProgram),
          {layers_mip::mip({.coarse = coarse, .fine = sizeOf(level - 1), .fineLevel = level - 1}),
           layers_mip::radianceLayers(result.radiance, gpu::Sampling::nearest),
           layers_mip::normalLayers(result.normal, gpu::Sampling::nearest),
           layers_mip::depthLayers(result.depth, gpu::Sampling::nearest),
           layers_mip::radianceImage(result.radiance, level), layers_mip::normalImage(result.normal, level),
           layers_mip::depthImage(result.depth, level)},
          {coarse.x, coarse.y, size.depth});
    }
  }

  void run(PassContext& frame) override {
    requireWhole(*map, "layered_reflective_shadow_maps.layers");
    LayeredReflectiveShadowMap result{.lights = map->lights,
                                      .views = map->views,
                                      .lightCount = map->lightCount,
                                      .viewCount = map->layerCount,
                                      .mostOfView = depthLayers * normalLayers,
                                      .unit = unitOf(frame)};
    const gpu::TextureDescription& texture = map->position->description();
    const glm::ivec3 texels(texture.width, texture.height, map->layerCount);
    const shader::BindingSet seen = mapOf(result.unit);
    const int slotCount = map->layerCount * result.mostOfView;
    gpu::TextureRef slots;
    gpu::BufferRef bounds, numbers, total;
    if (slotCount > 0) {
      bounds = boundsOf(frame, seen, texels);
      slots = frame.texture({gpu::TextureKind::d2Array, gpu::Format::r32ui, texels.x, texels.y, texels.z, 1},
                            "slots of texels");
      const auto count = static_cast<std::uint64_t>(slotCount);
      numbers = frame.emptyElements(layers_classify::used, count, "numbers of layers");
      total = frame.buffer(sizeof(std::uint32_t), "number of layers");
      frame.dispatch(frame.program(layers_classify::kProgram),
                     {seen, layers_classify::bounds(bounds), layers_classify::used(numbers),
                      layers_classify::slotImage(slots)},
                     texels);
      scan(frame, numbers, count, 1, total);
      frame.device().barrier();
      result.layerCount = static_cast<int>(total->downloadValues<std::uint32_t>().front());
    }
    const gpu::Format colours = precision == Precision::half ? gpu::Format::rgba16f : gpu::Format::rgba32f;
    if (result.layerCount > kMostLayers)
      throw Error(fmt::format(
          "layered_reflective_shadow_maps.layers: {} views make {} layers; expected at most {}: fewer light samples, 'depth_layers' (now {}) or 'normal_layers' (now {})",
          map->layerCount, result.layerCount, kMostLayers, static_cast<int>(depthLayers),
          static_cast<int>(normalLayers)));
    requireRoom(
        frame, std::max(result.layerCount, 1), [&](int count) { return bytesOf(count, colours); },
        "layers of views");
    result.radiance = frame.texture(layersOf(result.layerCount, colours), "radiance of layers");
    result.normal = frame.texture(layersOf(result.layerCount, colours), "normals of layers");
    result.depth = frame.texture(layersOf(result.layerCount, gpu::Format::rg32f), "depths of layers");
    result.layers =
        frame.emptyElements(layers_list::layers, static_cast<std::uint64_t>(result.layerCount), "layers");
    result.viewLayers = frame.emptyElements(layers_list::viewLayers,
                                            static_cast<std::uint64_t>(map->layerCount), "layers of views");
    if (result.layerCount > 0) {
      frame.dispatchList(
          frame.program(layers_list::kProgram),
          {seen, layers_list::bounds(bounds), layers_list::numbers(numbers), layers_list::total(total),
           layers_list::layers(result.layers), layers_list::viewLayers(result.viewLayers)},
          static_cast<std::uint64_t>(slotCount));
      fill(frame, seen, result, slots);
    } else {
      for (const gpu::TextureRef& one : {result.radiance, result.normal, result.depth})
        one->clear(glm::vec4(0.0f));
    }
    layers = result;
  }
};

}  // namespace

void addLayers(TechniqueRegistry& registry) {
  registry.add<LayersPass>(
      "layers", "Views of the lights in layers by depth and normal, filtered (thesis Gomes 2015, Sec. 3.3)");
}

}  // namespace lumivox::layered_reflective_shadow_maps

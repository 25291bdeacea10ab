// Traces cones through opacities, lit by layers of the lights' views: thesis Gomes 2015, Sec. 3.3, Fig. 44.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "layered_reflective_shadow_map.h"
#include "layered_reflective_shadow_maps_shaders.h"
#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/environment.h"
#include "lumivox/toolkit/grid_placement.h"
#include "lumivox/toolkit/loop_limit.h"
#include "opacity_levels.h"
#include "passes.h"

namespace lumivox::layered_reflective_shadow_maps {
namespace {

namespace gather = shaders::layered_reflective_shadow_maps::gather;

class GatherPass : public Pass {
  // In the order of shareRule in store_layers.glsl.
  enum class Share { normal, chebyshev };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<OpacityLevels> opacity{this, "opacity", "opacities of voxels, one mip per halving", Levels::all};
  In<LayeredReflectiveShadowMap> layers{this, "layers", Presence::optional,
                                        "light of the voxels; without it only the environment shines",
                                        Needs::anyLight};
  Param<int> cones{this, "cones", 6, within(1, 256), "diffuse cones per pixel"};
  Param<int> glossyCones{this, "glossy_cones", 4, within(1, 64),
                         "cones per pixel that share the Phong lobe; 1: one cone as wide as the lobe"};
  Param<int> pattern{
      this, "pattern", 4, within(1, 8),
      "side of a square of pixels whose cones have different directions, for a filter of that width behind the pass; 1: the same in all pixels"};
  Param<Share> share{
      this, "share", Share::normal,
      "share of a layer at a step, by mean and variance of its depths; normal: of normally distributed depths; chebyshev: by Chebyshev's inequality, as variance shadow maps have it"};
  Param<float> slab{
      this, "slab", 3.0f, within(0.1f, 100.0f),
      "depths that count as those of a step, in voxels that are read; a surface's voxels are read up to 1.5 off it"};
  Param<bool> slant{
      this, "slant", true,
      "the slab is that thick along a layer's filtered normal; off: along the view, so that slanted surfaces lose light",
      published(false)};
  Param<bool> facing{this, "facing", true, "only layers count whose filtered normal looks against the cone"};
  Param<float> step{this, "step", 0.5f, within(0.05f, 2.0f), "step along a cone as a share of its diameter"};
  Param<float> offset{this, "offset", 1.0f, within(0.0f, 8.0f),
                      "distance of a cone's start along the normal, in voxels"};
  Param<float> start{this, "start", 1.0f, within(0.0f, 8.0f),
                     "distance of a cone's start along its axis, in voxels"};
  Param<float> clearance{this, "clearance", 0.5f, within(0.0f, 1e3f),
                         "largest voxel that is read, as a share of its height over the surface"};
  Param<float> footprint{this, "footprint", 0.5f, within(0.25f, 1.0f),
                         "size of the voxels that are read, as a share of the cone's diameter"};
  Param<float> refinement{
      this, "refinement", 0.5f, within(0.0f, 1.0f),
      "smallest voxel that is read where voxels are partly covered, as a share of the size for the cone; 1: none smaller; 0: the finest"};
  Param<float> reach{
      this, "reach", 0.0f, within(0.0f, 1e9f), "m", "length of a cone; 0: to the end of the grid"};
  Param<float> jitter{
      this, "jitter", 0.0f, within(0.0f, 1.0f),
      "largest random reduction of a cone's first step, as a share of it, for each pixel and cone"};
  Out<Image> arriving{this, "arriving", Contributes::nothing, Needs::nothing,
                      "E / pi at the pixels: mean radiance that arrives, W/(sr m^2)"};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::glossyMaterial,
                    "indirect light reflected by the Phong lobe"};

  Reads readsFrom() const override { return Reads::camera | Reads::environment; }

  int lightCount() const { return layers.present() && layers->layerCount > 0 ? layers->lightCount : 0; }
  float diagonal() const {
    return glm::length(glm::vec3(opacity->grid.resolution)) * opacity->grid.voxelSize;
  }
  /// Layers that one dispatch reads at a step of a cone.
  struct Asked {
    int lights, layers;  ///< of each view
  };
  /// Bounds the turns of all loops of one cone: steps of the finest voxel, as many that finer voxels read
  /// once more, and the layers read at each step.
  std::int64_t turnsOfCone(const Asked& asked) const {
    const float length = reach > 0.0f ? std::min<float>(reach, diagonal()) : diagonal();
    const auto steps = static_cast<std::int64_t>(std::ceil(length / (step * opacity->grid.voxelSize)));
    constexpr std::int64_t kFirst = 24;  // finer reads before the first step
    return (2 * steps + kFirst) * (1 + asked.lights * (1 + asked.layers));
  }
  /// As many lights as one dispatch may read, with all layers, or one light with as many layers as it may.
  Asked askedAtOnce() const {
    Asked asked{std::max(lightCount(), 1), layers.present() ? std::max(layers->mostOfView, 1) : 1};
    while (asked.lights > 1 && turnsOfCone(asked) > kLoopLimit) asked.lights = (asked.lights + 1) / 2;
    while (asked.layers > 1 && turnsOfCone(asked) > kLoopLimit) asked.layers = (asked.layers + 1) / 2;
    if (const std::int64_t turns = turnsOfCone(asked); turns > kLoopLimit)
      throw Error(fmt::format(
          "layered_reflective_shadow_maps.gather: a cone through {} may take {} turns of loops; expected at most {}: fewer voxels, or a longer 'step'",
          inWords(opacity->grid), turns, kLoopLimit));
    return asked;
  }

  shader::BindingSet marchOf(PassContext& frame, bool addsEnvironment) const {
    return {shader::UniformSlot<gather::March>{"March"}(
        {.environment = addsEnvironment ? frame.sceneDescription().environment : glm::vec3(0.0f),
         .maxDistance = reach > 0.0f ? static_cast<float>(reach) : 2.0f * diagonal(),
         .stepShare = step,
         .offset = offset,
         .startShare = start,
         .clearance = clearance,
         .footprint = footprint,
         .leastShare = refinement,
         .jitter = jitter,
         .seed = seedWords(frame)})};
  }

  shader::BindingSet storeOf(int firstLight, int lights, int firstLayer, int ofView) const {
    const GridPlacement& grid = opacity->grid;
    const int filled =
        opacity->filledLevels == 0 ? opacity->opacity->description().levels : opacity->filledLevels;
    shader::BindingSet result{
        shader::UniformSlot<gather::Store>{"Store"}(
            {.storeLow = grid.low,
             .storeVoxel = grid.voxelSize,
             .storeExtent = glm::vec3(grid.resolution) * grid.voxelSize,
             .storeCoarsest = static_cast<float>(filled - 1),
             .storeUnit = lights > 0 ? layers->unit : 1.0f,
             .storeOpacityOfFinestVoxel = opacity->opacityOf == RadianceGrid::Opacity::ofFinestVoxel,
             .slab = slab,
             .firstLight = firstLight,
             .lightsAtOnce = lights,
             .firstLayer = firstLayer,
             .layersAtOnce = ofView}),
        gather::opacityGrid(opacity->opacity, gpu::Sampling::linearMipsBorder)};
    if (lights > 0) {
      result.add(shader::StorageSlot{"Lights"}(layers->lights));
      result.add(shader::StorageSlot{"Views"}(layers->views));
      result.add(gather::layers(layers->layers));
      result.add(gather::viewLayers(layers->viewLayers));
      result.add(gather::radianceLayers(layers->radiance, gpu::Sampling::linearMips));
      result.add(gather::normalLayers(layers->normal, gpu::Sampling::linearMips));
      result.add(gather::depthLayers(layers->depth, gpu::Sampling::linearMips));
    }
    return result;
  }

  /// Traces all cones of a lobe, in enough dispatches to keep loops within what drivers run.
  void gathered(PassContext& frame, int lobe, int count, const gpu::TextureRef& image) const {
    const int lights = lightCount(), ofView = layers.present() ? layers->mostOfView : 0;
    const Asked asked = askedAtOnce();
    const bool environment = frame.traits().environment;
    if (lights == 0 && !environment) return image->clear(glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
    const shader::BoundProgram& program =
        frame.program(gather::Variant{.lobe = lobe, .lights = lights > 0, .environment = environment},
                      gather::Constants{.coneCount = count,
                                        .shareRule = static_cast<int>(static_cast<Share>(share)),
                                        .facingRule = facing,
                                        .slantRule = slant,
                                        .pattern = pattern,
                                        .environmentMap = environmentMapOf(frame)});
    gather::Parameters parameters{.eyeWorld = frame.snapshot().camera.eye, .first = true};
    forEachPortion(count, turnsOfCone(asked), [&](int firstCone, int conesAtOnce) {
      parameters.firstCone = firstCone;
      parameters.conesAtOnce = conesAtOnce;
      for (int light = 0; light == 0 || light < lights; light += asked.lights)
        for (int layer = 0; layer == 0 || layer < ofView; layer += asked.layers) {
          const int ofPortion = std::min(asked.lights, lights - light);
          parameters.last = firstCone + conesAtOnce == count && light + ofPortion >= lights &&
                            layer + asked.layers >= ofView;
          frame.dispatch(
              program,
              {gather::parameters(parameters), GBufferBinding(*gbuffer),
               storeOf(light, ofPortion, layer, asked.layers), marchOf(frame, light == 0 && layer == 0),
               EnvironmentBinding(frame), gather::sumImage(image)},
              pixels(frame));
          parameters.first = false;
        }
    });
  }

  void run(PassContext& frame) override {
    if (arriving.wanted()) {
      arriving = Image{frame.image("arriving radiance")};
      gathered(frame, gather::Variant::lobeDiffuse, cones, arriving->texture);
    }
    if (glossy.wanted()) {
      glossy = Image{frame.image("indirect glossy radiance")};
      if (gbuffer->specular != nullptr)
        gathered(frame, gather::Variant::lobeGlossy, glossyCones, glossy->texture);
      else
        glossy->texture->clear(glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
    }
  }
};

}  // namespace

void addGather(TechniqueRegistry& registry) {
  registry.add<GatherPass>(
      "gather",
      "Cones through opacities, lit by layered reflective shadow maps (thesis Gomes 2015, Sec. 3.3)");
}

}  // namespace lumivox::layered_reflective_shadow_maps

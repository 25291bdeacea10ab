// Voxel cone tracing on a dense isotropic grid: Crassin et al. 2011, "Interactive indirect illumination using
// voxel cone tracing"; thesis Gomes 2015, Sec. 4.2.1. Pre-filtering and final gathering; injection is in
// inject.cpp.
#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/media.h"
#include "march.h"

namespace lumivox::voxel_cone_tracing {

void addInject(TechniqueRegistry& registry);
void addSoftShadows(TechniqueRegistry& registry);
void addLens(TechniqueRegistry& registry);

namespace {

using namespace shaders::voxel_cone_tracing;

class FilterPass : public Pass {
  // In the order of filter.comp.
  enum class Opacity { facing, average, trilinear };

  In<RadianceGrid> radiance{this, "radiance", "the finest level"};
  Param<Opacity> opacity{
      this, "opacity", Opacity::facing,
      "how children make a parent: seen through along the axis that they face; their plain mean; or that mean as published, in one read by the texture's filter, which misses children where sizes are odd"};
  Out<RadianceGrid> mips{this, "mips", "the same grid with one level per halving", Levels::all};

  void run(PassContext& frame) override {
    const gpu::TextureDescription& texture = radiance->radiance->description();
    const glm::ivec3 finest(texture.width, texture.height, texture.depth);
    const OccupiedBricks& occupied = radiance->occupied;
    const filter::Constants constants{.rule = static_cast<int>(static_cast<Opacity>(opacity))};
    const auto sampling =
        opacity == Opacity::trilinear ? gpu::Sampling::linearOneMip : gpu::Sampling::nearest;
    for (int level = 1; level < texture.levels; ++level) {
      const glm::ivec3 coarse = levelResolution(finest, level), fine = levelResolution(finest, level - 1);
      // The voxels of a level are those of the bricks down to one a brick, where bricks are halved evenly.
      const bool followsBricks = occupied.bricks != nullptr && (OccupiedBricks::kSide >> level) >= 1 &&
                                 finest % OccupiedBricks::kSide == glm::ivec3(0);
      const auto& program = frame.program(filter::Variant{followsBricks}, constants);
      const shader::BindingSet bindings{
          filter::parameters({.coarse = coarse, .fineLevel = level - 1, .fine = fine}),
          filter::radianceGrid(radiance->radiance, sampling),
          filter::radianceImage(radiance->radiance, level), filter::brickList(occupied.bricks),
          filter::brickCount(occupied.count)};
      if (!followsBricks) {
        frame.dispatch(program, bindings, coarse);
        continue;
      }
      radiance->radiance->clear(glm::vec4(0.0f), level);
      frame.dispatchIndirect(program, bindings, *occupied.count, OccupiedBricks::argumentsBytes(level));
    }
    RadianceGrid filtered = *radiance;
    filtered.filledLevels = texture.levels;
    filtered.opacity =
        opacity == Opacity::facing ? RadianceGrid::Opacity::ofVoxel : RadianceGrid::Opacity::ofFinestVoxel;
    mips = filtered;
  }
};

class GatherPass : public Pass {
  enum class Distribution { cosine, published };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  StoreInput store{this};
  In<ScatteringGrid> media{this, "media", Presence::optional,
                           "media that dim what the cones see; light that they scatter is left out"};
  Param<int> cones{this, "cones", 6, within(1, 256), "diffuse cones per pixel"};
  Param<Distribution> distribution{
      this, "distribution", Distribution::cosine,
      "cones of equal weight distributed as the cosine, or one upright and four at 45 degrees"};
  Param<float> coneRatio{this, "cone_ratio",
                         1.15470053837925152902f,  // 2 tan 30 degrees
                         within(0.01f, 8.0f),
                         "diameter of one of those five over its height; no number is published"};
  Param<bool> asPublished{
      this, "as_published", false,
      "Listings 4.12 and 4.13 to the letter: the five cones with the weights 1 and 0.707, not normalised, from two voxels on by samples of two voxels and more; 'cones', 'distribution', 'step', 'offset', 'start', 'clearance' and 'footprint' have no say"};
  ConeMarch march{this};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "indirect light reflected by the diffuse lobe"};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::glossyMaterial,
                    "indirect light reflected by the Phong lobe"};

  Reads readsFrom() const override { return Reads::camera | Reads::environment; }

  void run(PassContext& frame) override {
    const StoreBinding input = store.binding();
    if (input.holdsMedia && media.present())
      throw Error(
          "voxel_cone_tracing.gather: the voxels of 'grid' already contain the media, and 'media' would dim what the cones see once more; expected 'media' to be left out, or 'store_media off' in voxel_cone_tracing.inject");
    const MediaBinding bound(frame, media);
    const gather::Variant variant{.diffuse = diffuse.wanted(),
                                  .glossy = glossy.wanted() && gbuffer->specular != nullptr,
                                  .environment = frame.traits().environment,
                                  .medium = bound.axis};
    const gather::Constants constants{.coneCount = cones,
                                      .publishedCones = distribution == Distribution::published,
                                      .asPublished = asPublished};
    if (variant.diffuse) diffuse = Image{frame.image("indirect diffuse radiance")};
    if (variant.glossy) glossy = Image{frame.image("indirect glossy radiance")};
    frame.dispatch(frame.program(variant, constants),
                   {gather::parameters({.eyeWorld = frame.snapshot().camera.eye, .coneRatio = coneRatio}),
                    GBufferBinding(*gbuffer), bound, input, march.binding(frame, input),
                    gather::diffuseImage(textureOf(diffuse)), gather::glossyImage(textureOf(glossy))},
                   pixels(frame));
  }
};

}  // namespace
}  // namespace lumivox::voxel_cone_tracing

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::voxel_cone_tracing;
  registry.describe("Voxel cone tracing on a dense isotropic grid",
                    "Crassin et al. 2011; thesis Gomes 2015, Sec. 4.2.1");
  addInject(registry);
  registry.add<FilterPass>("filter", "Pre-filtered coarser levels (Crassin et al. 2011, Sec. 5)");
  registry.add<GatherPass>("gather", "Final gathering with cones (Crassin et al. 2011, Sec. 7)");
  addSoftShadows(registry);
  addLens(registry);
}

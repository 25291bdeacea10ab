// Final gathering with cones through any store: Crassin et al. 2011, Sec. 7; thesis Gomes 2015, Sec. 4.2.1,
// Listings 4.11 to 4.13.
#include "../dense/normal_lobes.h"
#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/environment.h"
#include "lumivox/toolkit/media.h"
#include "march.h"

namespace lumivox::voxel_cone_tracing {
namespace {

namespace gather = shaders::voxel_cone_tracing::gather;
namespace reconstruct = shaders::voxel_cone_tracing::reconstruct;

class GatherPass : public Pass {
  enum class Distribution { cosine, published };
  enum class ConeLobe { sine, cosine };
  // In the order of their halvings.
  enum class Resolution { full, half, quarter };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  StoreInput store{this};
  In<NormalLobes> lobes{
      this, "lobes", Presence::optional,
      "beside 'grid': directions into which its voxels reflect; without them voxels are isotropic"};
  In<ScatteringGrid> media{this, "media", Presence::optional,
                           "media that attenuate the cones; light that they scatter is left out"};
  Param<int> cones{this, "cones", 6, within(1, 256), "diffuse cones per pixel"};
  Param<int> glossyCones{
      this, "glossy_cones", 4, within(1, 64),
      "cones per pixel that share the Phong lobe; 1: one cone as wide as the lobe, as published"};
  Param<Distribution> distribution{
      this, "distribution", Distribution::cosine,
      "diffuse cones; cosine: of equal weight, distributed as the cosine; published: one along the normal and four at 45 degrees"};
  Param<float> coneRatio{
      this, "cone_ratio",
      1.15470053837925152902f,  // 2 tan 30 degrees
      within(0.01f, 8.0f),
      "diameter over height of a cone with 'distribution published'; no number is published"};
  Param<int> pattern{
      this, "pattern", 4, within(1, 8),
      "side of a square of pixels whose cones have different directions; a joint bilateral filter of this width averages them, which acts as that many more cones; 1: each pixel by itself, as published"};
  Param<Resolution> resolution{
      this, "resolution", Resolution::full,
      "pixels that send cones; full: all; half: one of 2 x 2; quarter: one of 4 x 4, with the others filled by a joint bilateral filter"};
  Param<float> tolerance{
      this, "tolerance", 1.0f, within(1e-3f, 1e3f),
      "distance from a pixel's surface at which that filter gives another pixel the weight 1/e, in voxels"};
  Param<ConeLobe> coneLobe{
      this, "cone_lobe", ConeLobe::sine,
      "with 'lobes': standard deviation of a cone's directions; sine: the sine of its half angle; cosine: the cosine, as published"};
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
    if (lobes.present() && input.axis != gather::Variant::storeDense)
      throw Error(
          "voxel_cone_tracing.gather: 'lobes' say to which side the voxels of 'grid' shine, and the cones read another store; expected 'grid' to be connected or 'lobes' to be left out");
    if (lobes.present() && (input.holdsMedia || input.bounces > 1))
      throw Error(
          "voxel_cone_tracing.gather: 'lobes' know the sides of surfaces in direct light alone, and the voxels of 'grid' hold media or further bounces, which shine to all sides; expected 'lobes' to be left out, or 'store_media off' and 'bounces 1' in voxel_cone_tracing.inject");
    if (lobes.present() && !(lobes->grid == input.grid))
      throw Error(
          "voxel_cone_tracing.gather: 'lobes' are those of another grid than 'grid'; expected the same fragments for both");
    const MediaBinding bound(frame, media);
    const gather::Variant variant{.diffuse = diffuse.wanted(),
                                  .glossy = glossy.wanted() && gbuffer->specular != nullptr,
                                  .lobes = lobes.present(),
                                  .store = input.axis,
                                  .faces = input.faces,
                                  .environment = frame.traits().environment,
                                  .medium = bound.axis};
    const int every = 1 << static_cast<int>(static_cast<Resolution>(resolution)), side = pattern;
    const glm::ivec3 gathered =
        (pixels(frame) + glm::ivec3(every - 1, every - 1, 0)) / glm::ivec3(every, every, 1);
    if (variant.diffuse) diffuse = Image{frame.image("indirect diffuse radiance")};
    if (variant.glossy) glossy = Image{frame.image("indirect glossy radiance")};
    const gpu::TextureDescription ofSamples{
        .format = gpu::Format::rgba32f, .width = gathered.x, .height = gathered.y};
    // Without a pattern and with a sample for each pixel there is nothing to reconstruct.
    const bool arrivingDiffuse = variant.diffuse && (every > 1 || side > 1),
               arrivingGlossy = variant.glossy && every > 1;
    const gather::Constants constants{.coneCount = cones,
                                      .publishedCones = distribution == Distribution::published,
                                      .glossyCones = glossyCones,
                                      .publishedLobes = coneLobe == ConeLobe::cosine,
                                      .every = every,
                                      .pattern = side,
                                      .arrivingDiffuse = arrivingDiffuse,
                                      .arrivingGlossy = arrivingGlossy,
                                      .environmentMap = environmentMapOf(frame)};
    Samples samples{arrivingDiffuse ? frame.texture(ofSamples, "gathered radiance") : textureOf(diffuse),
                    arrivingGlossy ? frame.texture(ofSamples, "gathered radiance") : textureOf(glossy)};
    shader::BindingSet ofLobes;
    if (lobes.present()) ofLobes.add(gather::lobeGrid(lobes->lobes, gpu::Sampling::linearMipsBorder));
    frame.dispatch(frame.program(variant, constants),
                   {gather::parameters({.eyeWorld = frame.snapshot().camera.eye, .coneRatio = coneRatio}),
                    GBufferBinding(*gbuffer), bound, input, ofLobes, EnvironmentBinding(frame),
                    march.binding(frame, input), gather::diffuseImage(samples.diffuse),
                    gather::glossyImage(samples.glossy)},
                   gathered);
    const reconstruct::Parameters filter{
        .every = every, .pattern = side, .tolerance = tolerance * input.voxel};
    if (arrivingDiffuse && side > 1) {
      const gpu::TextureRef rows = frame.texture(ofSamples, "rows of gathered radiance");
      reconstructed(frame, filter, {1, 0}, false, {samples.diffuse, nullptr}, {rows, nullptr}, gathered);
      const gpu::TextureRef columns = every > 1 ? samples.diffuse : textureOf(diffuse);
      reconstructed(frame, filter, {0, 1}, true, {rows, nullptr}, {columns, nullptr}, gathered);
    }
    if (every > 1)
      reconstructed(frame, filter, {0, 0}, true, samples, {textureOf(diffuse), textureOf(glossy)},
                    pixels(frame));
  }

  struct Samples {
    gpu::TextureRef diffuse, glossy;  ///< null: not asked for
  };
  /// One pass of reconstruct.comp.
  void reconstructed(PassContext& frame, reconstruct::Parameters filter, glm::ivec2 along, bool finishes,
                     const Samples& from, const Samples& to, glm::ivec3 threads) const {
    filter.along = along;
    filter.finishes = finishes;
    frame.dispatch(
        frame.program(reconstruct::Variant{.diffuse = to.diffuse != nullptr, .glossy = to.glossy != nullptr}),
        {reconstruct::parameters(filter), GBufferBinding(*gbuffer),
         reconstruct::gatheredDiffuse(from.diffuse, gpu::Sampling::nearest),
         reconstruct::gatheredGlossy(from.glossy, gpu::Sampling::nearest),
         reconstruct::diffuseImage(to.diffuse), reconstruct::glossyImage(to.glossy)},
        threads);
  }
};

}  // namespace

void addGather(TechniqueRegistry& registry) {
  registry.add<GatherPass>("gather", "Final gathering with cones (Crassin et al. 2011, Sec. 7)");
}

}  // namespace lumivox::voxel_cone_tracing

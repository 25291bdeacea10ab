// An edge-avoiding wavelet filter whose weights follow the variance of the light: Dammertz et al. 2010;
// Schied et al. 2017, Sec. 4.3 and 4.4.
#include <fmt/format.h>

#include <array>

#include "image_filters_shaders.h"
#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "passes.h"

namespace lumivox::image_filters {
namespace {

namespace atrous = shaders::image_filters::atrous;

class AtrousPass : public Pass {
  // In the order of their numbers in atrous.comp.
  enum class Guide { plane, depth };
  enum class DeviationOf { both, own };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<Image> arriving{this, "diffuse", "arriving radiance, E / pi, at every pixel"};
  In<Image> variance{this, "variance", "variance of its luminance, in the first channel"};
  Param<int> levels{this, "levels", 5, within(1, 10),
                    "levels of 5 x 5 samples, each twice as far apart as in the level before"};
  Param<float> sigmaLight{
      this, "sigma_l", 4.0f, within(1e-3f, 1e6f),
      "standard deviations of the light by which luminances differ where a weight is 1/e"};
  Param<DeviationOf> deviationOf{
      this, "deviation_of", DeviationOf::both,
      "whose standard deviation 'sigma_l' counts; both: of both pixels, by their mean variance; own: of the pixel that is filtered",
      published(DeviationOf::own)};
  Param<float> sigmaNormal{this, "sigma_n", 128.0f, within(1e-3f, 1e4f),
                           "exponent of the cosine between the shading normals"};
  Param<Guide> guide{
      this, "guide", Guide::plane,
      "distance of surfaces; plane: from the pixel's tangent plane, in units of 'tolerance'; depth: of depths along the view, in units of 'sigma_z'",
      published(Guide::depth)};
  Param<float> sigmaDepth{
      this, "sigma_z", 1.0f, within(1e-3f, 1e6f),
      "with 'guide depth': depths differ by this times what the pixel's plane says, where a weight is 1/e"};
  Param<float> tolerance{
      this, "tolerance", 1.0f, within(1e-3f, 1e3f),
      "with 'guide plane': distance from the tangent plane at which a weight is 1/e, in widths of a pixel"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "indirect light reflected by the diffuse lobe, W/(sr m^2)"};
  Out<Image> first{this, "first", Contributes::nothing, Needs::nothing,
                   "arriving radiance after the first level, for the history of image_filters.accumulate"};

  Reads readsFrom() const override { return Reads::camera; }

  void run(PassContext& frame) override {
    const glm::ivec3 size = pixels(frame);
    for (const auto& [input, name] : {std::pair(&arriving, "diffuse"), std::pair(&variance, "variance")}) {
      const gpu::TextureDescription& samples = (*input)->texture->description();
      if (samples.width != size.x || samples.height != size.y)
        throw Error(fmt::format(
            "image_filters.atrous: '{}' has {} x {} samples for {} x {} pixels; expected one for each pixel",
            name, samples.width, samples.height, size.x, size.y));
    }
    const CameraView& camera = frame.snapshot().camera;
    gpu::TextureRef light = arriving->texture, noise = variance->texture;
    const int needed = diffuse.wanted() ? int(levels) : 1;
    for (int level = 0; level < needed; ++level) {
      const gpu::TextureRef filtered = frame.image("filtered light"),
                            noiseLeft = frame.image("filtered variance");
      const auto filter = [&](bool reflects, const gpu::TextureRef& to) {
        frame.dispatch(frame.program(atrous::Variant{.reflects = reflects},
                                     atrous::Constants{.guide = static_cast<int>(Guide(guide)),
                                                       .ofBoth = deviationOf == DeviationOf::both}),
                       {atrous::level({.eye = camera.eye,
                                       .pixelAngle = pixelAngleOf(camera),
                                       .forward = camera.forward,
                                       .apart = 1 << level,
                                       .right = camera.right,
                                       .sigmaLight = sigmaLight,
                                       .up = camera.up,
                                       .sigmaNormal = sigmaNormal,
                                       .sigmaDepth = sigmaDepth,
                                       .tolerance = tolerance}),
                        GBufferBinding(*gbuffer), atrous::lightImage(light, gpu::Sampling::nearest),
                        atrous::varianceImage(noise, gpu::Sampling::nearest), atrous::filteredLight(to),
                        atrous::filteredVariance(noiseLeft)},
                       size);
      };
      const bool last = diffuse.wanted() && level + 1 == levels;
      if (level == 0 && first.wanted()) {
        filter(false, filtered);
        first = Image{filtered};
      }
      if (last) {
        diffuse = Image{frame.image("filtered diffuse")};
        filter(true, diffuse->texture);
      } else if (level > 0 || !first.wanted()) {
        filter(false, filtered);
      }
      light = filtered;
      noise = noiseLeft;
    }
  }
};

}  // namespace

void addAtrous(TechniqueRegistry& registry) {
  registry.add<AtrousPass>(
      "atrous",
      "Edge-avoiding wavelet filter guided by surfaces and by the variance of the light (Schied et al. 2017)");
}

}  // namespace lumivox::image_filters

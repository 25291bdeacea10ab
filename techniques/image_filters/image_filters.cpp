// Filters for images gathered at some of the pixels or from few samples: joint bilateral filters guided by
// the g-buffer (Kopf, Cohen, Lischinski & Uyttendaele 2007; Pham & van Vliet 2005).
#include <fmt/format.h>

#include "image_filters_shaders.h"
#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "passes.h"

namespace lumivox::image_filters {
namespace {

namespace smooth = shaders::image_filters::smooth;

class SmoothPass : public Pass {
  // In the order of their numbers in smooth.comp.
  enum class Kernel { tent, gaussian, bilinear };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<Image> arriving{this,
                     "diffuse",
                     Presence::optional,
                     "mean arriving radiance, E / pi, at every pixel or at one of each 2 x 2 or 4 x 4",
                     Needs::nothing,
                     Contributes::nothing};
  In<Image> mirrored{this,
                     "glossy",
                     Presence::optional,
                     "light reflected by the glossy lobe, at every pixel or at one of each 2 x 2 or 4 x 4",
                     Needs::nothing,
                     Contributes::nothing};
  In<Image> open{this,
                 "occlusion",
                 Presence::optional,
                 "unoccluded share of the directions, at every pixel or at one of each 2 x 2 or 4 x 4",
                 Needs::nothing,
                 Contributes::nothing};
  Param<Kernel> kernel{
      this, "kernel", Kernel::tent,
      "tent: 4 x 4 samples weighted by tents, in one pass; gaussian: a Gaussian along the rows, then along the columns; bilinear: the nearest samples, surfaces ignored, for comparison"};
  Param<int> radius{
      this, "radius", 0, within(0, 64),
      "half width of the filter, in pixels; where not every pixel has a sample, at least two samples on either side"};
  Param<float> tolerance{
      this, "tolerance", 1.0f, within(1e-3f, 1e3f),
      "distance from the pixel's tangent plane at which a sample has the weight 1/e, in widths of a sample there"};
  Param<float> power{this, "power", 16.0f, within(0.0f, 1000.0f),
                     "exponent of the cosine between the normals of the pixel and of a sample"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "indirect light reflected by the diffuse lobe, W/(sr m^2)"};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::nothing,
                    "indirect light reflected by the glossy lobe, W/(sr m^2)"};
  Out<Image> occlusion{this, "occlusion", Contributes::ambientOcclusion, Needs::nothing,
                       "unoccluded share of the directions"};

  Reads readsFrom() const override { return Reads::camera; }
  bool uses(const InBase& input) const override {
    if (&input == &arriving) return diffuse.wanted();
    if (&input == &mirrored) return glossy.wanted();
    return &input != &open || occlusion.wanted();
  }

  /// Distance from one sample to the next in pixels.
  int everyOf(PassContext& frame, const In<Image>& samples, const char* name) const {
    const glm::ivec3 all = pixels(frame);
    const gpu::TextureDescription& size = samples->texture->description();
    for (const int every : {1, 2, 4})
      if (size.width == (all.x + every - 1) / every && size.height == (all.y + every - 1) / every)
        return every;
    throw Error(fmt::format(
        "image_filters.smooth: '{}' has {} x {} samples for {} x {} pixels; expected one for each pixel, or for 2 x 2 or 4 x 4 of them",
        name, size.width, size.height, all.x, all.y));
  }

  void run(PassContext& frame) override {
    smoothed(frame, arriving, diffuse, "diffuse", true);
    smoothed(frame, mirrored, glossy, "glossy", false);
    smoothed(frame, open, occlusion, "occlusion", false);
  }

  void smoothed(PassContext& frame, const In<Image>& samples, Out<Image>& result, const char* name,
                bool reflects) const {
    if (!result.wanted()) return;
    result = Image{frame.image(fmt::format("smoothed {}", name)),
                   result.contributes() != Contributes::ambientOcclusion};
    const float nothing = result.contributes() == Contributes::ambientOcclusion
                              ? neutralElement(Contributes::ambientOcclusion)
                              : neutralElement(Contributes::indirectDiffuse);
    if (!samples.present()) return result->texture->clear(glm::vec4(nothing));
    const int every = everyOf(frame, samples, name);
    const glm::ivec3 all = pixels(frame);
    const CameraView& camera = frame.snapshot().camera;
    smooth::Parameters parameters{.eye = camera.eye,
                                  .pixelAngle = pixelAngleOf(camera),
                                  .every = glm::ivec2(every),
                                  .everyOut = glm::ivec2(1),
                                  .along = glm::ivec2(every > 1 || radius > 0),
                                  .radius = radius,
                                  .spacing = every,
                                  .tolerance = tolerance,
                                  .power = power,
                                  .nothing = nothing};
    const auto pass = [&](const gpu::TextureRef& from, const gpu::TextureRef& to, bool last) {
      frame.dispatch(frame.program(smooth::Variant{.reflects = reflects && last},
                                   smooth::Constants{.kernel = static_cast<int>(Kernel(kernel))}),
                     {smooth::parameters(parameters), GBufferBinding(*gbuffer),
                      smooth::inputImage(from, gpu::Sampling::nearest), smooth::outputImage(to)},
                     {to->description().width, to->description().height, 1});
    };
    if (kernel != Kernel::gaussian || parameters.along == glm::ivec2(0))
      return pass(samples->texture, result->texture, true);
    const gpu::TextureRef rows = frame.texture(
        {.format = gpu::Format::rgba32f, .width = all.x, .height = samples->texture->description().height},
        fmt::format("rows of {}", name));
    parameters.everyOut = {1, every};
    parameters.along = {1, 0};
    pass(samples->texture, rows, false);
    parameters.every = {1, every};
    parameters.everyOut = {1, 1};
    parameters.along = {0, 1};
    pass(rows, result->texture, true);
  }
};

}  // namespace
}  // namespace lumivox::image_filters

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::image_filters;
  registry.describe("Image filters that respect the borders of surfaces",
                    "Kopf, Cohen, Lischinski & Uyttendaele 2007; Pham & van Vliet 2005; Schied et al. 2017");
  registry.add<SmoothPass>(
      "smooth", "Joint bilateral filter and upsampling of samples at some or all pixels (Kopf et al. 2007)");
  addAccumulate(registry);
  addAtrous(registry);
}

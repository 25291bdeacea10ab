// From light that arrives at some pixels to light that all of them reflect.
#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "near_field_voxels_shaders.h"
#include "rays.h"

namespace lumivox::near_field_voxels {

namespace {

namespace reflect = shaders::near_field_voxels::reflect;

class ReflectPass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<Image> light{this, "diffuse", Presence::optional,
                  "mean radiance that arrives, of all pixels or of one of 2 x 2 or 4 x 4"};
  In<Image> open{this, "occlusion", Presence::optional, "unoccluded share, of as many"};
  Param<float> tolerance{
      this, "tolerance", 1.0f, within(1e-3f, 1e3f),
      "distance off a pixel's surface, in widths of a sample, at which another one counts 1/e"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "indirect light reflected by the diffuse lobe, W/(sr m^2)"};
  Out<Image> occlusion{this, "occlusion", Contributes::ambientOcclusion, Needs::nothing,
                       "unoccluded share of the directions"};

  Reads readsFrom() const override { return Reads::camera; }

  int everyOf(PassContext& frame, const gpu::Texture& samples) const {
    const glm::ivec3 all = pixels(frame);
    const gpu::TextureDescription& size = samples.description();
    for (const int every : {1, 2, 4})
      if (size.width == (all.x + every - 1) / every && size.height == (all.y + every - 1) / every)
        return every;
    throw Error(fmt::format(
        "samples of {} x {} for an image of {} x {}; expected one for each pixel, or for 2 x 2 or 4 x 4 of them",
        size.width, size.height, all.x, all.y));
  }

  void run(PassContext& frame) override {
    const auto filtered = [&](const In<Image>& samples, Out<Image>& result, bool reflects, float neutral) {
      if (!result.wanted()) return;
      result = Image{frame.image(reflects ? "indirect diffuse radiance" : "unoccluded share")};
      if (!samples.present()) return result->texture->clear(glm::vec4(neutral));
      const CameraView& camera = frame.snapshot().camera;
      frame.dispatch(
          frame.program(reflect::Variant{.diffuse = reflects, .occlusion = !reflects}),
          {reflect::parameters({.eye = camera.eye,
                                .pixelAngle = 2.0f * camera.tanHalfFov / static_cast<float>(camera.height),
                                .every = everyOf(frame, *samples->texture),
                                .tolerance = tolerance}),
           GBufferBinding(*gbuffer), reflect::arriving(samples->texture, gpu::Sampling::nearest),
           reflect::openShare(samples->texture, gpu::Sampling::nearest),
           reflect::diffuseImage(result->texture), reflect::occlusionImage(result->texture)},
          pixels(frame));
    };
    filtered(light, diffuse, true, neutralElement(Contributes::indirectDiffuse));
    filtered(open, occlusion, false, neutralElement(Contributes::ambientOcclusion));
  }
};

}  // namespace

void addReflect(TechniqueRegistry& registry) {
  registry.add<ReflectPass>("reflect",
                            "What visible surfaces reflect of light that was gathered at some pixels (Kopf "
                            "et al. 2007)");
}

}  // namespace lumivox::near_field_voxels

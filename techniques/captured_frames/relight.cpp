// Captured lights in the shadows of virtual content.

#include "picture.h"

namespace lumivox::captured_frames {
namespace {

namespace code = shaders::captured_frames;

class RelightPass : public Pass {
  In<SurfaceLights> captured{this, "lights", "captured pixels as lights"};
  In<GBuffer> gbuffer{this, "gbuffer", "the surfaces on which they lie, by surfaces"};
  In<Image> before{this, "before", "what `surfaces` reflect without virtual content", Contributes::final};
  In<Image> after{this, "after", "what they reflect with it", Contributes::final};
  In<Image> added{this,
                  "added",
                  Presence::optional,
                  "what they reflect of the light that virtual content sends",
                  Needs::nothing,
                  Contributes::indirectDiffuse};
  Out<SurfaceLights> lights{this, "lights", Contributes::nothing, Needs::capturedFrame,
                            "the same lights, times the change of what they reflect"};

  Reads readsFrom() const override { return Reads::camera; }

  void run(PassContext& frame) override {
    const SurfaceLights result{
        frame.emptyElements(code::relight::relit, static_cast<std::uint64_t>(captured->count),
                            "relit lights"),
        captured->count, captured->overlapping};
    const CameraView& view = frame.snapshot().camera;
    if (result.count > 0)
      frame.dispatchList(
          frame.program(code::relight::kProgram),
          {code::relight::parameters({.lights = result.count,
                                      .tanHalfFov = view.tanHalfFov,
                                      .shift = view.shift,
                                      .eye = view.eye,
                                      .right = view.right,
                                      .down = -view.up,
                                      .forward = view.forward}),
           GBufferBinding(*gbuffer), code::relight::beforeRadiance(before->texture, gpu::Sampling::nearest),
           code::relight::afterRadiance(after->texture, gpu::Sampling::nearest),
           code::relight::addedRadiance(added ? added->texture : blackImage(frame), gpu::Sampling::nearest),
           code::relight::captured(captured->lights), code::relight::relit(result.lights)},
          static_cast<std::uint64_t>(result.count));
    lights = result;
  }
};

}  // namespace

void addRelight(TechniqueRegistry& registry) {
  registry.add<RelightPass>("relight", "Captured lights in the shadows of virtual content");
}

}  // namespace lumivox::captured_frames

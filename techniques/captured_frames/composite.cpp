// Composites virtual content over the captured picture.

#include "lumivox/toolkit/bindings.h"
#include "passes.h"

namespace lumivox::captured_frames {
namespace {

namespace code = shaders::captured_frames;

class CompositePass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible virtual surfaces"};
  In<Image> virtualRadiance{this, "virtual", "image of the virtual content", Contributes::final};
  In<CapturedFrames> frames{this, "frames", Presence::optional,
                            "the picture behind, by read; without it virtual content alone",
                            Needs::capturedFrame};
  Out<Image> radiance{
      this, "radiance", Contributes::final, Needs::nothing,
      "virtual content where it is nearer than the captured depth, else the picture, W/(sr m^2)"};

  Reads readsFrom() const override { return Reads::camera; }

  void run(PassContext& frame) override {
    const Image result{frame.image("virtual content before the picture")};
    const CameraView& view = frame.snapshot().camera;
    const bool isCaptured = frames && frames->count > 0,
               shown = isCaptured && isSameEye(view, frames->states.front());
    if (isCaptured && !shown)
      frame.warn(
          "the camera does not stand where the depth camera stood, so that its picture is left out; expected a "
          "camera with 'capture NAME'");
    code::composite::Parameters parameters{};
    if (shown) {
      const CaptureCamera& camera = frames->camera;
      const auto& k = camera.distortion;
      const auto number = [](double value) { return static_cast<float>(value); };
      parameters = {.tanHalfFov = view.tanHalfFov,
                    .width = camera.width,
                    .height = camera.height,
                    .shift = view.shift,
                    .focal = glm::vec2(camera.focal),
                    .centre = glm::vec2(camera.centre),
                    .radial = {number(k[0]), number(k[1]), number(k[4]), 0.0f},
                    .tangential = {number(k[2]), number(k[3])},
                    .eye = view.eye,
                    .forward = view.forward};
    }
    frame.dispatch(frame.program(code::composite::Variant{.picture = shown}),
                   {code::composite::parameters(parameters), GBufferBinding(*gbuffer),
                    code::composite::virtualRadiance(virtualRadiance->texture, gpu::Sampling::nearest),
                    code::composite::capturedColour(shown ? frames->colour : nullptr, gpu::Sampling::nearest),
                    code::composite::capturedDepth(shown ? frames->depth : nullptr, gpu::Sampling::nearest),
                    code::composite::radianceImage(result.texture)},
                   pixels(frame));
    radiance = result;
  }

  /// The picture shows what lies behind virtual content only from the depth camera's place.
  static bool isSameEye(const CameraView& view, const CaptureState& state) {
    constexpr float kSame = 1e-4f;
    const float turned =
        glm::length(view.forward - state.toWorld[2]) + glm::length(view.right - state.toWorld[0]);
    return glm::length(view.eye - state.eye) <= kSame && turned <= kSame;
  }
};

}  // namespace

void addComposite(TechniqueRegistry& registry) {
  registry.add<CompositePass>("composite", "Virtual content before the captured picture, by depth");
}

}  // namespace lumivox::captured_frames

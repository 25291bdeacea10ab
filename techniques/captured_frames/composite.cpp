// Composites virtual content over the captured picture, whose surfaces it shades and lights.

#include "picture.h"

namespace lumivox::captured_frames {
namespace {

namespace code = shaders::captured_frames;

class CompositePass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible virtual surfaces"};
  In<Image> virtualRadiance{this, "virtual", "image of the virtual content", Contributes::final};
  In<CapturedFrames> frames{this, "frames", Presence::optional,
                            "the picture behind, by read; without it virtual content alone",
                            Needs::capturedFrame};
  In<Image> before{
      this,
      "before",
      Presence::optional,
      "what `surfaces` reflect without virtual content; with it and `after` the picture is relit",
      Needs::capturedFrame,
      Contributes::final};
  In<Image> after{this,
                  "after",
                  Presence::optional,
                  "what `surfaces` reflect of the same light where virtual content casts shadows",
                  Needs::capturedFrame,
                  Contributes::final};
  In<Image> added{this,
                  "added",
                  Presence::optional,
                  "what `surfaces` reflect of the light that virtual content sends",
                  Needs::capturedFrame,
                  Contributes::indirectDiffuse};
  Out<Image> radiance{
      this, "radiance", Contributes::final, Needs::nothing,
      "virtual content where it is nearer than the captured depth, else the picture, W/(sr m^2)"};

  Reads readsFrom() const override { return Reads::camera; }

  void run(PassContext& frame) override {
    const Image result{frame.image("virtual content before the picture")};
    const CameraView& view = frame.snapshot().camera;
    const bool isCaptured = frames && frames->count > 0, shown = isCaptured && isSameEye(*frames, view),
               relit = shown && before && after;
    if (isCaptured && !shown)
      frame.warn(
          "the camera does not stand where the depth camera stood, so that its picture is left out; expected a "
          "camera with 'capture NAME'");
    using gpu::Sampling;
    shader::BindingSet bound{GBufferBinding(*gbuffer),
                             code::composite::virtualRadiance(virtualRadiance->texture, Sampling::nearest),
                             code::composite::radianceImage(result.texture)};
    if (shown) {
      bound.add(code::composite::picture(pictureOf<code::composite::Picture>(*frames, view)));
      bound.add(code::composite::capturedColour(frames->colour, Sampling::nearest));
      bound.add(code::composite::capturedDepth(frames->depth, Sampling::nearest));
    }
    if (relit) {
      bound.add(code::composite::beforeRadiance(before->texture, Sampling::nearest));
      bound.add(code::composite::afterRadiance(after->texture, Sampling::nearest));
      bound.add(
          code::composite::addedRadiance(added ? added->texture : blackImage(frame), Sampling::nearest));
    }
    frame.dispatch(frame.program(code::composite::Variant{.picture = shown, .relit = relit}), bound,
                   pixels(frame));
    radiance = result;
  }
};

}  // namespace

void addComposite(TechniqueRegistry& registry) {
  registry.add<CompositePass>(
      "composite", "Virtual content before the captured picture, by depth, and its shadows and light on it");
}

}  // namespace lumivox::captured_frames

// The real surfaces that the view's pixels show, as a g-buffer: receivers of the light and the shadows of
// virtual content.

#include "picture.h"

namespace lumivox::captured_frames {
namespace {

namespace code = shaders::captured_frames;

class SurfacesPass : public Pass {
  In<CapturedFrames> frames{this, "frames", "frames with depth, by read"};
  In<ReflectiveShadowMap> map{this, "map", "places and normals of their pixels, by lights"};
  /// Without virtual triangles nothing changes on them.
  Out<GBuffer> gbuffer{this, "gbuffer", Contributes::nothing, Needs::capturedFrame | Needs::triangles,
                       "real surfaces of the newest frame, white: shaded, they show irradiance over pi"};

  Reads readsFrom() const override { return Reads::camera; }

  void run(PassContext& frame) override {
    const GBuffer result{.position = frame.image("positions of real surfaces"),
                         .normal = frame.image("normals of real surfaces"),
                         .geometricNormal = frame.image("geometric normals of real surfaces"),
                         .diffuse = frame.image("white of real surfaces"),
                         .specular = nullptr,
                         .emission = nullptr};
    gbuffer = result;
    const CameraView& view = frame.snapshot().camera;
    if (!isSameEye(*frames, view)) {
      for (const gpu::TextureRef& each :
           {result.position, result.normal, result.geometricNormal, result.diffuse})
        each->clear(glm::vec4(0.0f));
      return;
    }
    frame.dispatch(
        frame.program(code::surfaces::kProgram),
        {code::surfaces::picture(pictureOf<code::surfaces::Picture>(*frames, view)),
         code::surfaces::capturedPosition(map->position, gpu::Sampling::nearest),
         code::surfaces::capturedNormal(map->normal, gpu::Sampling::nearest),
         code::surfaces::positionImage(result.position), code::surfaces::normalImage(result.normal),
         code::surfaces::geometricNormalImage(result.geometricNormal),
         code::surfaces::diffuseImage(result.diffuse)},
        pixels(frame));
  }
};

}  // namespace

void addSurfaces(TechniqueRegistry& registry) {
  registry.add<SurfacesPass>("surfaces", "Real surfaces behind the view's pixels, as white receivers");
}

}  // namespace lumivox::captured_frames

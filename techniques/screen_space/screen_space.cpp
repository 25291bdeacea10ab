// Ambient occlusion and one bounce of light from what the camera sees: Mittring 2007, "Finding next gen:
// CryEngine 2"; Ritschel, Grosch & Seidel 2009, "Approximating dynamic global illumination in image space".
// The baselines that voxels are compared with.
#include <fmt/format.h>

#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/environment.h"
#include "screen_space_shaders.h"

namespace lumivox::screen_space {
namespace {

namespace code = shaders::screen_space;

/// Common parts of both passes: points around each surface point, looked up in the image.
class ScreenPass : public Pass {
 protected:
  // In the order of its numbers in screen.glsl.
  enum class Surface { plane, depth };
  enum class Pixels { full, half, quarter };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  Param<int> samples{this, "samples", 16, within(1, 4096), "points around each surface point"};
  Param<float> radius{
      this,
      "radius",
      0.0f,
      within(0.0f, 1e6f),
      "m",
      "largest distance of these points; 0: that within which the reference looks for occluders, a tenth of the scene's diagonal"};
  Param<Surface> surface{
      this, "surface", Surface::plane,
      "what hides a point; plane: the tangent plane of the surface in its pixel; depth: the depth of that pixel",
      published(Surface::depth)};
  Param<Pixels> pixelsParameter{
      this, "pixels", Pixels::full,
      "pixels with a result; full: all; half: one of 2 x 2; quarter: one of 4 x 4, which image_filters.smooth upsamples"};

  float radiusOf(const PassContext& frame) const {
    if (radius > 0.0f) return radius;
    return static_cast<float>(ambientOcclusionDistance(frame.snapshot().bounds));
  }

  /// Runs a program over the pixels that get a result. Returns the results; in runs that accumulate, their
  /// mean over the frames since the last change.
  template <class Variant, class Constants>
  Image sampled(PassContext& frame, Variant variant, Constants constants, const shader::BindingSet& own,
                const char* what) const {
    const int every = 1 << static_cast<int>(Pixels(pixelsParameter));
    const gpu::TextureDescription& all = gbuffer->position->description();
    const gpu::TextureDescription size{.format = gpu::Format::rgba32f,
                                       .width = (all.width + every - 1) / every,
                                       .height = (all.height + every - 1) / every};
    const Image result{frame.texture(size, what)};
    const History<gpu::TextureRef> mean = frame.history(size, fmt::format("mean {}", what));
    const int accumulated = mean.previous ? frame.accumulated() : 0;
    const CameraView& camera = frame.snapshot().camera;
    variant.accumulated = accumulated > 0;
    constants.surface = static_cast<int>(Surface(surface));
    // Both programs include one text, so that they have the same blocks and names.
    frame.dispatch(
        frame.program(variant, constants),
        {own, GBufferBinding(*gbuffer),
         code::ssao::screen({.eye = camera.eye,
                             .tanHalfFov = camera.tanHalfFov,
                             .right = camera.right,
                             .radius = radiusOf(frame),
                             .up = camera.up,
                             .samples = samples,
                             .forward = camera.forward,
                             .every = every,
                             .shift = camera.shift,
                             .accumulated = accumulated,
                             .seed = seedWords(frame)}),
         code::ssao::before(accumulated > 0 ? mean.previous : gpu::TextureRef(), gpu::Sampling::nearest),
         code::ssao::meanImage(mean.current), code::ssao::resultImage(result.texture)},
        {size.width, size.height, 1});
    return result;
  }
};

class SsaoPass : public ScreenPass {
  // In the order of their numbers in ssao.comp.
  enum class Directions { sphere, hemisphere };

  Param<Directions> directions{
      this, "directions", Directions::sphere,
      "where the points lie; sphere: in the whole ball, half of which a plane blocks; hemisphere: in its upper half, distributed as the cosine"};
  Param<bool> range{this, "range", true,
                    "ignore surfaces that lie farther in front of the surface point than the radius",
                    published(false)};
  Out<Image> occlusion{this, "occlusion", Contributes::nothing, Needs::triangles,
                       "unoccluded share of the directions, at the sampled pixels"};

  Reads readsFrom() const override { return Reads::camera | Reads::geometry | Reads::history; }

  void run(PassContext& frame) override {
    const float reach = range ? radiusOf(frame) : std::numeric_limits<float>::max();
    const Image open = sampled(frame, code::ssao::Variant{},
                               code::ssao::Constants{.directions = static_cast<int>(Directions(directions))},
                               {code::ssao::occlusion({.range = reach})}, "unoccluded share");
    occlusion = Image{open.texture, false};
  }
};

class SsdoPass : public ScreenPass {
  // In the order of their numbers in ssdo.comp.
  enum class Area { solidAngle, published };

  In<Image> direct{this, "direct", "direct light reflected by the surfaces that block", Contributes::direct};
  Param<Area> area{
      this, "area", Area::solidAngle,
      "weight of a surface that blocks a direction; solid_angle: the solid angle of the direction, 2 pi / N; published: the area pi r^2 / N",
      published(Area::published)};
  Out<Image> arriving{
      this, "arriving", Contributes::nothing, Needs::anyLight | Needs::triangles,
      "mean arriving radiance, E / pi, at the sampled pixels; image_filters.smooth multiplies it by the albedo"};

  Reads readsFrom() const override {
    return Reads::camera | Reads::geometry | Reads::environment | Reads::history;
  }

  void run(PassContext& frame) override {
    const gpu::TextureDescription &surfaces = gbuffer->position->description(),
                                  &light = direct->texture->description();
    if (surfaces.width != light.width || surfaces.height != light.height)
      throw Error(
          fmt::format("screen_space.ssdo: 'direct' has {} x {} pixels; expected the {} x {} of 'gbuffer'",
                      light.width, light.height, surfaces.width, surfaces.height));
    const gpu::TextureRef& emission = gbuffer->emission;
    arriving = sampled(
        frame, code::ssdo::Variant{.emission = emission != nullptr},
        code::ssdo::Constants{.area = static_cast<int>(Area(area)),
                              .environmentMap = environmentMapOf(frame)},
        {EnvironmentBinding(frame), code::ssdo::light({.environment = frame.sceneDescription().environment}),
         code::ssdo::directRadiance(direct->texture, gpu::Sampling::nearest)},
        "arriving radiance");
  }
};

}  // namespace
}  // namespace lumivox::screen_space

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::screen_space;
  registry.describe("Ambient occlusion and one bounce from the surfaces that the camera sees",
                    "Mittring 2007; Ritschel, Grosch & Seidel 2009");
  registry.add<SsaoPass>(
      "ssao", "Ambient occlusion by the share of points around a surface that nothing hides (Mittring 2007)");
  registry.add<SsdoPass>(
      "ssdo",
      "One bounce and the environment by directional occlusion in screen space (Ritschel, Grosch & Seidel 2009)");
}

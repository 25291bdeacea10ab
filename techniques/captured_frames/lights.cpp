// Turns every pixel of the frames into a small light on a surface (Lensing & Broll 2013, Sec. 5): a map with
// one layer per frame.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/light_samples.h"
#include "passes.h"

namespace lumivox::captured_frames {
namespace {

namespace code = shaders::captured_frames;

class LightsPass : public Pass {
  enum class Noise { kinect, share };              // in the order of camera.glsl
  enum class Saturated { kept, dropped, scaled };  // in the order of lights.comp

  In<CapturedFrames> frames{this, "frames", "frames with depth, by read"};
  Param<float> filter{
      this, "filter", 1.0f, within(0.0f, 8.0f),
      "standard deviation of the bilateral filter of depth, pixels; 0: depth as it was captured"};
  Param<Noise> noise{
      this, "noise", Noise::kinect,
      "standard deviation of a depth; kinect: that of the sensor's axial noise (Nguyen et al. 2012); "
      "share: 'noise_share' of the depth"};
  Param<float> noiseShare{this, "noise_share", 0.002f, within(0.0f, 1.0f),
                          "with 'share': standard deviation of a depth over the depth"};
  Param<float> range{this, "range", 3.0f, within(0.01f, 100.0f),
                     "standard deviation of the filter over depth, in standard deviations of a depth"};
  Param<Saturated> saturated{
      this, "saturated", Saturated::kept,
      "colours at the end of the file's range; kept: as they are; dropped: no light, for lamps "
      "that the scene has as lights; scaled: times 'saturated_scale'"};
  Param<float> brightest{
      this, "brightest", 0.0f, within(0.0f, 1e15f),
      "radiance from which a colour counts as saturated too, W/(sr m^2): of lamps in files of "
      "floats; 0: none"};
  Param<float> saturatedScale{this, "saturated_scale", 10.0f, within(0.0f, 1e9f),
                              "with 'scaled': radiance of such a pixel over what the file holds"};
  Out<ReflectiveShadowMap> map{this, "map", Contributes::nothing, Needs::capturedFrame,
                               "the surfaces that the depth camera sees, as lights"};

  /// A photograph holds light of any number of bounces.
  int indirectBounces() const override { return 32; }

  bool uses(const InBase&) const override { return true; }

  void run(PassContext& frame) override {
    const CaptureCamera& camera = frames->camera;
    const auto layers = [&](gpu::Format format, const char* label) {
      return frame.texture(
          {gpu::TextureKind::d2Array, format, camera.width, camera.height, std::max(frames->count, 1), 1},
          label);
    };
    ReflectiveShadowMap result{.lights = eyes(frame),
                               .views = nullptr,
                               .position = layers(gpu::Format::rgba32f, "positions"),
                               .normal = layers(gpu::Format::rgba32f, "normals and areas"),
                               .flux = layers(gpu::Format::rgba32f, "flux of pixels"),
                               .lightCount = frames->count,
                               .layerCount = frames->count,
                               .captured = true,
                               .overlapping = 1};
    if (frames->count == 0)
      for (const gpu::TextureRef& texture : {result.position, result.normal, result.flux})
        texture->clear(glm::vec4(0.0f));
    const gpu::TextureRef depth = filter > 0.0f && frames->count > 0 ? filtered(frame) : frames->depth;
    const gpu::BufferRef counts = frame.inspects()
                                      ? frame.emptyElements(code::lights::counts, kCounts, "counts of pixels")
                                      : frame.elements(code::lights::counts, kCounts, "no counts");
    // The newest comes first: older frames leave out what it holds.
    for (int layer = 0; layer < frames->count; ++layer) {
      frame.dispatch(frame.program(code::lights::Variant{.counted = frame.inspects()}),
                     {code::lights::parameters({.layer = layer,
                                                .saturated = static_cast<int>(Saturated(saturated)),
                                                .saturatedScale = saturatedScale,
                                                .brightest = brightest}),
                      camera_(), code::lights::capturedColour(frames->colour, gpu::Sampling::nearest),
                      code::lights::filteredDepth(depth, gpu::Sampling::nearest),
                      code::lights::capturedRays(frames->rays, gpu::Sampling::nearest),
                      code::lights::poses(frames->poses),
                      code::lights::newerPosition(result.position, gpu::Sampling::nearest),
                      code::lights::newerNormal(result.normal, gpu::Sampling::nearest),
                      code::lights::positionImage(result.position), code::lights::normalImage(result.normal),
                      code::lights::fluxImage(result.flux), code::lights::counts(counts)},
                     {camera.width, camera.height, 1});
    }
    if (frame.inspects() && frames->count > 0) tell(frame, *counts);
    map = result;
  }

  shader::BindingSet camera_() const {
    const CaptureCamera& camera = frames->camera;
    const auto& k = camera.distortion;
    const auto number = [](double value) { return static_cast<float>(value); };
    return {code::lights::captureCamera({.focal = glm::vec2(camera.focal),
                                         .centre = glm::vec2(camera.centre),
                                         .radial = {number(k[0]), number(k[1]), number(k[4]), 0.0f},
                                         .tangential = {number(k[2]), number(k[3])},
                                         .noise = static_cast<int>(Noise(noise)),
                                         .noiseShare = noiseShare})};
  }

  gpu::TextureRef filtered(PassContext& frame) const {
    gpu::TextureRef result = frame.texture(frames->depth->description(), "filtered depths");
    constexpr float kReach = 2.0f;  // standard deviations
    frame.dispatch(frame.program(code::filter::kProgram),
                   {code::filter::parameters({.radius = static_cast<int>(std::ceil(kReach * filter)),
                                              .falloff = 0.5f / (filter * filter),
                                              .range = range}),
                    camera_(), code::filter::capturedDepth(frames->depth, gpu::Sampling::nearest),
                    code::filter::filteredImage(result)},
                   {frames->camera.width, frames->camera.height, frames->count});
    return result;
  }

  /// The depth cameras take the place of lights, without power.
  gpu::BufferRef eyes(PassContext& frame) const {
    std::vector<LightSampleData> eyes;
    for (const CaptureState& state : frames->states) {
      LightSampleData eye;
      eye.position = state.eye;
      eye.kind = LightSampleKind::point;
      eye.direction = state.toWorld[2];
      eye.firstView = static_cast<std::int32_t>(eyes.size());
      eye.viewCount = 1;
      eye.texelWidth = static_cast<float>(1.0 / frames->camera.focal.x);
      eyes.push_back(eye);
    }
    return frame.uploaded(eyes, "eyes of captured frames");
  }

  static constexpr std::uint64_t kCounts = 4;  // kLit and others of lights.comp
  void tell(PassContext& frame, const gpu::Buffer& counts) const {
    const std::vector<std::uint32_t> count = counts.downloadValues<std::uint32_t>();
    const double all = static_cast<double>(frames->camera.width) * frames->camera.height * frames->count;
    const auto percent = [&](std::size_t which) { return 100.0 * count[which] / all; };
    frame.note(fmt::format(
        "{:.1f} % of the pixels are lights; {:.1f} % have no depth or lie at an edge, {:.1f} % are "
        "saturated, {:.1f} % are seen by a newer frame",
        percent(0), percent(1), percent(2), percent(3)));
  }
};

}  // namespace

void addLights(TechniqueRegistry& registry) {
  registry.add<LightsPass>(
      "lights",
      "Every pixel as a light: place, normal, area and flux from depth and colour (Lensing & Broll "
      "2013, Sec. 5)");
}

}  // namespace lumivox::captured_frames
